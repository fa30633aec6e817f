// The sum over Fourier orders of Mueller matrices.
#pragma once

#include <span>
#include <vector>

#include "rte/stack/fourier_sum.h"
#include "rte/stokes/stokes_solver.h"

namespace miebrdf::rte {

/// Element (row, column) of R at an azimuth is the sum over m of (m = 0 ? 1 : 2) times that of R^m
/// (StokesOrder::multiple) times `sign` and cos(m azimuth), or sin(m azimuth) where `is_sine`.
struct StokesHarmonic {
    bool is_sine = false;
    double sign = 1.0;
};
StokesHarmonic stokes_harmonic(int row, int column);

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

/// Which orders the sum keeps in by_fourier_order.
enum class KeptOrders {
    for_finer,  ///< those that a finer solution may take over, probes included
    asked_for,  ///< all of them, at the directions asked for: what a table is made of
};

StokesScattering sum_stokes_orders(const ScaledStack& stack, const StackGrids& grids,
                                   const RequestedDirections& requested,
                                   std::span<const double> azimuth_deg, int components,
                                   double tail_tolerance, const SolverOptions& options,
                                   StokesMemory& memory, const FourierOrders& coarser,
                                   KeptOrders kept = KeptOrders::for_finer);

}  // namespace miebrdf::rte
