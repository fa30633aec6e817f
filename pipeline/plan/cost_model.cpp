#include "pipeline/plan/cost_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/solve/rules.h"

namespace miebrdf {
namespace {

// Fitted to `miebrdf` on one core of a 2.6 GHz server processor, native build.
constexpr double kWholePhase_s =
    6e-8;  // times x^2; half where spheres absorb, twice where they do not
constexpr double kMoments_s = 1e-8;      // times x^2
constexpr double kNodeCubed_s = 1.2e-9;  // times n^2 (n + cosines), for each layer
constexpr double kOrder_s = 5e-6;
constexpr double kValue_s = 2.5e-7;
constexpr double kTerm_s = 1.5e-8;  // of the sum over orders
constexpr double kLobe_s = 1e-7;
constexpr double kRho_s = 5e-5;

}  // namespace

double mie_seconds(const mie::SizeDistribution& sizes, double host_index, double wavelength_nm,
                   bool whole_phase) {
    // The widest of the distributions ends near twice the effective radius.
    const double radius_um =
        sizes.effective_radius_um * (sizes.kind == mie::SizeDistributionKind::mono ? 1.0 : 2.0);
    const double x = 2.0e3 * std::numbers::pi * radius_um * host_index / wavelength_nm;
    return 1e-3 + (whole_phase ? kWholePhase_s : kMoments_s) * x * x;
}

int expected_streams(const ResolvedScene& scene, const rte::SolverOptions& solver) {
    if (solver.streams > 0) return solver.streams;
    if (most_fourier_orders(scene) > 0) return 8;
    return solver.tolerance >= 1e-3 ? 24 : 48;
}

double order_seconds(int streams, std::size_t layers, std::size_t cosines) {
    const double n = streams;
    // The coarser solution that estimates the error has 2/3 of the nodes.
    const double both = 1.0 + std::pow(2.0 / 3.0, 3);
    return both * (kOrder_s + kNodeCubed_s * static_cast<double>(layers) * n * n *
                                  (n + static_cast<double>(cosines)));
}

double value_seconds(int orders) { return 2.0 * (kValue_s + kTerm_s * orders); }
double lobe_seconds() { return kLobe_s; }
double rho_seconds() { return kRho_s; }

}  // namespace miebrdf
