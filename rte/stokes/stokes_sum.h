// The sum over Fourier orders of Mueller matrices.
#pragma once

#include <span>
#include <vector>

#include "rte/stack/fourier_sum.h"
#include "rte/stokes/stokes_solver.h"

namespace miebrdf::rte {

/// R^0 + 2 sum over m of R^m without the first order of scattering: its diagonal blocks (I, Q) and
/// (U, V) times cos(m azimuth), the lower left one times sin(m azimuth), the upper right one times
/// -sin(m azimuth). Ends, and takes over orders of a coarser solution, as sum_fourier_orders does.
/// With vertical rays orders above 2 vanish.
struct StokesScattering {
    /// [((i * outs + o) * c^2 + row * c + column) * azimuths + a]
    std::vector<double> reflection;
    std::vector<double> plane_albedo, polarised_plane_albedo;  ///< at the incident cosines
    int fourier_orders = 0;
    int iterations = 0;
    double residual = 0.0;
    double tail = 0.0;  ///< as of MultipleScattering
    bool converged = true;
    bool physical = true;
    FourierOrders by_fourier_order;  ///< StokesOrder::multiple; as of MultipleScattering
};

StokesScattering sum_stokes_orders(const ScaledStack& stack, const StackGrids& grids,
                                   const RequestedDirections& requested,
                                   std::span<const double> azimuth_deg, int components,
                                   double tail_tolerance, const SolverOptions& options,
                                   StokesMemory& memory, const FourierOrders& coarser);

}  // namespace miebrdf::rte
