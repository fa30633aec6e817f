// The rough surface of a rendered material, for all wavelengths at once.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "rte/fresnel.h"
#include "rte/layered_brdf.h"
#include "rte/microfacet.h"

namespace miebrdf::render {

/// The lobe is evaluated exactly: D and G, which do not depend on wavelength, once, and Fresnel's
/// equations, in real arithmetic, side by side for all wavelengths. What the surface lets through
/// is an integral for each cosine and is interpolated cubically in sqrt(mu) between 64 nodes.
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
    Eigen::ArrayXd square_;   ///< n^2 - k^2, filled up to whole lanes
    Eigen::ArrayXd product_;  ///< (2 n k)^2, likewise
    Eigen::ArrayXd normal_;   ///< reflectance at normal incidence
    Eigen::ArrayXXd in_;      ///< row = wavelength, column = node
    Eigen::ArrayXXd out_;     ///< likewise
};

}  // namespace miebrdf::render
