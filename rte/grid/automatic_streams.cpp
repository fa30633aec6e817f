#include "rte/grid/automatic_streams.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace miebrdf::rte {
namespace {

std::string method_name(const SolverOptions& options, GridKind grid) {
    const char* const half_space[] = {"closed form", "fixed point", "doubling"};
    const char* const coat[] = {"impedance", "first order", "first order, patched", "exponential"};
    const char* const grids[] = {"automatic", "Gauss", "mapped Gauss", "paper"};
    return fmt::format("{}, {}, {} grid", half_space[int(options.half_space_method)],
                       coat[int(options.coat_method)], grids[int(grid)]);
}

// With too many moments for the nodes the discrete equations have no physical solution: fewer then.
Attempt with_fewer_moments_if_needed(Discretisation discretisation, const Solve& solve) {
    Attempt attempt = solve(discretisation);
    while (!attempt.physical && discretisation.moments > 1) {
        discretisation.moments = std::max(1, 3 * discretisation.moments / 4);
        attempt = solve(discretisation);
    }
    attempt.report.streams = discretisation.streams;
    attempt.report.moments = discretisation.moments;
    return attempt;
}

// Matrix products of n terms, the sums over orders, the files' own digits: never claim less.
constexpr double rounding = 1e-13;

// What the finer of two solutions still lacks. The error falls like r^n for smooth phase functions:
// with 2n/3 against n nodes that is the difference to the power 1.5, of which 1.25 is claimed;
// unresolved peaks fall more slowly and keep the difference itself (docs/numerics.md).
double claimed_power(bool slow) { return slow ? 1.0 : 1.25; }

double remaining_error(double difference, double power) {
    return difference >= 1.0 ? difference : std::pow(difference, power);
}

// Compares two tables, relative to the largest value in each block (one incidence). The claimed
// error rises with the difference, so that differences can be compared in its place.
void estimate_error(const Attempt& coarse, Attempt& fine, std::size_t block, bool slow,
                    double tolerance) {
    SolverReport& report = fine.report;
    const double power = claimed_power(slow);
    const double allowed = std::pow(tolerance, 1.0 / power);
    double largest = 0.0;
    std::size_t within = 0;
    const std::size_t count = fine.values.size();
    for (std::size_t start = 0; start < count; start += block) {
        const std::size_t end = std::min(count, start + block);
        double scale = 0.0;
        for (std::size_t k = start; k < end; ++k) scale = std::max(scale, std::abs(fine.values[k]));
        for (std::size_t k = start; k < end; ++k) {
            const double change = std::abs(fine.values[k] - coarse.values[k]);
            const double difference = change > 0.0 ? change / scale : 0.0;
            if (difference <= allowed) ++within;
            if (difference > largest) {
                largest = difference;
                report.worst_value = k;
            }
        }
    }
    report.share_within_tolerance = count > 0 ? double(within) / double(count) : 1.0;
    report.error_estimate =
        std::max({report.error_estimate, rounding, remaining_error(largest, power)});
}

void require_physical(Attempt& attempt, std::size_t count) {
    if (attempt.physical) return;
    attempt.values.assign(count, std::numeric_limits<double>::quiet_NaN());
    attempt.report.converged = false;
    attempt.report.error_estimate = std::numeric_limits<double>::infinity();
    attempt.report.share_within_tolerance = 0.0;
}

// Watches the estimates of a ladder of stream counts. Directions that no number of nodes in reach
// resolves (a forward peak seen along the horizon) keep the estimate where it is: climbing on would
// cost n^3 and gain nothing.
class Progress {
  public:
    /// True once the estimate has grown to twice the best before it, or two steps (twice the nodes)
    /// have not halved it.
    bool has_stalled_at(double estimate) {
        const bool grown = estimate > 2.0 * best_;
        const bool idle = estimate > 0.5 * best_before_;
        best_before_ = best_;
        best_ = std::min(best_, estimate);
        return grown || idle;
    }

  private:
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    double best_ = infinity;
    double best_before_ = infinity;  ///< without the last estimate
};

}  // namespace

Attempt solve_with_estimate(const Stack& stack, const SolverOptions& options, std::size_t count,
                            std::size_t block, const Solve& solve) {
    const auto attempt_at = [&](int streams) {
        Attempt attempt =
            with_fewer_moments_if_needed(choose_discretisation(stack, options, streams), solve);
        require_physical(attempt, count);
        return attempt;
    };
    std::vector<int> ladder{options.streams};
    if (options.streams == 0) ladder = stream_ladder(stack, options);
    Attempt coarse = attempt_at(coarser_streams(ladder.front()));
    Attempt fine;
    Progress progress;
    for (const int streams : ladder) {
        fine = attempt_at(streams);
        if (fine.physical && coarse.physical) {
            estimate_error(coarse, fine, block, converges_slowly(stack, streams),
                           options.tolerance);
        } else if (fine.physical) {
            fine.report.error_estimate = std::numeric_limits<double>::infinity();
            fine.report.share_within_tolerance = 0.0;
        }
        fine.report.converged =
            fine.report.converged && fine.report.error_estimate <= options.tolerance;
        if (fine.report.converged) break;
        if (fine.physical && progress.has_stalled_at(fine.report.error_estimate)) break;
        coarse = fine;
    }
    fine.report.method = method_name(options, choose_discretisation(stack, options, 2).grid);
    return fine;
}

}  // namespace miebrdf::rte
