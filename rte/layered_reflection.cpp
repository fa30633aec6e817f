#include "rte/layered_reflection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "rte/discretisation.h"
#include "rte/fourier_reflection.h"
#include "rte/narrow_features.h"

namespace miebrdf::rte {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

void require_cosines(const std::vector<double>& cosines, const char* name) {
    for (const double mu : cosines) {
        if (!(mu > 0.0 && mu <= 1.0)) {
            throw std::invalid_argument(fmt::format("{} {}; allowed: (0, 1]", name, mu));
        }
    }
}

void require_options(const SolverOptions& options) {
    if (!(options.tolerance > 0.0 && options.tolerance < 1.0)) {
        throw std::invalid_argument(
            fmt::format("tolerance {}; allowed: (0, 1)", options.tolerance));
    }
    if (!(options.streams == 0 || (options.streams >= 2 && options.streams <= 256))) {
        throw std::invalid_argument(fmt::format(
            "{} streams; allowed: 2 to 256, or 0 to choose from the tolerance", options.streams));
    }
    if (!(options.coat_substeps >= 1 && options.coat_substeps <= 1000000)) {
        throw std::invalid_argument(
            fmt::format("{} coat substeps; allowed: 1 to 1000000", options.coat_substeps));
    }
}

// Each cosine once, ascending, with the positions of both lists.
RequestedDirections collect(const std::vector<double>& mu_in, const std::vector<double>& mu_out) {
    std::vector<double> cosines = mu_in;
    cosines.insert(cosines.end(), mu_out.begin(), mu_out.end());
    std::sort(cosines.begin(), cosines.end());
    cosines.erase(std::unique(cosines.begin(), cosines.end()), cosines.end());
    const auto position = [&](double mu) {
        return int(std::lower_bound(cosines.begin(), cosines.end(), mu) - cosines.begin());
    };
    RequestedDirections requested;
    requested.mu = Eigen::Map<const Eigen::VectorXd>(cosines.data(), Eigen::Index(cosines.size()));
    for (const double mu : mu_in) requested.in.push_back(position(mu));
    for (const double mu : mu_out) requested.out.push_back(position(mu));
    return requested;
}

std::string method_name(const SolverOptions& options, GridKind grid) {
    const char* const half_space[] = {"closed form", "fixed point", "doubling"};
    const char* const coat[] = {"impedance", "first order", "first order, patched", "exponential"};
    const char* const grids[] = {"automatic", "Gauss", "mapped Gauss", "paper"};
    return fmt::format("{}, {}, {} grid", half_space[int(options.half_space_method)],
                       coat[int(options.coat_method)], grids[int(grid)]);
}

struct Attempt {
    std::vector<double> values;  ///< reflection, or plane albedos and the spherical albedo
    SolverReport report;
    bool physical = false;
};

// First order, and what is narrower than the moments kept, to a fiftieth of the tolerance.
void add_first_order(const ScaledStack& stack, const Directions& directions,
                     const SolverOptions& options, std::vector<double>& reflection) {
    std::vector<double> cos_azimuth;
    for (const double azimuth : directions.azimuth_deg) {
        cos_azimuth.push_back(std::cos(azimuth * (std::numbers::pi / 180.0)));
    }
    double mu_least = 1.0;
    for (const double mu : directions.mu_in) mu_least = std::min(mu_least, mu);
    for (const double mu : directions.mu_out) mu_least = std::min(mu_least, mu);
    NarrowFeatures narrow;
    if (options.single_scattering_correction) {
        narrow = NarrowFeatures(stack.media, mu_least, 0.02 * options.tolerance);
    }
    double* next = reflection.data();
    for (const double mu_in : directions.mu_in) {
        for (const double mu_out : directions.mu_out) {
            narrow.add_to(next, mu_in, mu_out, cos_azimuth);
            for (const double cosine : cos_azimuth) {
                *next++ += single_scattering(stack.media, options.single_scattering_correction,
                                             mu_in, mu_out, cosine);
            }
        }
    }
}

// With too many moments for the nodes the discrete equations have no physical solution: fewer then.
template <typename Solve>
Attempt with_fewer_moments_if_needed(Discretisation discretisation, Solve solve) {
    Attempt attempt = solve(discretisation);
    while (!attempt.physical && discretisation.moments > 1) {
        discretisation.moments = std::max(1, 3 * discretisation.moments / 4);
        attempt = solve(discretisation);
    }
    attempt.report.streams = discretisation.streams;
    attempt.report.moments = discretisation.moments;
    return attempt;
}

Attempt reflect_with(const Stack& stack, const Directions& directions,
                     const RequestedDirections& requested, const SolverOptions& options,
                     const Discretisation& discretisation) {
    const ScaledStack scaled = scale_stack(stack, discretisation.moments, options.delta_m);
    const ZenithGrid grid = make_zenith_grid(discretisation.grid, discretisation.streams);
    MultipleScattering multiple = sum_orders(scaled, grid, requested, directions.azimuth_deg,
                                             0.1 * options.tolerance, options);
    Attempt attempt;
    attempt.physical = multiple.physical;
    attempt.values = std::move(multiple.reflection);
    attempt.report.azimuthal_orders = multiple.orders;
    attempt.report.iterations = multiple.iterations;
    attempt.report.converged = multiple.converged && multiple.physical;
    attempt.report.error_estimate = std::max(multiple.tail, multiple.residual);
    if (attempt.physical) add_first_order(scaled, directions, options, attempt.values);
    return attempt;
}

Attempt albedo_with(const Stack& stack, const RequestedDirections& requested,
                    const SolverOptions& options, const Discretisation& discretisation) {
    const ScaledStack scaled = scale_stack(stack, discretisation.moments, options.delta_m);
    const ZenithGrid grid = make_zenith_grid(discretisation.grid, discretisation.streams);
    const Reflector reflector = zeroth_order(scaled, grid, requested, options);
    Attempt attempt;
    attempt.physical = reflector.physical;
    if (!attempt.physical) return attempt;
    // 2 sum_q w_q mu_q R(mu, mu_q) = sum_q (2 R D)_q D_q; the flux of a uniform sky is D itself.
    const Eigen::VectorXd D = flux_weights(grid);
    const Eigen::VectorXd plane = reflector.rows * D;
    for (const int i : requested.in) attempt.values.push_back(plane[i]);
    attempt.values.push_back(D.dot(reflector.nodes * D) / D.squaredNorm());
    attempt.report.azimuthal_orders = 1;
    attempt.report.iterations = reflector.iterations;
    attempt.report.converged = reflector.converged;
    attempt.report.error_estimate = reflector.residual;
    return attempt;
}

// Largest difference of two tables relative to the largest value in each block (one incidence).
double relative_difference(const std::vector<double>& a, const std::vector<double>& b,
                           std::size_t block) {
    double largest = 0.0;
    for (std::size_t start = 0; block > 0 && start < a.size(); start += block) {
        double scale = 0.0;
        double difference = 0.0;
        for (std::size_t k = start; k < std::min(a.size(), start + block); ++k) {
            scale = std::max(scale, std::abs(a[k]));
            difference = std::max(difference, std::abs(a[k] - b[k]));
        }
        if (difference > 0.0) largest = std::max(largest, difference / scale);
    }
    return largest;
}

// What the finer of two solutions still lacks. The error falls like r^n for smooth phase functions:
// with 2n/3 against n nodes that is the difference to the power 1.5, of which 1.25 is claimed;
// unresolved peaks fall algebraically and keep the difference itself (docs/numerics.md).
double remaining_error(double difference, bool peaked) {
    return peaked || difference >= 1.0 ? difference : std::pow(difference, 1.25);
}

// Matrix products of n terms, the sums over orders, the files' own digits: never claim less.
constexpr double rounding = 1e-13;

void require_physical(Attempt& attempt, std::size_t count) {
    if (attempt.physical) return;
    attempt.values.assign(count, not_a_number);
    attempt.report.converged = false;
    attempt.report.error_estimate = std::numeric_limits<double>::infinity();
}

// Watches the estimates of a ladder of stream counts. Directions that no number of nodes in reach
// resolves (a forward peak seen along the horizon) keep the estimate where it is: climbing on would
// cost n^3 and gain nothing.
class Progress {
  public:
    /// True once two steps in a row have not halved the best estimate so far.
    bool has_stalled_at(double estimate) {
        idle_steps_ = estimate <= 0.5 * best_ ? 0 : idle_steps_ + 1;
        best_ = std::min(best_, estimate);
        return idle_steps_ >= 2;
    }

  private:
    double best_ = std::numeric_limits<double>::infinity();
    int idle_steps_ = 0;
};

// Two numbers of nodes give the result and what its error may be; without a given number of nodes
// they grow until the estimate meets the tolerance or stops falling.
template <typename Solve>
Attempt solve_with_estimate(const Stack& stack, const SolverOptions& options, std::size_t count,
                            std::size_t block, Solve solve) {
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
        if (fine.physical) {
            const double difference = coarse.physical
                                          ? relative_difference(fine.values, coarse.values, block)
                                          : std::numeric_limits<double>::infinity();
            fine.report.error_estimate =
                std::max({fine.report.error_estimate, rounding,
                          remaining_error(difference, strongly_peaked(stack, streams))});
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

}  // namespace

ReflectionTable reflect(const Stack& stack, const Directions& directions,
                        const SolverOptions& options) {
    validate(stack);
    require_options(options);
    require_cosines(directions.mu_in, "mu_in");
    require_cosines(directions.mu_out, "mu_out");
    for (const double azimuth : directions.azimuth_deg) {
        if (!std::isfinite(azimuth)) {
            throw std::invalid_argument(
                fmt::format("azimuth {} degrees; allowed: any finite number", azimuth));
        }
    }
    const RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    const std::size_t block = directions.mu_out.size() * directions.azimuth_deg.size();
    Attempt attempt = solve_with_estimate(stack, options, directions.mu_in.size() * block, block,
                                          [&](const Discretisation& discretisation) {
                                              return reflect_with(stack, directions, requested,
                                                                  options, discretisation);
                                          });
    return {std::move(attempt.values), std::move(attempt.report)};
}

AlbedoTable albedo(const Stack& stack, const std::vector<double>& mu_in,
                   const SolverOptions& options) {
    validate(stack);
    require_options(options);
    require_cosines(mu_in, "mu_in");
    const RequestedDirections requested = collect(mu_in, {});
    Attempt attempt = solve_with_estimate(
        stack, options, mu_in.size() + 1, 1, [&](const Discretisation& discretisation) {
            return albedo_with(stack, requested, options, discretisation);
        });
    const double spherical_albedo = attempt.values.back();
    attempt.values.pop_back();
    return {std::move(attempt.values), spherical_albedo, std::move(attempt.report)};
}

}  // namespace miebrdf::rte
