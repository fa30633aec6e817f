// The rough surface of a rendered material, for all wavelengths at once.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "rte/fresnel.h"
#include "rte/layered_brdf.h"
#include "rte/microfacet.h"

namespace miebrdf::render {

/// The lobe is evaluated exactly: D and G, which do not depend on wavelength, once, and Fresnel's
/// equations at each wavelength. What the surface lets through is an integral for each cosine and
/// is interpolated cubically in sqrt(mu) between 64 nodes.
class SurfaceTerm {
  public:
    /// @param refractive_index  of the top material at each wavelength
    SurfaceTerm(const std::vector<std::complex<double>>& refractive_index,
                const rte::SurfaceOptions& options, rte::SurfaceCoupling coupling);

    double beckmann_alpha() const { return options_.beckmann_alpha; }

    /// Multiplies each value by the share of light that enters and leaves.
    void weaken(double mu_in, double mu_out, std::span<double> brdf) const;
    /// Adds the lobe R_s [1/sr].
    void add(double mu_in, double mu_out, double cos_azimuth, std::span<double> brdf) const;

  private:
    rte::SurfaceOptions options_;
    rte::ShadowingOverCosines shadowing_;
    std::vector<rte::FresnelReflectance> fresnel_;
    std::vector<double> in_;   ///< [node * wavelengths + w]
    std::vector<double> out_;  ///< likewise
};

}  // namespace miebrdf::render
