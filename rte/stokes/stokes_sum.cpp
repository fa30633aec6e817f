#include "rte/stokes/stokes_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {
namespace {

// Of each pair of cosines the largest element.
Eigen::MatrixXd largest_elements(const Eigen::Ref<const Eigen::MatrixXd>& matrices, int c) {
    Eigen::MatrixXd largest(matrices.rows() / c, matrices.cols() / c);
    for (Eigen::Index i = 0; i < largest.cols(); ++i)
        for (Eigen::Index o = 0; o < largest.rows(); ++o)
            largest(o, i) = matrices.block(o * c, i * c, c, c).cwiseAbs().maxCoeff();
    return largest;
}

// What the element (row, column) of order m counts at each azimuth.
struct AzimuthFactors {
    std::vector<double> cosine, sine;

    AzimuthFactors(int m, std::span<const double> azimuth_deg) {
        for (const double degrees : azimuth_deg) {
            const double azimuth = degrees * (std::numbers::pi / 180.0);
            cosine.push_back(m == 0 ? 1.0 : 2.0 * std::cos(m * azimuth));
            sine.push_back(m == 0 ? 0.0 : 2.0 * std::sin(m * azimuth));
        }
    }
};

void add_order(int m, std::span<const double> azimuth_deg,
               const Eigen::Ref<const Eigen::MatrixXd>& multiple, int c,
               std::vector<double>& reflection) {
    const AzimuthFactors factors(m, azimuth_deg);
    double* next = reflection.data();
    for (Eigen::Index i = 0; i < multiple.cols(); i += c) {
        for (Eigen::Index o = 0; o < multiple.rows(); o += c) {
            for (int element = 0; element < c * c; ++element) {
                const int row = element / c, column = element % c;
                const StokesHarmonic harmonic = stokes_harmonic(row, column);
                const double value = harmonic.sign * multiple(o + row, i + column);
                for (const double factor : harmonic.is_sine ? factors.sine : factors.cosine)
                    *next++ += value * factor;
            }
        }
    }
}

void note(const StokesOrder& order, int fourier_order, const RequestedDirections& requested,
          StokesScattering& sum) {
    sum.iterations = std::max(sum.iterations, order.iterations);
    sum.residual = std::max(sum.residual, order.residual);
    sum.converged = sum.converged && order.converged;
    if (fourier_order > 0) return;
    sum.plane_albedo = order.plane_albedo;
    sum.plane_albedo.resize(requested.asked_in());
    sum.polarised_plane_albedo = order.polarised_plane_albedo;
    sum.polarised_plane_albedo.resize(requested.asked_in());
}

}  // namespace

StokesHarmonic stokes_harmonic(int row, int column) {
    const bool is_diagonal = (row < 2) == (column < 2);
    return {!is_diagonal, is_diagonal || row > column ? 1.0 : -1.0};
}

StokesScattering sum_stokes_orders(const ScaledStack& stack, const StackGrids& grids,
                                   const RequestedDirections& requested,
                                   std::span<const double> azimuth_deg, int components,
                                   double tail_tolerance, const SolverOptions& options,
                                   StokesMemory& memory, const FourierOrders& coarser_orders,
                                   KeptOrders kept) {
    const int c = components;
    StokesScattering sum;
    sum.reflection.assign(
        requested.asked_in() * requested.asked_out() * std::size_t(c * c) * azimuth_deg.size(),
        0.0);
    // At mu = 1 d^l_m0 and d^l_m2 vanish but for m = 0 and m = 2.
    const int highest =
        only_fourier_order_zero(requested) ? std::min(3, stack.moments) : stack.moments;
    const bool keep =
        is_smooth(stack) &&
        requested.in.size() * requested.out.size() * std::size_t(c * c) <= kMostKeptPairs;
    const RequestedDirections rows = repeated(requested, c);
    const auto asked_out = Eigen::Index(rows.asked_out()), asked_in = Eigen::Index(rows.asked_in());

    StokesSolver solver(stack, grids, requested, components, options, memory);
    FourierTail tail(tail_tolerance);
    FourierSizes sizes;
    CoarserFourierOrders coarser(coarser_orders, kCoarserOrdersShare * options.tolerance);
    const FeatureOrders features(stack, requested);
    const Eigen::VectorXd mu_in = asked_incidences(requested);
    double dimmer = 1.0;  // listed values than order 0
    int m = 0, least = 0;
    for (bool ended = false; m < highest && !ended; ++m) {
        const Eigen::MatrixXd* multiple = coarser.settled(m);
        if (multiple == nullptr) {
            const StokesOrder& order = solver.solve(m);
            if (!order.physical) {
                sum.physical = false;
                return sum;
            }
            note(order, m, requested, sum);
            multiple = &order.multiple;
            coarser.compare(m, *multiple, rows);
        }
        sum.fourier_orders = m + 1;
        const auto asked = multiple->topLeftCorner(asked_out, asked_in);
        add_order(m, azimuth_deg, asked, c, sum.reflection);
        ended = tail.ends_with(sizes.next(largest_elements(asked, c))) && m >= least;
        if (ended) dimmer = sizes.over_listed(sum.reflection);
        ended = ended && dimmer * tail.remaining() <= tail_tolerance;
        if (kept == KeptOrders::asked_for) {
            sum.by_fourier_order.push_back(asked);
        } else if (keep) {
            sum.by_fourier_order.push_back(*multiple);
        }
        if (!ended) continue;
        least = features.last(
            m, highest, sizes.of_retro_reflection(mu_in), tail_tolerance / dimmer, [&](int order) {
                const StokesOrder& far = solver.solve(order);
                return sizes.of(
                    largest_elements(far.multiple.topLeftCorner(asked_out, asked_in), c));
            });
        ended = least <= m;
    }
    sum.tail = m == highest ? 0.0 : dimmer * tail.remaining();  // 0: every order there is
    if (coarser.settled(m - 1) != nullptr) sum.tail = std::max(sum.tail, coarser.difference());
    return sum;
}

}  // namespace miebrdf::rte
