// The renderer asks this of a material. Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <cstddef>
#include <span>

namespace miebrdf::render {

/// A spectral, isotropic BRDF.
class RenderBrdf {
  public:
    virtual ~RenderBrdf() = default;

    virtual std::size_t wavelengths() const = 0;

    /// BRDF [1/sr] at each wavelength, without the cosine. Thread-safe.
    /// @param mu_in, mu_out  cosines of light and view from the normal, in (0, 1]
    /// @param cos_azimuth    of the relative azimuth, in [-1, 1]: 1 = mirror side, -1 = back
    ///                       towards the source
    /// @param brdf           wavelengths() values, overwritten
    virtual void evaluate(double mu_in, double mu_out, double cos_azimuth,
                          std::span<double> brdf) const = 0;

    /// Beckmann slope parameter of a mirror-like lobe that paths should be guided into; 0: none.
    /// It steers the sampling only, never the value.
    virtual double lobe_alpha() const { return 0.0; }
};

}  // namespace miebrdf::render
