// Polarised light scattered once in layers under a refracting boundary or over a mirror.
#pragma once

#include <optional>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/boundary/fresnel_matrix.h"
#include "rte/stack/stack_solver.h"
#include "rte/stokes/stokes_first_order.h"

namespace miebrdf::rte {

/// Beam (refracted_first_order.h) of polarised light: what becomes of it between the meridian
/// planes. The matrices of light that leaves are the same.
struct PolarisedBeam {
    double mu = 1.0;         ///< in the medium
    FresnelMatrix down, up;  ///< at its top, and at its bottom sent back by what lies below
};

/// In all media, from the bottom up as they are listed.
std::vector<PolarisedBeam> polarised_beams(const ScaledStack& stack, double mu_air);

/// What of light from a direction in air leaves into its mirror direction without being scattered.
FresnelMatrix polarised_mirror_reflection(const ScaledStack& stack, double mu_air);

/// Light scattered once as it is seen from air at one pair of directions, 4 x 4, without what
/// NarrowFeatures corrects.
/// @param seen  media_of_first_order(stack.media, exact)
Eigen::Matrix4d scattered_once(const ScaledStack& stack, const std::vector<Optics>& seen,
                               double mu_in_air, double mu_out_air, double azimuth_deg);

/// By which the polarisation that a smooth boundary gives to light on its way in and out changes
/// element 11 of what is scattered once below it: of straight paths (has_straight_paths).
/// @param seen  as above
double change_of_straight_paths(const ScaledStack& stack, const std::vector<Optics>& seen,
                                double mu_in_air, double mu_out_air, double azimuth_deg);

/// StokesFirstOrder of any stack with smooth boundaries.
class StokesFirstOrderOfStack {
  public:
    /// @param directions  in air; must outlive this
    StokesFirstOrderOfStack(const Directions& directions, int components,
                            const SolverOptions& options);

    /// As StokesFirstOrder::add_to.
    void add_to(std::vector<double>& reflection, const ScaledStack& stack);

  private:
    void add_straight(std::vector<double>& reflection, const ScaledStack& stack);
    void add_all_paths(std::vector<double>& reflection, const ScaledStack& stack) const;

    const Directions& directions_;
    int components_;
    SolverOptions options_;
    Directions inside_;  ///< of the one index
    std::optional<StokesFirstOrder> straight_;
};

}  // namespace miebrdf::rte
