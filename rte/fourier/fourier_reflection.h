// Sums azimuthal orders until the directions asked for no longer notice.
#pragma once

#include <span>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/fourier/coarser_orders.h"
#include "rte/grid/zenith_grid.h"
#include "rte/phase/phase_mode.h"
#include "rte/stack/scaled_stack.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

/// Reflection without the first order, and how it was found.
struct MultipleScattering {
    std::vector<double> reflection;  ///< [(i * out + o) * azimuths + a]
    /// At the incident cosines, all orders of scattering: what order 0 knows anyway.
    std::vector<double> plane_albedo;
    int orders = 0;  ///< the highest one summed, plus 1
    int iterations = 0;
    double residual = 0.0;
    /// Orders not summed, or the doubt in those taken over, relative to order 0: largest (mu + mu')
    /// R.
    double tail = 0.0;
    bool converged = true;
    bool physical = true;
    OrderList by_order;  ///< for a finer solution, probes too; empty where none may be taken over
};

/// R^0 + 2 sum_m R^m cos(m azimuth) without the first order of scattering.
///
/// Stops where the orders still to come are below `tail_tolerance` (order_tail.h). Only m = 0
/// is computed when all incident or all outgoing cosines are 1, where Y_l^m = 0 for m > 0; orders
/// whose cosine is zero at every azimuth (the odd ones across the plane of incidence) are left out.
/// @param coarser_orders  by_order of a solution with fewer nodes, or empty (coarser_orders.h)
MultipleScattering sum_orders(const ScaledStack& stack, const ZenithGrid& grid,
                              const RequestedDirections& requested,
                              std::span<const double> azimuth_deg, double tail_tolerance,
                              const SolverOptions& options, StackMemory& memory,
                              const OrderList& coarser_orders);

/// The same with memory of its own, from no coarser solution.
MultipleScattering sum_orders(const ScaledStack& stack, const ZenithGrid& grid,
                              const RequestedDirections& requested,
                              std::span<const double> azimuth_deg, double tail_tolerance,
                              const SolverOptions& options);

/// Whether all incident or all outgoing cosines are 1, where Y_l^m = 0 for m > 0.
bool only_order_zero(const RequestedDirections& requested);

/// Whether cos(m azimuth) is zero at every azimuth, as for odd m across the plane of incidence.
bool is_invisible(int m, std::span<const double> azimuth_deg);

/// Order 0 alone, for albedos: the answer to a sky (downward radiance at the nodes).
Reflector zeroth_order(const ScaledStack& stack, const ZenithGrid& grid,
                       const RequestedDirections& requested, const SolverOptions& options,
                       StackMemory& memory, const Eigen::VectorXd& sky);

}  // namespace miebrdf::rte
