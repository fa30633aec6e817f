#include "rte/grid/discretisation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <string>

#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {

double largest_moment(const Stack& stack, int degree) {
    double largest = 0.0;
    const auto look_at = [&](const Optics& optics) {
        const auto l = std::size_t(degree);
        // Moments of backward peaks alternate in sign.
        if (l < optics.chi.size()) largest = std::max(largest, std::abs(optics.chi[l]));
    };
    if (stack.base_kind == BaseKind::half_space) look_at(stack.base);
    for (const Coat& coat : stack.coats) look_at(coat.optics);
    return largest;
}

namespace {

// The last moments are dropped where x = (2l + 1) chi_l is below this. If light scattered once is
// computed with all moments, R changes by about max(.002 x, .005 x^2) (docs/numerics.md); if not,
// as below a rough boundary, by the sum of all x dropped.
double negligible_moment(const Stack& stack, const SolverOptions& options) {
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    if (is_rough || !options.single_scattering_correction)
        return kDroppedMomentShare * options.tolerance;
    return std::min(0.05 * std::sqrt(options.tolerance), 20.0 * options.tolerance);
}

// These constants decide how many converged results err by more than their tolerance;
// `miebrdf stress` (promises) and tests/rte/random_boundaries_test.cpp count them.

// With chi_2n above this the error does not fall geometrically between 2n/3 and n nodes.
constexpr double kSlowAbove = 1e-2;
// Work = nodes^3 x Fourier orders. Up to kCheapWork (about .1 s) the next number of nodes is tried
// even if more nodes did not help before.
constexpr double kCheapWork = 8e6;
// Up to kPromisingWork (.2 s) nodes that keep all moments are tried: solutions with fewer nodes
// differ by the moments dropped, and their differences say nothing about a solution with all.
constexpr double kPromisingWork = 5e7;

std::size_t most_moments(const Stack& stack) {
    std::size_t most = stack.base_kind == BaseKind::half_space ? stack.base.chi.size() : 1;
    for (const Coat& coat : stack.coats) most = std::max(most, coat.optics.chi.size());
    return most;
}

// In a list that was cut short (Optics::has_more_moments) the last moment serves delta-M alone.
std::size_t most_usable_moments(const Stack& stack) {
    std::size_t most = most_moments(stack);
    const auto limit = [&](const Optics& optics) {
        if (!optics.has_more_moments) return;
        most = std::min(most, std::max<std::size_t>(1, optics.chi.size() - 1));
    };
    if (stack.base_kind == BaseKind::half_space) limit(stack.base);
    for (const Coat& coat : stack.coats) limit(coat.optics);
    return most;
}

// The number of moments up to the last one that is not dropped in some medium.
std::size_t moments_not_dropped(const Stack& stack, const SolverOptions& options) {
    constexpr std::size_t least = 4;
    std::size_t count = most_moments(stack);
    const double negligible = negligible_moment(stack, options);
    const auto matters = [&](std::size_t l) {
        return (2.0 * double(l) + 1.0) * largest_moment(stack, int(l)) > negligible;
    };
    while (count > least && !matters(count - 1)) --count;
    return count;
}

// The largest of this many differences of two solutions is not small by chance.
constexpr std::size_t kManyValues = 100;

// Half-spaces alone: with thin coats the error falls slowly, like a power of the number of nodes.
bool are_many(std::size_t count, const Stack& stack) {
    return count >= kManyValues && stack.base_kind == BaseKind::half_space && stack.coats.empty() &&
           !stack.boundary;
}

// In a coat of depth tau the radiance changes within cosines of about tau. Below kThinDepth the
// first solution has as many nodes as for a third of the tolerance: with fewer, 20 of 2,000 random
// stacks (coats of depth 1e-4 to .01, one or two cosines from .01 on) missed a tolerance of 1e-4,
// by up to 8 times. (`miebrdf stress` counts such stacks: promises, smooth thin coats.)
constexpr double kThinDepth = 0.01;

bool has_thin_coat(const Stack& stack) {
    return std::any_of(stack.coats.begin(), stack.coats.end(), [](const Coat& coat) {
        return coat.optical_depth > 0.0 && coat.optical_depth < kThinDepth;
    });
}

// Numbers of nodes to try, ascending; the first one by tolerance and phase functions.
std::span<const int> stream_ladder(const Stack& stack, const SolverOptions& options) {
    static constexpr int kSteps[] = {8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256};
    const bool is_thin = has_thin_coat(stack);
    const int start = is_thin                    ? first_streams(options.tolerance / 3.0)
                      : most_moments(stack) <= 8 ? 8
                                                 : first_streams(options.tolerance);
    return {std::lower_bound(std::begin(kSteps), std::end(kSteps), start), std::end(kSteps)};
}

// The number of nodes of the solution that one with `streams` nodes is compared with.
int coarser_streams(int streams) {
    return streams > 3 ? std::max(2, 2 * streams / 3) : streams + 1;
}

void name_method(const SolverOptions& options, GridKind grid, std::string& name) {
    const char* const half_space[] = {"closed form", "fixed point", "doubling"};
    const char* const coat[] = {"impedance", "first order", "first order, patched", "exponential"};
    const char* const grids[] = {"automatic", "Gauss", "mapped Gauss", "paper"};
    name.clear();
    fmt::format_to(std::back_inserter(name), "{}, {}, {} grid",
                   half_space[int(options.half_space_method)], coat[int(options.coat_method)],
                   grids[int(grid)]);
}

// Calls visit(k, scale) for each value k; `scale` as JudgedValues says.
template <typename Visit>
void visit_values(const std::vector<double>& values, const JudgedValues& judged,
                  const Visit& visit) {
    for (std::size_t start = 0; start < values.size(); start += judged.block) {
        const std::size_t end = std::min(values.size(), start + judged.block);
        double scale = judged.least_scale;
        for (std::size_t k = start; k < end; ++k) scale = std::max(scale, std::abs(values[k]));
        for (std::size_t k = start; k < end; ++k) visit(k, scale);
    }
}

double difference(double a, double b, double scale) {
    const double change = std::abs(b - a);
    return change > 0.0 ? change / scale : 0.0;
}

// value > largest; NaN counts as larger than any number.
bool is_larger(double value, double largest) { return value > largest || std::isnan(value); }

void keep_largest(double& largest, double value) {
    if (is_larger(value, largest)) largest = value;
}

// Errors may change sign together, slowly as nodes are added, so that two solutions agree by
// chance: where light is trapped, and where a forward peak is not resolved. There the error is at
// least this share of the difference from the solution with 4/9 of the nodes. Of 784 solutions of
// random stacks below boundaries (tests/rte/random_boundaries_test.cpp) with 8 to 48 nodes, 97 of
// 100 erred by less than half of this, 99 of 100 by less than about this (.26 to .35).
constexpr double kSharedError = 0.3;

// What is known of a solution before its differences are.
struct Doubts {
    bool slow = false;      // converges_slowly()
    bool has_many = false;  // are_many() values
    bool traps = false;     // traps_light()
    // More nodes would resolve glories.
    bool glories_may_resolve = false;
};

// A floor for the difference of the last two solutions, which may agree by chance. `all` is the
// difference of the first and the last one. Where a peak is not resolved, errors exceed `all`:
// most are within twice `all` near retro-reflection, where glories that are resolved in part come
// and go with each number of nodes. For light that meets the horizon within what n nodes resolve,
// 1 / (2n), `all` itself is the floor, and errors of up to 2.3 times `all` were found (spheres of
// .3 to 12 um; docs/internals/numerics-log.md).
double least_difference(double all, bool slow, bool backwards, bool grazes) {
    if (slow) return backwards ? 2.0 * all : grazes ? all : kSharedError * all;
    return all < 1.0 ? all * std::sqrt(all) : all;
}

// Whether boundaries or mirrors reflect light back into a layer repeatedly.
bool traps_light(const Stack& stack) {
    return stack.boundary.has_value() || stack.base_kind == BaseKind::mirror;
}

// A floor for (error of the finer solution) / (its difference `apart` from the coarser one).
double least_gain(double apart, int coarse, int fine) {
    const double farther = double(fine) / coarse - 1.0;
    return std::pow(apart, 0.25 * std::min(farther, 0.5));
}

// Fills in the errors of the finest of three solutions, with about 4n/9, 2n/3 and n nodes. Let d be
// the difference of the last two, q = d / (the difference of the first two). The error falls like
// r^n for smooth phase functions and like a power of n at grazing angles: either way it is at most
// d q. The estimate is d q, but no less than d^1.125 (r^n alone would give d^1.5; for closer
// numbers of nodes in proportion), and d itself where peaks are not resolved (docs/numerics.md).
// @param coarsest  not `physical`: not computed, and q is taken as 1
// @return d
double estimate_error(const Solution& coarsest, const Solution& coarse, Solution& fine,
                      const JudgedValues& judged, const Doubts& doubts, double tolerance) {
    SolverReport& report = fine.report;
    const bool has_many = doubts.has_many;
    const bool by_chance = doubts.slow || !has_many;
    const bool has_glory = doubts.glories_may_resolve && !judged.near_backwards.empty() &&
                           (coarsest.has_glory || fine.has_glory);
    const double resolved_cosine = 0.5 / report.streams;
    const auto last_at = [&](std::size_t k, double scale) {
        const double last = difference(coarse.values[k], fine.values[k], scale);
        if (!coarsest.physical || !by_chance) return last;
        const double both = difference(coarsest.values[k], fine.values[k], scale);
        const bool grazes = !judged.cosines.empty() && judged.cosines[k] < resolved_cosine;
        return std::max(last, least_difference(both, doubts.slow,
                                               has_glory && judged.near_backwards[k], grazes));
    };
    double gain = 1.0, before = 0.0, now = 0.0;
    visit_values(fine.values, judged, [&](std::size_t k, double scale) {
        if (coarsest.physical)
            keep_largest(before, difference(coarsest.values[k], coarse.values[k], scale));
        keep_largest(now, last_at(k, scale));
    });
    if (coarsest.physical && !doubts.slow && now < before && now < 1.0) {
        // With many values q is trusted as the ratio of a geometric series: rest q / (1 - q).
        const double q = now / before;
        const double rest = has_many ? std::min(1.0, q / (1.0 - q)) : q;
        gain = std::max(rest, least_gain(now, coarse.report.streams, report.streams));
    }
    std::size_t within = 0;
    double largest = 0.0;
    // Solutions that agree better do so by chance.
    const double least = std::max(report.error_estimate, kLeastStatedShare * tolerance);
    fine.errors.clear();
    visit_values(fine.values, judged, [&](std::size_t k, double scale) {
        double error = gain * last_at(k, scale);
        if (doubts.traps && coarsest.physical) {
            keep_largest(error,
                         kSharedError * difference(coarsest.values[k], fine.values[k], scale));
        }
        fine.errors.push_back(std::isnan(error) ? std::numeric_limits<double>::infinity()
                                                : std::max(error, least));
        if (error <= tolerance) ++within;
        if (is_larger(error, largest)) {
            largest = error;
            report.worst_value = k;
        }
    });
    const std::size_t count = fine.values.size();
    report.share_within_tolerance = count == 0 ? 1.0 : double(within) / double(count);
    report.error_estimate = std::max(largest, least);
    return now;
}

void mark_unknown(Solution& solution) {
    constexpr double unknown = std::numeric_limits<double>::infinity();
    solution.errors.assign(solution.values.size(), unknown);
    solution.report.error_estimate = unknown;
    solution.report.share_within_tolerance = 0.0;
}

double work_of(int streams, int fourier_orders) {
    return std::pow(double(streams), 3) * fourier_orders;
}

// Watches the estimates as nodes are added. Where no number in reach resolves a direction (a
// forward peak seen along the horizon), the estimate stays, and further nodes would cost n^3 for
// nothing.
class LadderProgress {
  public:
    // True if the estimate is twice the best before it, or if two steps of the ladder (twice the
    // nodes) have not halved it.
    bool has_stalled_at(double estimate) {
        const bool grown = estimate > 2.0 * best_;
        const bool idle = estimate > 0.5 * best_before_;
        best_before_ = best_;
        best_ = std::min(best_, estimate);
        return grown || idle;
    }

  private:
    double best_ = std::numeric_limits<double>::infinity();
    double best_before_ = std::numeric_limits<double>::infinity();  // one step earlier
};

// The first number of nodes of the ladder that keeps all moments but the dropped ones; 0: none
// does.
int fewest_with_all_moments(std::span<const int> ladder, const Stack& stack,
                            const SolverOptions& options) {
    const std::size_t moments =
        std::min(most_usable_moments(stack), moments_not_dropped(stack, options));
    const auto found = std::find_if(ladder.begin(), ladder.end(), [&](int streams) {
        return std::size_t(moments_per_node(streams) * streams) >= moments;
    });
    return found == ladder.end() ? 0 : *found;
}

}  // namespace

bool converges_slowly(const Stack& stack, int streams) {
    // The hot spot of a ground is a cusp: the error falls like 1 / n^2.
    return stack.base_kind == BaseKind::brdf || largest_moment(stack, 2 * streams) > kSlowAbove;
}

int first_streams(double tolerance) { return tolerance >= 1e-4 ? 12 : 16; }

int moments_per_node(int streams) { return streams < 4 ? 2 : streams < 12 ? 3 : 4; }

Discretisation choose_discretisation(const Stack& stack, const SolverOptions& options,
                                     int streams) {
    Discretisation choice;
    choice.grid = options.grid == GridKind::automatic ? GridKind::mapped_gauss : options.grid;
    choice.streams = streams;
    const auto resolved = std::size_t(moments_per_node(streams) * streams);
    choice.moments =
        int(std::min({resolved, most_usable_moments(stack), moments_not_dropped(stack, options)}));
    return choice;
}

void Solution::clear() {
    values.clear();
    plane_albedo.clear();
    polarised_plane_albedo.clear();
    errors.clear();
    std::string method = std::move(report.method);
    report = {};
    report.method = std::move(method);
    report.method.clear();
    steps_converged = false;
    physical = false;
    has_glory = false;
}

// With too many moments for the nodes the discrete equations have no physical solution: fewer then.
void solve_with_nodes(const Stack& stack, const SolverOptions& options, int streams,
                      std::size_t count, const Solve& solve, Solution& solution) {
    Discretisation discretisation = choose_discretisation(stack, options, streams);
    solution.clear();
    solve(discretisation, solution);
    while (!solution.physical && discretisation.moments > 1) {
        discretisation.moments = std::max(1, 3 * discretisation.moments / 4);
        solution.clear();
        solve(discretisation, solution);
    }
    solution.report.streams = streams;
    solution.report.moments = discretisation.moments;
    if (solution.physical) return;
    solution.values.assign(count, std::numeric_limits<double>::quiet_NaN());
    solution.report.converged = false;
    mark_unknown(solution);
}

Solution& solve_with_estimate(const Stack& stack, const SolverOptions& options,
                              const JudgedValues& judged, const Solve& solve, Solutions& solutions,
                              const RefinementCallback& refined) {
    Solution &coarsest = solutions.coarsest, &coarse = solutions.coarse, &fine = solutions.fine;
    const auto solve_at = [&](int streams, Solution& solution) {
        solve_with_nodes(stack, options, streams, judged.count, solve, solution);
    };
    const bool has_many = are_many(judged.count, stack);
    const std::span<const int> ladder = options.streams == 0
                                            ? stream_ladder(stack, options)
                                            : std::span<const int>(&options.streams, 1);
    int streams = ladder.front();
    const int coarser = coarser_streams(streams), before_coarser = coarser_streams(coarser);
    coarsest.clear();
    // With many values the coarsest solution waits until the other two are seen not to agree.
    bool coarsest_waits = has_many && !converges_slowly(stack, streams) && before_coarser < coarser;
    if (before_coarser < coarser && !coarsest_waits) solve_at(before_coarser, coarsest);
    solve_at(coarser, coarse);
    LadderProgress progress;
    const int with_all_moments = fewest_with_all_moments(ladder, stack, options);
    std::size_t step = 0;
    while (true) {
        solve_at(streams, fine);
        const int orders = fine.report.fourier_orders;
        // The glories of large spheres are resolved by no number of nodes. Their unresolved part is
        // added in closed form, and few nodes do as well as many.
        const bool can_be_resolved =
            with_all_moments > 0 &&
            work_of(std::max(streams, with_all_moments), orders) <= kPromisingWork;
        const double of_equations = fine.report.error_estimate;
        double apart = 0.0;
        const auto estimate = [&] {
            fine.report.error_estimate = of_equations;
            apart = estimate_error(coarsest, coarse, fine, judged,
                                   {.slow = converges_slowly(stack, streams),
                                    .has_many = has_many,
                                    .traps = traps_light(stack),
                                    .glories_may_resolve = can_be_resolved},
                                   options.tolerance);
        };
        if (fine.physical && coarse.physical) {
            estimate();
            const bool is_needed =
                coarsest_waits && !(fine.report.error_estimate <= options.tolerance) &&
                apart * least_gain(apart, coarse.report.streams, streams) <= options.tolerance;
            if (is_needed) {
                solve_at(before_coarser, coarsest);
                estimate();
            }
        } else if (fine.physical) {
            mark_unknown(fine);
        }
        coarsest_waits = false;
        fine.steps_converged = fine.report.converged;
        fine.report.converged =
            has_converged(fine.report.error_estimate, options.tolerance, fine.report.converged);
        if (fine.report.converged || step + 1 == ladder.size()) break;
        const bool stalled = fine.physical && progress.has_stalled_at(fine.report.error_estimate);
        // Until all three solutions keep all moments, they differ by the moments dropped.
        const int fewest = coarsest.physical ? coarsest.report.streams : coarse.report.streams;
        const bool promising = fewest < with_all_moments && can_be_resolved;
        const int next = ladder[++step];
        if (stalled && !promising && work_of(next, orders) > kCheapWork) break;
        if (refined && !refined(fine.report, next)) break;
        streams = next;
        std::swap(coarsest, coarse);
        std::swap(coarse, fine);
    }
    name_method(options, choose_discretisation(stack, options, 2).grid, fine.report.method);
    return fine;
}

}  // namespace miebrdf::rte
