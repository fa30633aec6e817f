// BRDFs in closed form: references for tests, and plain surroundings for the solver's materials.
#pragma once

#include <vector>

#include "pipeline/render/render_brdf.h"

namespace miebrdf::render {

/// Perfectly diffuse: f = albedo / pi. Albedos in [0, 1], one for each wavelength.
class LambertianBrdf : public RenderBrdf {
  public:
    explicit LambertianBrdf(std::vector<double> albedo);
    std::size_t wavelengths() const override { return albedo_.size(); }
    void evaluate(double mu_in, double mu_out, double cos_azimuth,
                  std::span<double> brdf) const override;

  private:
    std::vector<double> albedo_;
};

/// Isotropic single scattering by a half-space, f = w / (4 pi (mu_in + mu_out)) with
/// single-scattering albedo w in [0, 1] (Lommel-Seeliger law).
class LommelSeeligerBrdf : public RenderBrdf {
  public:
    explicit LommelSeeligerBrdf(std::vector<double> single_scattering_albedo);
    std::size_t wavelengths() const override { return albedo_.size(); }
    void evaluate(double mu_in, double mu_out, double cos_azimuth,
                  std::span<double> brdf) const override;

  private:
    std::vector<double> albedo_;
};

/// Microfacets of constant reflectance F: f = F D G / (4 mu_in mu_out) with Beckmann's D of slope
/// parameter alpha and the V-cavity G = min(1, 2 h mu_in / d, 2 h mu_out / d), h and d the cosines
/// of the half vector with normal and light (Torrance & Sparrow 1967, Cook & Torrance 1982).
class RoughLobeBrdf : public RenderBrdf {
  public:
    /// @param reflectance  F in [0, 1], one for each wavelength
    /// @param alpha        in (0, 2]
    RoughLobeBrdf(std::vector<double> reflectance, double alpha);
    std::size_t wavelengths() const override { return reflectance_.size(); }
    void evaluate(double mu_in, double mu_out, double cos_azimuth,
                  std::span<double> brdf) const override;
    double lobe_alpha() const override { return alpha_; }

  private:
    std::vector<double> reflectance_;
    double alpha_;
};

}  // namespace miebrdf::render
