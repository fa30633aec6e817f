// The rough surface of a rendered material, for all wavelengths at once.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include <miebrdf/surface.h>
#include "pipeline/render/table_nodes.h"
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"

namespace miebrdf::render {

/// The lobe is evaluated at the very directions: D and G, which do not depend on wavelength, once,
/// and Fresnel's equations, in real arithmetic, side by side for all wavelengths. What the surface
/// lets through is an integral for each cosine and is interpolated cubically between the nodes of
/// table_nodes.h.
class SurfaceTerm {
  public:
    /// @param refractive_index  of the top material at each wavelength
    /// @param cosines           number of nodes
    SurfaceTerm(const std::vector<std::complex<double>>& refractive_index,
                const rte::SurfaceOptions& options, rte::SurfaceCoupling coupling, int cosines);
    /// The lobe alone, of a boundary whose transmission is in the light from below already.
    SurfaceTerm(const std::vector<std::complex<double>>& refractive_index,
                const rte::SurfaceOptions& options);

    double beckmann_alpha() const { return options_.beckmann_alpha; }

    /// Whether light from below is weakened by `transmission`.
    bool weakens() const { return !in_.empty(); }
    /// Share of light that enters and leaves, for cosine_taps of the two directions.
    Lane transmission(const CubicTaps& in, const CubicTaps& out, std::size_t lane) const;
    /// Adds the lobe R_s [1/sr].
    void add(double mu_in, double mu_out, double cos_azimuth, std::span<double> brdf) const;

  private:
    double in_over_masking(double mu_in) const;

    rte::SurfaceOptions options_;
    std::vector<float> beckmann_masking_;  ///< h(a); empty for another distribution
    rte::ShadowingOverCosines shadowing_;
    Eigen::ArrayXd square_;   ///< n^2 - k^2, filled up to whole lanes
    Eigen::ArrayXd product_;  ///< (2 n k)^2, likewise
    Eigen::ArrayXd normal_;   ///< reflectance at normal incidence
    std::size_t stride_;      ///< wavelengths, filled up to whole lanes
    std::vector<float> in_;   ///< [node * stride + w]
    std::vector<float> out_;  ///< likewise
};

}  // namespace miebrdf::render
