#include "rte/stack/layered_reflection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

#include "rte/first_order/first_order_sum.h"
#include "rte/fourier/fourier_reflection.h"
#include "rte/fourier/order_tail.h"
#include "rte/grid/automatic_streams.h"
#include "rte/grid/azimuth_probes.h"
#include "rte/grid/discretisation.h"

namespace miebrdf::rte {
namespace {

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
    if (!(options.streams == 0 ||
          (options.streams >= fewest_nodes && options.streams <= most_nodes))) {
        throw std::invalid_argument(
            fmt::format("{} streams; allowed: {} to {}, or 0 to choose from the tolerance",
                        options.streams, fewest_nodes, most_nodes));
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

// The same with cosines beside those of a small request, where numbers of nodes are compared too.
RequestedDirections collect_with_probes(const Directions& directions) {
    constexpr std::size_t few = 16;
    constexpr double probes[] = {0.1, 0.35, 0.9};
    RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    const bool are_few = directions.mu_in.size() * directions.mu_out.size() < few;
    if (!are_few || only_order_zero(requested)) return requested;
    std::vector<double> mu_in = directions.mu_in;
    std::vector<double> mu_out = directions.mu_out;
    mu_in.insert(mu_in.end(), std::begin(probes), std::end(probes));
    mu_out.insert(mu_out.end(), std::begin(probes), std::end(probes));
    requested = collect(mu_in, mu_out);
    requested.probes = std::size(probes);
    return requested;
}

Attempt reflect_with(const Stack& stack, std::span<const double> azimuth_deg,
                     const RequestedDirections& requested, const SolverOptions& options,
                     const Discretisation& discretisation, StackMemory& memory, OrderList& orders,
                     FirstOrderSum& first_order) {
    const ScaledStack scaled = scale_stack(stack, discretisation.moments, options.delta_m);
    const ZenithGrid& grid = memory.tables.grid(discretisation.grid, discretisation.streams);
    MultipleScattering multiple =
        sum_orders(scaled, grid, requested, azimuth_deg, share_of_orders * options.tolerance,
                   options, memory, orders);
    orders = std::move(multiple.by_order);
    Attempt attempt;
    attempt.physical = multiple.physical;
    attempt.values = std::move(multiple.reflection);
    attempt.plane_albedo = std::move(multiple.plane_albedo);
    attempt.report.azimuthal_orders = multiple.orders;
    attempt.report.iterations = multiple.iterations;
    attempt.report.converged = multiple.converged && multiple.physical;
    attempt.report.error_estimate = std::max(multiple.tail, multiple.residual);
    if (attempt.physical) first_order.add_to(attempt.values, scaled.media);
    return attempt;
}

Attempt albedo_with(const Stack& stack, const RequestedDirections& requested,
                    const SolverOptions& options, const Discretisation& discretisation,
                    StackMemory& memory, const Boundary& boundary) {
    const ScaledStack scaled = scale_stack(stack, discretisation.moments, options.delta_m);
    const ZenithGrid& grid = memory.tables.grid(discretisation.grid, discretisation.streams);
    // 2 sum_q w_q mu_q R(mu, mu_q) = sum_q (2 R D)_q D_q; the flux of a uniform sky is D itself.
    const Eigen::VectorXd D = flux_weights(grid);
    Eigen::VectorXd let_in = D;
    Eigen::VectorXd let_out = D;
    for (Eigen::Index q = 0; boundary && q < grid.size(); ++q) {
        const BoundaryWeights weights = boundary(grid.mu[q]);
        let_in[q] *= weights.in;
        let_out[q] *= weights.out;
    }
    const Reflector& reflector = zeroth_order(scaled, grid, requested, options, memory, let_out);
    Attempt attempt;
    attempt.physical = reflector.physical;
    if (!attempt.physical) return attempt;
    for (const int i : requested.in) attempt.values.push_back(reflector.sky_at_requested[i]);
    const double entering = let_in.dot(D);  // 0: the boundary is a mirror
    attempt.values.push_back(entering > 0.0 ? let_in.dot(reflector.sky_at_nodes) / entering : 0.0);
    attempt.report.azimuthal_orders = 1;
    attempt.report.iterations = reflector.iterations;
    attempt.report.converged = reflector.converged;
    attempt.report.error_estimate = reflector.residual;
    return attempt;
}

void name_worst_direction(const Directions& directions, SolverReport& report) {
    const std::size_t azimuths = directions.azimuth_deg.size();
    const std::size_t outgoing = directions.mu_out.size();
    if (azimuths == 0 || outgoing == 0 || directions.mu_in.empty()) return;
    const std::size_t pair = report.worst_value / azimuths;
    report.worst_azimuth_deg = directions.azimuth_deg[report.worst_value % azimuths];
    report.worst_mu_out = directions.mu_out[pair % outgoing];
    report.worst_mu_in = directions.mu_in[pair / outgoing];
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
    const AzimuthProbes probes(stack, directions, options);
    const Directions& judged = probes.directions();
    const RequestedDirections requested = collect_with_probes(judged);
    const std::size_t block = judged.mu_out.size() * judged.azimuth_deg.size();
    StackMemory own = memory_for_one();
    StackMemory& memory = options.memory != nullptr ? *options.memory : own;
    OrderList orders;  // of the solution before, with fewer nodes
    FirstOrderSum first_order(judged, options);
    Attempt attempt =
        solve_with_estimate(stack, options, judged.mu_in.size() * block, block,
                            [&](const Discretisation& discretisation) {
                                return reflect_with(stack, judged.azimuth_deg, requested, options,
                                                    discretisation, memory, orders, first_order);
                            });
    attempt.report.worst_value = probes.asked_for(attempt.report.worst_value);
    name_worst_direction(directions, attempt.report);
    if (!attempt.physical) {
        attempt.plane_albedo.assign(directions.mu_in.size(),
                                    std::numeric_limits<double>::quiet_NaN());
    }
    return {probes.without(std::move(attempt.values)), std::move(attempt.plane_albedo),
            std::move(attempt.report)};
}

AlbedoTable albedo(const Stack& stack, const std::vector<double>& mu_in,
                   const SolverOptions& options, const Boundary& boundary) {
    validate(stack);
    require_options(options);
    require_cosines(mu_in, "mu_in");
    const RequestedDirections requested = collect(mu_in, {});
    StackMemory own = memory_for_one();
    StackMemory& memory = options.memory != nullptr ? *options.memory : own;
    Attempt attempt = solve_with_estimate(
        stack, options, mu_in.size() + 1, 1, [&](const Discretisation& discretisation) {
            return albedo_with(stack, requested, options, discretisation, memory, boundary);
        });
    const double spherical_albedo = attempt.values.back();
    attempt.values.pop_back();
    return {std::move(attempt.values), spherical_albedo, std::move(attempt.report)};
}

}  // namespace miebrdf::rte
