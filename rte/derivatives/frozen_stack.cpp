#include "rte/derivatives/frozen_stack.h"

#include <algorithm>
#include <limits>

#include "rte/first_order/first_order_sum.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {
namespace {

Discretisation discretisation_of(const Stack& stack, std::span<const StackChange> changes,
                                 const SolverOptions& options, const SolverReport& solved) {
    const int streams =
        solved.streams > 0 ? solved.streams : first_streams(0.5 * options.tolerance);
    Discretisation discretisation = choose_discretisation(stack, options, streams);
    if (solved.moments > 0) discretisation.moments = solved.moments;
    // The stack is cut off there, or ends and its changes go on.
    const auto has_more = [&](const Stack& one) {
        return largest_moment(one, discretisation.moments) > 0.0;
    };
    const auto go_on = [&] {
        return std::any_of(changes.begin(), changes.end(), [&](const StackChange& change) {
            return has_more(change.plus) || has_more(change.minus);
        });
    };
    if (has_more(stack)) return discretisation;
    while (discretisation.moments < moments_per_node(streams) * streams && go_on())
        ++discretisation.moments;
    return discretisation;
}

SolverOptions solved_to_rounding(SolverOptions options) {
    options.tolerance = kFrozenTolerance;
    return options;
}

}  // namespace

FrozenStack::FrozenStack(const Stack& stack, std::span<const StackChange> changes,
                         const SolverOptions& options, const SolverReport& solved)
    : options_(solved_to_rounding(options)),
      discretisation_(discretisation_of(stack, changes, options, solved)),
      fourier_orders_(discretisation_.moments > solved.moments
                          ? std::max(solved.fourier_orders, discretisation_.moments)
                          : std::max(1, solved.fourier_orders)),
      scaled_(scale(stack)),
      grids_(grids_of(scaled_)) {
    if (options.single_scattering_correction) split_by_resolution(scaled_, grids_);
}

ScaledStack FrozenStack::scale(const Stack& stack) const {
    return scale_stack(stack, discretisation_.moments, options_.delta_m);
}

StackGrids FrozenStack::grids_of(const ScaledStack& scaled) const {
    return {scaled, discretisation_.grid, discretisation_.streams};
}

ScaledStack FrozenStack::scaled_like(const Stack& other) const {
    ScaledStack scaled;
    scaled.rough_boundaries = scaled_.rough_boundaries;
    scale_stack(other, discretisation_.moments, options_.delta_m, scaled);
    if (scaled.media.size() != scaled_.media.size()) return scaled;  // a layer without depth
    for (std::size_t k = 0; k < scaled.media.size(); ++k) {
        ScaledMedium& medium = scaled.media[k];
        const ScaledMedium& like = scaled_.media[k];
        const double factor = medium.scaled.depth_factor;
        scale_optics(medium.exact, discretisation_.moments, options_.delta_m, medium.scaled,
                     &like.scaled);
        medium.scaled_optical_depth *= medium.scaled.depth_factor / factor;
        if (like.narrow.structure.empty()) continue;
        medium.narrow = split_forward_peak(medium.exact.chi, 1, like.scaled.first_cutoff);
        medium.unresolved_shares = like.unresolved_shares;
    }
    return scaled;
}

std::vector<double> frozen_reflection(const FrozenStack& frozen, const ScaledStack& scaled,
                                      const StackGrids& grids, const Directions& directions,
                                      const SolvedLight& light) {
    StackMemory memory;
    const RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    MultipleScattering sum = sum_fourier_orders(scaled, grids, requested, directions.azimuth_deg,
                                                light, 0.0, frozen.options(), memory, {},
                                                KeptOrders::for_finer, frozen.fourier_orders());
    if (!sum.physical) {
        sum.reflection.assign(sum.reflection.size(), std::numeric_limits<double>::quiet_NaN());
        return sum.reflection;
    }
    FirstOrderSum first_order(directions, frozen.options(), light.components, light.shown());
    first_order.add_to(sum.reflection, scaled);
    return sum.reflection;
}

std::vector<double> frozen_first_order(const FrozenStack& frozen, const ScaledStack& scaled,
                                       const Directions& directions, const SolvedLight& light) {
    std::vector<double> reflection(directions.mu_in.size() * directions.mu_out.size() *
                                       directions.azimuth_deg.size() *
                                       std::size_t(light.shown() * light.shown()),
                                   0.0);
    FirstOrderSum(directions, frozen.options(), light.components, light.shown())
        .add_to(reflection, scaled);
    return reflection;
}

AlbedoTable frozen_albedo(const FrozenStack& frozen, const ScaledStack& scaled,
                          const StackGrids& grids, const AlbedoQuestion& question,
                          const std::function<SurfaceWeights(double mu)>& surface) {
    StackMemory memory;
    ScaledStack own = scaled;
    own.transmits = question.transmits;
    const RequestedDirections requested = collect(question.mu_in, {});
    const ZenithGrid& grid = grids.top();
    Eigen::VectorXd let_in = (grid.weights.array() * grid.mu.array()).sqrt(), let_out = let_in;
    for (Eigen::Index q = 0; surface && q < grid.size(); ++q) {
        const SurfaceWeights weights = surface(grid.mu[q]);
        let_in[q] *= weights.in;
        let_out[q] *= weights.out;
    }
    StackSolver solver(own, grids, requested, question.components, frozen.options(), memory);
    const StackOrder& order = solver.solve_albedos(let_in, let_out);
    AlbedoTable table;
    table.plane_albedo = order.plane_albedo;
    table.polarised_plane_albedo = order.polarised_plane_albedo;
    table.spherical_albedo = order.spherical_albedo;
    table.transmittance = order.transmittance;
    if (order.physical) return table;
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    table.plane_albedo.assign(question.mu_in.size(), unknown);
    table.spherical_albedo = unknown;
    return table;
}

}  // namespace miebrdf::rte
