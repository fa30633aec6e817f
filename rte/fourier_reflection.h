// Sums azimuthal orders until the directions asked for no longer notice.
#pragma once

#include <span>
#include <vector>

#include "rte/phase_mode.h"
#include "rte/reflector.h"
#include "rte/single_scattering.h"
#include "rte/solver_options.h"
#include "rte/stack.h"
#include "rte/zenith_grid.h"

namespace miebrdf::rte {

/// A stack as the discrete equations see it.
struct ScaledStack {
    std::vector<ScaledMedium> media;  ///< from the bottom up; media[0] is the half-space, if any
    BaseKind base = BaseKind::half_space;
    double ground_albedo = 0.0;
    int moments = 1;  ///< Legendre moments of the medium that has most
};

/// Reflection without the first order, and how it was found.
struct MultipleScattering {
    std::vector<double> reflection;  ///< [(i * out + o) * azimuths + a]
    /// At the incident cosines, all orders of scattering: what order 0 knows anyway.
    std::vector<double> plane_albedo;
    int orders = 0;  ///< the highest one summed, plus 1
    int iterations = 0;
    double residual = 0.0;
    double tail = 0.0;  ///< orders not summed relative to order 0, largest (mu + mu') R
    bool converged = true;
    bool physical = true;
};

/// R^0 + 2 sum_m R^m cos(m azimuth) without the first order of scattering.
///
/// Stops where the orders still to come are below `tail_tolerance` (order_tail.h). Only m = 0
/// is computed when all incident or all outgoing cosines are 1, where Y_l^m = 0 for m > 0; orders
/// whose cosine is zero at every azimuth (the odd ones across the plane of incidence) are left out.
MultipleScattering sum_orders(const ScaledStack& stack, const ZenithGrid& grid,
                              const RequestedDirections& requested,
                              std::span<const double> azimuth_deg, double tail_tolerance,
                              const SolverOptions& options);

/// Whether cos(m azimuth) is zero at every azimuth, as for odd m across the plane of incidence.
bool is_invisible(int m, std::span<const double> azimuth_deg);

/// Order 0 alone, for albedos: 2 R^0(mu, mu_q) D_q at the requested cosines, X at the nodes.
Reflector zeroth_order(const ScaledStack& stack, const ZenithGrid& grid,
                       const RequestedDirections& requested, const SolverOptions& options);

}  // namespace miebrdf::rte
