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

// Moments are dropped where x = (2l + 1) chi_l is below this. If light scattered once is computed
// with all moments, the change of the rest is about max(.002 x, .005 x^2) (docs/numerics.md); if
// not, as below a rough boundary, it is the sum of all moments dropped.
double negligible_moment(const Stack& stack, const SolverOptions& options) {
    const bool is_rough = stack.boundary && stack.boundary->is_rough();
    if (is_rough || !options.single_scattering_correction)
        return kDroppedMomentShare * options.tolerance;
    return std::min(0.05 * std::sqrt(options.tolerance), 20.0 * options.tolerance);
}

// `miebrdf stress` (promises) and tests/rte/random_boundaries_test.cpp count converged results
// beyond their tolerance, which these constants decide about.

// With chi_2n above this the error does not fall geometrically between 2n/3 and n nodes.
constexpr double kSlowAbove = 1e-2;
// Up to this work (nodes cubed times Fourier orders, about .1 s) the next number of nodes is tried
// even if more nodes did not help before.
constexpr double kCheapWork = 8e6;
// Up to this work (.2 s) nodes that carry all moments are tried: solutions with fewer nodes differ
// by the moments that they leave out, and their differences do not tell how good one with all will
// be.
constexpr double kPromisingWork = 5e7;

std::size_t most_moments(const Stack& stack) {
    std::size_t most = stack.base_kind == BaseKind::half_space ? stack.base.chi.size() : 1;
    for (const Coat& coat : stack.coats) most = std::max(most, coat.optics.chi.size());
    return most;
}

// The last moment of a list that was cut short (Optics::has_more_moments) is used by delta-M alone.
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

// Moments up to the last one that is not dropped in some medium.
std::size_t moments_that_show(const Stack& stack, const SolverOptions& options) {
    constexpr std::size_t least = 4;
    std::size_t count = most_moments(stack);
    const double negligible = negligible_moment(stack, options);
    const auto shows = [&](std::size_t l) {
        return (2.0 * double(l) + 1.0) * largest_moment(stack, int(l)) > negligible;
    };
    while (count > least && !shows(count - 1)) --count;
    return count;
}

// With at least this many values the largest difference of two solutions is not small by accident.
constexpr std::size_t kManyValues = 100;

// Only half-spaces count: thin coats converge slowly, like a power of the number of nodes.
bool are_many(std::size_t count, const Stack& stack) {
    return count >= kManyValues && stack.base_kind == BaseKind::half_space && stack.coats.empty() &&
           !stack.boundary;
}

// In a coat thinner than this the radiance changes over cosines of the size of its depth, and the
// first solution has as many nodes as for a third of the tolerance. With fewer, of 2,000 random
// stacks with coats of depth 1e-4 to .01, one or two cosines of .01 and above each, 20 missed a
// tolerance of 1e-4, by up to 8 times (`miebrdf stress` counts those that miss it now: promises,
// smooth thin coats).
constexpr double kThinDepth = 0.01;

bool has_thin_coat(const Stack& stack) {
    return std::any_of(stack.coats.begin(), stack.coats.end(), [](const Coat& coat) {
        return coat.optical_depth > 0.0 && coat.optical_depth < kThinDepth;
    });
}

// Numbers of nodes to try, ascending up to 256; the first by tolerance and phase functions.
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

// Calls visit(k, scale) for each value; its error is relative to scale.
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

// Where light is trapped, the error is at least this share of the difference from the solution with
// 4/9 of the nodes: errors of all values of a stack change their sign together, and slowly as nodes
// are added, so that two solutions may agree by chance. Of 784 solutions of random stacks below
// boundaries (tests/rte/random_boundaries_test.cpp) with 8 to 48 nodes, 97 of 100 erred by less
// than half of this share, 99 of 100 by about this share (.26 to .35).
constexpr double kShareOfTrapped = 0.3;

// The least difference of the last two solutions that is believed, where the first and the last
// differ by `all`: two solutions may agree by chance. Near retro-reflection all of it counts,
// because glories that are resolved in part come and go with each number of nodes.
double least_difference(double all, bool slow, bool backwards) {
    if (slow) return backwards ? all : 0.1 * all;
    return all < 1.0 ? all * std::sqrt(all) : all;
}

// Boundaries and mirrors reflect light back into a layer repeatedly.
bool traps_light(const Stack& stack) {
    return stack.boundary.has_value() || stack.base_kind == BaseKind::mirror;
}

// The least factor between the error of the finer solution and `apart`, its difference from the
// coarser one.
double least_gain(double apart, int coarse, int fine) {
    const double farther = double(fine) / coarse - 1.0;
    return std::pow(apart, 0.25 * std::min(farther, 0.5));
}

// Compares three solutions with about 4n/9, 2n/3 and n nodes. Let d be the difference of the last
// two, q its ratio to that of the first two. The error falls like r^n for smooth phase functions
// and like a power of n at grazing: in both cases the finest solution errs by d q at most. The
// estimate is d q, but at least d^1.125 (r^n alone would be d^1.5; of closer nodes in proportion),
// and d itself where peaks are not resolved (docs/numerics.md).
// @return d
double estimate_error(const Solution& coarsest, const Solution& coarse, Solution& fine,
                      const JudgedValues& judged, bool slow, bool has_many, bool traps,
                      bool has_backwards, double tolerance) {
    SolverReport& report = fine.report;
    const bool by_chance = slow || !has_many;
    const bool has_glory =
        has_backwards && !judged.near_backwards.empty() && (coarsest.has_glory || fine.has_glory);
    const auto last_at = [&](std::size_t k, double scale) {
        const double last = difference(coarse.values[k], fine.values[k], scale);
        if (!coarsest.physical || !by_chance) return last;
        const double both = difference(coarsest.values[k], fine.values[k], scale);
        return std::max(last, least_difference(both, slow, has_glory && judged.near_backwards[k]));
    };
    double gain = 1.0, before = 0.0, now = 0.0;
    visit_values(fine.values, judged, [&](std::size_t k, double scale) {
        if (coarsest.physical)
            keep_largest(before, difference(coarsest.values[k], coarse.values[k], scale));
        keep_largest(now, last_at(k, scale));
    });
    if (coarsest.physical && !slow && now < before && now < 1.0) {
        // The error of closer nodes falls by q again and again.
        const double q = now / before;
        const double left = has_many ? std::min(1.0, q / (1.0 - q)) : q;
        gain = std::max(left, least_gain(now, coarse.report.streams, report.streams));
    }
    std::size_t within = 0;
    double largest = 0.0;
    // Equations are solved to this: two solutions that agree better do so by chance.
    const double least = std::max(report.error_estimate, kEquationShare * tolerance);
    fine.errors.clear();
    visit_values(fine.values, judged, [&](std::size_t k, double scale) {
        double error = gain * last_at(k, scale);
        if (traps && coarsest.physical) {
            keep_largest(error,
                         kShareOfTrapped * difference(coarsest.values[k], fine.values[k], scale));
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

// A solution with so little work is tried even if more nodes did not help before.
bool is_worth_a_try(int streams, int fourier_orders) {
    return work_of(streams, fourier_orders) <= kCheapWork;
}

// Watches the estimates of a ladder of numbers of nodes. Where no number in reach resolves a
// direction (a forward peak seen along the horizon), the estimate stays: climbing on would cost n^3
// and gain nothing.
class LadderProgress {
  public:
    // True once the estimate is twice the best before it, or two steps (twice the nodes) have not
    // halved it.
    bool has_stalled_at(double estimate) {
        const bool grown = estimate > 2.0 * best_;
        const bool idle = estimate > 0.5 * best_before_;
        best_before_ = best_;
        best_ = std::min(best_, estimate);
        return grown || idle;
    }

  private:
    double best_ = std::numeric_limits<double>::infinity();
    double best_before_ = std::numeric_limits<double>::infinity();  // without the last estimate
};

// The fewest nodes of the ladder that carry all moments that are not dropped; 0: none does.
int fewest_carrying(std::span<const int> ladder, const Stack& stack, const SolverOptions& options) {
    const std::size_t moments =
        std::min(most_usable_moments(stack), moments_that_show(stack, options));
    const auto found = std::find_if(ladder.begin(), ladder.end(), [&](int streams) {
        return std::size_t(moments_per_node(streams) * streams) >= moments;
    });
    return found == ladder.end() ? 0 : *found;
}

}  // namespace

bool converges_slowly(const Stack& stack, int streams) {
    // The hot spot of a ground is a cusp, of which nodes miss a share of 1 / n^2.
    return stack.base_kind == BaseKind::brdf || largest_moment(stack, 2 * streams) > kSlowAbove;
}

int first_streams(double tolerance) { return tolerance >= 1e-4 ? 12 : 16; }

int moments_per_node(int streams) { return streams < 4 ? 2 : streams < 12 ? 3 : 4; }

Discretisation choose_discretisation(const Stack& stack, const SolverOptions& options,
                                     int streams) {
    Discretisation choice;
    choice.grid = options.grid == GridKind::automatic ? GridKind::mapped_gauss : options.grid;
    choice.streams = streams;
    const auto carried = std::size_t(moments_per_node(streams) * streams);
    choice.moments =
        int(std::min({carried, most_usable_moments(stack), moments_that_show(stack, options)}));
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
    // With many values the coarsest is solved only where the other two do not agree.
    bool may_be_spared = has_many && !converges_slowly(stack, streams) && before_coarser < coarser;
    if (before_coarser < coarser && !may_be_spared) solve_at(before_coarser, coarsest);
    solve_at(coarser, coarse);
    LadderProgress progress;
    const int carrying = fewest_carrying(ladder, stack, options);
    std::size_t step = 0;
    while (true) {
        solve_at(streams, fine);
        const int orders = fine.report.fourier_orders;
        // For larger spheres no number of nodes resolves glories, of which the unresolved part is
        // known in closed form: few nodes are as good as more.
        const bool can_be_resolved =
            carrying > 0 && work_of(std::max(streams, carrying), orders) <= kPromisingWork;
        const double of_steps = fine.report.error_estimate;
        double apart = 0.0;
        const auto estimate = [&] {
            fine.report.error_estimate = of_steps;
            apart =
                estimate_error(coarsest, coarse, fine, judged, converges_slowly(stack, streams),
                               has_many, traps_light(stack), can_be_resolved, options.tolerance);
        };
        if (fine.physical && coarse.physical) {
            estimate();
            const bool is_needed =
                may_be_spared && !(fine.report.error_estimate <= options.tolerance) &&
                apart * least_gain(apart, coarse.report.streams, streams) <= options.tolerance;
            if (is_needed) {
                solve_at(before_coarser, coarsest);
                estimate();
            }
        } else if (fine.physical) {
            mark_unknown(fine);
        }
        may_be_spared = false;
        fine.steps_converged = fine.report.converged;
        fine.report.converged =
            has_converged(fine.report.error_estimate, options.tolerance, fine.report.converged);
        if (fine.report.converged || step + 1 == ladder.size()) break;
        const bool stalled = fine.physical && progress.has_stalled_at(fine.report.error_estimate);
        // All three solutions must carry all moments, or they differ by these.
        const int fewest = coarsest.physical ? coarsest.report.streams : coarse.report.streams;
        const bool promising = fewest < carrying && can_be_resolved;
        const int next = ladder[++step];
        if (stalled && !promising && !is_worth_a_try(next, orders)) break;
        if (refined && !refined(fine.report, next)) break;
        streams = next;
        std::swap(coarsest, coarse);
        std::swap(coarse, fine);
    }
    name_method(options, choose_discretisation(stack, options, 2).grid, fine.report.method);
    return fine;
}

}  // namespace miebrdf::rte
