#include "rte/fourier_reflection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/coat_steps.h"
#include "rte/half_space.h"
#include "rte/layer.h"
#include "rte/order_tail.h"
#include "rte/solved_half_spaces.h"

namespace miebrdf::rte {
namespace {

// Of the tolerance, what an iterated half-space may leave.
constexpr double share_of_half_space = 0.01;
// Orders of a coarser solution are taken over once they agree to this share of the tolerance.
constexpr double share_of_coarser_orders = 0.01;
// Orders of larger tables are not kept: 30 of them would take 10 MB.
constexpr std::size_t most_pairs = 40000;

ScatteringMode scattering_mode(const ScaledMedium& medium, const PhaseMode& mode) {
    // Degrees that this medium has no moments for scatter nothing.
    Eigen::VectorXd strengths = Eigen::VectorXd::Zero(mode.at_nodes.cols());
    const Eigen::VectorXd all = medium.scaled.strengths();
    const Eigen::Index count = std::max<Eigen::Index>(0, all.size() - mode.order);
    strengths.head(count) = all.tail(count);
    return {std::move(strengths), medium.scaled.one_minus_albedo, mode.order};
}

Reflector solve_base(const ScaledStack& stack, const PhaseMode& mode, const ZenithGrid& grid,
                     const RequestedDirections& requested, const SolverOptions& options) {
    switch (stack.base) {
        case BaseKind::lambertian:
            return lambertian_ground(stack.ground_albedo, mode, grid, requested);
        case BaseKind::none:
            return no_reflection(grid, requested);
        case BaseKind::half_space:
            break;
    }
    const ScatteringMode medium = scattering_mode(stack.media.front(), mode);
    const double tolerance = options.half_space_tolerance > 0.0
                                 ? options.half_space_tolerance
                                 : share_of_half_space * options.tolerance;
    if (options.half_spaces != nullptr) {
        return options.half_spaces->solve(
            {options.half_space_method, medium, mode, grid, requested, tolerance});
    }
    return solve_half_space(options.half_space_method, medium, mode, grid, requested, tolerance);
}

Reflector solve_stack(const ScaledStack& stack, const PhaseMode& mode, const ZenithGrid& grid,
                      const RequestedDirections& requested, const SolverOptions& options,
                      ReflectorParts parts) {
    Reflector reflector = solve_base(stack, mode, grid, requested, options);
    const std::size_t first_coat = stack.base == BaseKind::half_space ? 1 : 0;
    for (std::size_t c = first_coat; c < stack.media.size() && reflector.physical; ++c) {
        const ScaledMedium& coat = stack.media[c];
        const ScatteringMode medium = scattering_mode(coat, mode);
        if (options.coat_method == CoatMethod::automatic) {
            const bool is_top = c + 1 == stack.media.size();
            const ReflectorParts needed = is_top ? parts : ReflectorParts::nodes;
            const LayerOperator layer =
                solve_layer(coat.optical_depth, medium, mode, grid, requested, needed);
            if (!layer.physical) return {};
            reflector = put_on(layer, reflector, requested, needed);
        } else {
            const std::vector<ScaledMedium> below(stack.media.begin(),
                                                  stack.media.begin() + std::ptrdiff_t(c));
            reflector =
                step_through_coat(options.coat_method, options.coat_substeps, coat.optical_depth,
                                  medium, first_order_of(below, mode, requested), mode, grid,
                                  requested, std::move(reflector));
        }
    }
    return reflector;
}

// Adds (2 - delta_m0) R^m cos(m azimuth).
void add_order(int m, std::span<const double> azimuth_deg, const Eigen::MatrixXd& multiple,
               std::vector<double>& reflection) {
    Eigen::VectorXd cosines(Eigen::Index(azimuth_deg.size()));
    for (Eigen::Index a = 0; a < cosines.size(); ++a) {
        const double azimuth = azimuth_deg[std::size_t(a)] * (std::numbers::pi / 180.0);
        cosines[a] = m == 0 ? 1.0 : 2.0 * std::cos(m * azimuth);
    }
    Eigen::Map<Eigen::MatrixXd> table(reflection.data(), cosines.size(), multiple.size());
    table.noalias() += cosines * multiple.reshaped().transpose();
}

// Nothing that matters is cut off: every order converges like the first ones.
bool is_smooth(const ScaledStack& stack) {
    constexpr double no_peak = 1e-4;
    return std::all_of(stack.media.begin(), stack.media.end(), [](const ScaledMedium& medium) {
        return medium.scaled.truncated <= no_peak;
    });
}

// How the equations of one order were solved, and what order 0 knows beside.
void note(const Reflector& reflector, int order, const ZenithGrid& grid,
          const RequestedDirections& requested, MultipleScattering& sum) {
    sum.iterations = std::max(sum.iterations, reflector.iterations);
    sum.residual = std::max(sum.residual, reflector.residual);
    sum.converged = sum.converged && reflector.converged;
    if (order > 0) return;
    // 2 sum_q w_q mu_q R(mu, mu_q) = sum_q (2 R D)_q D_q.
    const Eigen::VectorXd plane = reflector.rows * flux_weights(grid);
    for (const int i : requested.in) sum.plane_albedo.push_back(plane[i]);
}

bool all_at_zenith(const RequestedDirections& requested, const std::vector<int>& indices) {
    return std::all_of(indices.begin(), indices.end(),
                       [&](int index) { return requested.mu[index] == 1.0; });
}

}  // namespace

bool is_invisible(int m, std::span<const double> azimuth_deg) {
    return std::all_of(azimuth_deg.begin(), azimuth_deg.end(), [m](double azimuth) {
        return std::abs(std::remainder(m * azimuth, 180.0)) == 90.0;
    });
}

MultipleScattering sum_orders(const ScaledStack& stack, const ZenithGrid& grid,
                              const RequestedDirections& requested,
                              std::span<const double> azimuth_deg, double tail_tolerance,
                              const SolverOptions& options, const OrderList& coarser_orders) {
    const std::size_t azimuths = azimuth_deg.size();
    MultipleScattering sum;
    sum.reflection.assign(requested.in.size() * requested.out.size() * azimuths, 0.0);
    const bool zeroth_only =
        all_at_zenith(requested, requested.in) || all_at_zenith(requested, requested.out);
    const int highest = zeroth_only ? 1 : stack.moments;
    const bool keep = is_smooth(stack) && requested.in.size() * requested.out.size() <= most_pairs;

    PhaseMode mode;
    OrderTail tail(tail_tolerance);
    CoarserOrders coarser(coarser_orders, share_of_coarser_orders * options.tolerance);
    int m = 0;
    for (bool ended = false; m < highest && !ended; ++m) {
        if (m > 0 && is_invisible(m, azimuth_deg)) continue;
        Eigen::MatrixXd multiple;
        if (const Eigen::MatrixXd* known = coarser.settled(m)) {
            multiple = *known;
        } else {
            make_phase_mode(m, stack.moments, grid, requested, mode);
            const Reflector reflector =
                solve_stack(stack, mode, grid, requested, options,
                            m == 0 ? ReflectorParts::rows : ReflectorParts::pairs);
            if (!reflector.physical) {
                sum.physical = false;
                return sum;
            }
            note(reflector, m, grid, requested, sum);
            multiple = reflector.multiple;
            coarser.compare(m, multiple, requested);
        }
        sum.orders = m + 1;
        add_order(m, azimuth_deg, multiple, sum.reflection);
        ended = tail.ends_with(largest_bounded(multiple, requested));
        if (keep) {
            sum.by_order.resize(std::size_t(m) + 1);
            sum.by_order.back() = std::move(multiple);
        }
    }
    sum.tail = m == highest ? 0.0 : tail.remaining();  // 0: every order there is
    if (coarser.settled(m - 1) != nullptr) sum.tail = std::max(sum.tail, coarser.difference());
    return sum;
}

Reflector zeroth_order(const ScaledStack& stack, const ZenithGrid& grid,
                       const RequestedDirections& requested, const SolverOptions& options) {
    PhaseMode mode;
    make_phase_mode(0, stack.moments, grid, requested, mode);
    return solve_stack(stack, mode, grid, requested, options, ReflectorParts::nodes);
}

}  // namespace miebrdf::rte
