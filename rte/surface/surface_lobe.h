// Reflection by the rough surface itself, before any light enters the layers below.
// Symbols, signs and normalisation: docs/conventions.md; derivations: docs/maths-surface.md.
#pragma once

#include <complex>

#include <miebrdf/surface.h>
#include "rte/boundary/fresnel.h"
#include "rte/surface/microfacet.h"

namespace miebrdf::rte {

/// Torrance-Sparrow lobe R_s = D(h) G F / (4 mu_in mu_out) of one material at one wavelength.
/// Reciprocal; reflects no more than it receives as long as D and Lambda belong together.
class SurfaceLobe {
  public:
    /// @param refractive_index  n + ik of the top material, n > 0, k >= 0
    /// @throws std::invalid_argument  for an index or options out of range, with the value
    SurfaceLobe(std::complex<double> refractive_index, const SurfaceOptions& options);

    /// R_s in 1/sr, without the cosine.
    /// @param mu_in, mu_out  in (0, 1]
    /// @param azimuth_deg  0 = mirror side, 180 = back towards the source
    /// @throws std::invalid_argument  for a cosine out of range or an azimuth that is not finite
    double brdf(double mu_in, double mu_out, double azimuth_deg) const;

    /// rho_dt(mu_in), integral of R_s mu_out over the outgoing hemisphere, to 1e-6.
    /// rte/surface/directional_reflectance.h has the same with its error estimate.
    double directional_reflectance(double mu_in) const;

    /// Mean of 1 - rho_dt over directions of incidence, uniform in solid angle, to 1e-5:
    /// Chen et al. 2013, Table 1.
    double averaged_diffuse_reflectance_factor() const;

    std::complex<double> refractive_index() const { return refractive_index_; }
    const SurfaceOptions& options() const { return options_; }

  private:
    std::complex<double> refractive_index_;
    SurfaceOptions options_;
    FresnelReflectance fresnel_;
    ShadowingOverCosines shadowing_;
};

}  // namespace miebrdf::rte
