// BRDFs in closed form to export: a smooth half-space and one with a sharp lobe.
#pragma once

#include "pipeline/formats/common/rgb_source.h"

namespace miebrdf::support {

/// A half-space of Henyey-Greenstein scatterers, f = w / (4 pi (mu_in + mu_out)) [P - 1 + H H],
/// exact in its first order, H after Hapke 1981 (eq. 8.31 of his book): reciprocal, coloured,
/// depends on azimuth, and does not vanish at the horizon.
class TestMaterial : public BrdfSource {
  public:
    /// Albedo rises evenly from 0.55 at the first to 0.95 at the last wavelength.
    TestMaterial(std::vector<double> wavelength_nm, double asymmetry);

    const std::vector<std::string>& channels() const override { return channels_; }
    const std::vector<double>& wavelength_nm() const override { return wavelength_nm_; }
    const Provenance& provenance() const override { return provenance_; }
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override;

    double brdf(const Direction& direction, double albedo) const;

  protected:
    virtual double lobe(const Direction&) const { return 0.0; }

  private:
    std::vector<double> wavelength_nm_;
    std::vector<std::string> channels_;
    double asymmetry_;
    Provenance provenance_;
};

/// That material with a Beckmann lobe of slope parameter alpha about the mirror direction on top.
class SharpMaterial : public TestMaterial {
  public:
    SharpMaterial(std::vector<double> wavelength_nm, double beckmann_alpha);

  protected:
    double lobe(const Direction& direction) const override;

  private:
    double alpha_;
};

/// TestMaterial at the seven wavelengths below: coloured, asymmetry 0.4.
const TestMaterial& material();

/// TestMaterial at seven wavelengths, and as the three colours nearest to those of the paper.
struct ColouredMaterial {
    TestMaterial spectral;
    RgbSource rgb;
    ColouredMaterial();
};

/// 400, 450, ..., 700 nm.
std::vector<double> seven_wavelengths();

}  // namespace miebrdf::support
