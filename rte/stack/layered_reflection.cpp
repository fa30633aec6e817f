#include "rte/stack/layered_reflection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include <miebrdf/error.h>
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/refracted_first_order.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

struct SolutionMemory::Parts {
    /// With one number of nodes.
    struct Solution {
        int streams = 0;
        ScaledStack scaled = {};
        std::optional<StackGrids> grids = {};
        StackMemory memory = {};
        Eigen::VectorXd flux_weights = {}, let_in = {}, let_out = {};

        /// Of `scaled`.
        const StackGrids& grids_for(const Discretisation& discretisation) {
            if (!grids || !grids->fit(scaled, discretisation.grid, discretisation.streams))
                grids.emplace(scaled, discretisation.grid, discretisation.streams);
            return *grids;
        }
    };

    std::vector<std::unique_ptr<Solution>> solutions = {};
    RequestedDirections requested = {};
    std::vector<double> mu_in = {};  ///< of `requested`
    ScaledStack exact = {};
    Attempts attempts = {};

    /// With more nodes one takes the place of the other: 256 of them are 30 MB.
    Solution& solution_of(int streams) {
        constexpr int most = 64;
        streams = std::min(streams, most + 1);
        const auto found = std::find_if(solutions.begin(), solutions.end(),
                                        [=](const auto& s) { return s->streams == streams; });
        if (found != solutions.end()) return **found;
        solutions.push_back(std::make_unique<Solution>());
        solutions.back()->streams = streams;
        return *solutions.back();
    }
};

namespace {

void require_cosines(const std::vector<double>& cosines, const char* field) {
    for (const double mu : cosines) {
        if (!(mu > 0.0 && mu <= 1.0)) throw UsageError(field, mu, "(0, 1]");
    }
}

/// At the zenith all waves of P_l are along the zenith angle, so that nodes which resolve a degree
/// in part elsewhere do not resolve it there at all (maths-rte.md, section 8). So sharp a change is
/// left out of the values, where tables could not follow it, but not of what is known but roughly.
/// @return how much more that is
double more_unresolved_at_zenith(const ScaledStack& stack) {
    double most = 1.0;
    for (const ScaledMedium& medium : stack.media) {
        double in_values = 0.0, at_zenith = 0.0;
        const auto degrees =
            std::min(medium.unresolved_shares.size() / kResolvedAngles,
                     std::size_t(medium.narrow.first_degree) + medium.narrow.rest.size());
        for (auto l = std::size_t(medium.narrow.first_degree); l < degrees; ++l) {
            const double share = medium.unresolved_shares[l * kResolvedAngles];
            const double rest = medium.narrow.rest[l - std::size_t(medium.narrow.first_degree)];
            const double size = (2.0 * double(l) + 1.0) * std::abs(rest);
            in_values += share * size;
            at_zenith += share > 0.0 ? size : 0.0;
        }
        if (in_values > 0.0) most = std::max(most, at_zenith / in_values);
    }
    return most;
}

void add_at_zenith(const Directions& directions, double factor, std::vector<double>& unresolved) {
    const double near_zenith = std::cos(5.0 * std::numbers::pi / 180.0);
    auto value = unresolved.begin();
    for (const double in : directions.mu_in) {
        for (const double out : directions.mu_out) {
            const auto end = value + std::ptrdiff_t(directions.azimuth_deg.size());
            for (; value != end; ++value) {
                if (std::min(in, out) >= near_zenith) *value *= factor;
            }
        }
    }
}

void reflect_with(const Stack& stack, const Directions& directions,
                  const RequestedDirections& requested, const SolverOptions& options,
                  const Discretisation& discretisation, SolutionMemory::Parts::Solution& solution,
                  FourierOrders& orders, StackFirstOrder& first_order, Attempt& attempt) {
    ScaledStack& scaled = solution.scaled;
    scale_stack(stack, discretisation.moments, options.delta_m, NarrowPart::ignored, scaled);
    if (scaled.media.size() > 1 || scaled.base != BaseKind::half_space)
        scaled.brightness = least_brightness(scaled, directions);
    const StackGrids& grids = solution.grids_for(discretisation);
    if (options.single_scattering_correction) split_by_resolution(scaled, grids);
    MultipleScattering multiple = sum_fourier_orders(
        scaled, grids, requested, directions.azimuth_deg, kFourierTailShare * options.tolerance,
        options, &solution.memory, orders);
    orders = std::move(multiple.by_fourier_order);
    attempt.physical = multiple.physical;
    attempt.values = std::move(multiple.reflection);
    attempt.plane_albedo = std::move(multiple.plane_albedo);
    attempt.report.fourier_orders = multiple.fourier_orders;
    attempt.report.iterations = multiple.iterations;
    attempt.report.converged = multiple.converged && multiple.physical;
    attempt.report.error_estimate = std::max(multiple.tail, multiple.residual);
    // However well two solutions agree: no order but the first is solved better.
    if (multiple.fourier_orders > 1) {
        attempt.report.error_estimate =
            std::max(attempt.report.error_estimate, kEquationShare * options.tolerance);
    }
    if (!attempt.physical) return;
    first_order.add_to(attempt.values, scaled, &attempt.unresolved);
    if (!attempt.unresolved.empty())
        add_at_zenith(directions, more_unresolved_at_zenith(scaled), attempt.unresolved);
}

/// Light that passes the layers is gone, or is the ground's; what a surface above does to it is not
/// known here.
bool has_transmittance(BaseKind base, const SolverOptions& options, bool has_surface) {
    return base != BaseKind::half_space && !has_surface &&
           options.coat_method == CoatMethod::automatic;
}

void albedo_with(const Stack& stack, const RequestedDirections& requested,
                 const SolverOptions& options, const Discretisation& discretisation,
                 SolutionMemory::Parts::Solution& solution,
                 const std::function<SurfaceWeights(double mu)>& surface, Attempt& attempt) {
    ScaledStack& scaled = solution.scaled;
    scale_stack(stack, discretisation.moments, options.delta_m, NarrowPart::ignored, scaled);
    scaled.transmits = has_transmittance(scaled.base, options, bool(surface));
    const StackGrids& grids = solution.grids_for(discretisation);
    const ZenithGrid& grid = grids.top();
    // 2 sum_q w_q mu_q R(mu, mu_q) = sum_q (2 R D)_q D_q; the flux of a uniform sky is D itself.
    Eigen::VectorXd& D = solution.flux_weights;
    Eigen::VectorXd& let_in = solution.let_in;
    Eigen::VectorXd& let_out = solution.let_out;
    D = (grid.weights.array() * grid.mu.array()).sqrt();
    let_in = D;
    let_out = D;
    for (Eigen::Index q = 0; surface && q < grid.size(); ++q) {
        const SurfaceWeights weights = surface(grid.mu[q]);
        let_in[q] *= weights.in;
        let_out[q] *= weights.out;
    }
    StackSolver solver(scaled, grids, requested, options, solution.memory);
    const Reflector& reflector = solver.solve(0, ReflectorParts::sky, let_out);
    attempt.physical = reflector.physical;
    if (!attempt.physical) return;
    attempt.values.reserve((requested.in.size() + 1) * (scaled.transmits ? 2 : 1));
    const bool has_mirror = reflector.specular.size() > 0;
    for (const int i : requested.in) {
        const double mirrored = has_mirror ? reflector.specular[i] : 0.0;
        attempt.values.push_back(mirrored + reflector.sky_at_requested[i]);
    }
    const double entering = let_in.dot(D);  // 0: the surface is a mirror
    attempt.values.push_back(entering > 0.0 ? let_in.dot(reflector.sky_at_nodes) / entering : 0.0);
    if (scaled.transmits) {
        const double absorbed = 1.0 - scaled.ground_albedo;
        for (const int i : requested.in)
            attempt.values.push_back(absorbed * reflector.glow_at_requested[i]);
        attempt.values.push_back(absorbed * D.dot(reflector.glow_at_nodes) / D.squaredNorm());
    }
    attempt.report.fourier_orders = 1;
    attempt.report.iterations = reflector.iterations;
    attempt.report.converged = reflector.converged;
    attempt.report.error_estimate = reflector.residual;
}

// Nothing scattered is taken for a beam here: with the optical depths as they are.
void find_mirror_reflectances(const Stack& stack, const std::vector<double>& mu_in,
                              ScaledStack& exact, std::vector<double>& reflectances) {
    reflectances.clear();
    if (!stack.boundary && lowest_kind(stack) != BaseKind::mirror) return;
    scale_stack(stack, 1, false, NarrowPart::ignored, exact);
    if (exact.top_index == 1.0 && !exact.has_mirrors()) return;
    if (exact.boundary && exact.boundary->is_rough()) return;
    for (const double mu : mu_in) reflectances.push_back(mirror_reflectance(exact, mu));
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

SolutionMemory::SolutionMemory() : parts_(std::make_unique<Parts>()) {}
SolutionMemory::~SolutionMemory() = default;
SolutionMemory::SolutionMemory(SolutionMemory&&) noexcept = default;
SolutionMemory& SolutionMemory::operator=(SolutionMemory&&) noexcept = default;

void validate(const Directions& directions) {
    require_cosines(directions.mu_in, "mu_in");
    require_cosines(directions.mu_out, "mu_out");
    for (const double azimuth : directions.azimuth_deg) {
        if (!std::isfinite(azimuth)) {
            throw UsageError("azimuth_deg", azimuth, "any finite number");
        }
    }
}

void validate(const SolverOptions& options) {
    if (!(options.tolerance > 0.0 && options.tolerance < 1.0)) {
        throw UsageError("tolerance", options.tolerance, "(0, 1)");
    }
    if (!(options.streams == 0 ||
          (options.streams >= kFewestNodes && options.streams <= kMostNodes))) {
        throw UsageError(
            "streams", options.streams,
            fmt::format("{} to {}, or 0 to choose from the tolerance", kFewestNodes, kMostNodes));
    }
    if (!(options.coat_substeps >= 1 && options.coat_substeps <= 1000000)) {
        throw UsageError("coat_substeps", options.coat_substeps, "1 to 1000000");
    }
}

ReflectionTable reflect(const Stack& stack, const Directions& directions,
                        const SolverOptions& options, SolutionMemory* memory,
                        const LadderWatch& watch) {
    validate(stack);
    validate(options);
    validate(directions);
    const AzimuthProbes probes(stack, directions, options);
    const Directions& judged = probes.directions();
    const RequestedDirections requested = collect_with_probes(judged);
    const std::size_t block = judged.mu_out.size() * judged.azimuth_deg.size();
    std::optional<SolutionMemory> own;
    SolutionMemory::Parts& kept = (memory != nullptr ? *memory : own.emplace()).parts();
    FourierOrders orders;  // of the solution before, with fewer nodes
    int nodes_before = 0;
    StackFirstOrder first_order(judged, options);
    Attempts attempts;
    Attempt& attempt = solve_with_estimate(
        stack, options, judged.mu_in.size() * block, block,
        [&](const Discretisation& discretisation, Attempt& one) {
            // One with fewer nodes owes nothing to those with more.
            FourierOrders none;
            const bool is_finer = discretisation.streams >= nodes_before;
            if (is_finer) nodes_before = discretisation.streams;
            reflect_with(stack, judged, requested, options, discretisation,
                         kept.solution_of(discretisation.streams), is_finer ? orders : none,
                         first_order, one);
        },
        attempts, watch, near_retro_reflection(judged));
    attempt.report.worst_value = probes.asked_for(attempt.report.worst_value);
    name_worst_direction(directions, attempt.report);
    if (!attempt.physical) {
        attempt.plane_albedo.assign(directions.mu_in.size(),
                                    std::numeric_limits<double>::quiet_NaN());
    }
    ReflectionTable table{probes.without(std::move(attempt.values)),
                          std::move(attempt.plane_albedo),
                          {},
                          probes.believed(attempt.errors),
                          attempt.steps_converged,
                          std::move(attempt.report)};
    ScaledStack exact;
    find_mirror_reflectances(stack, directions.mu_in, exact, table.mirror_reflectance);
    return table;
}

AlbedoTable albedo(const Stack& stack, const std::vector<double>& mu_in,
                   const SolverOptions& options,
                   const std::function<SurfaceWeights(double mu)>& surface,
                   SolutionMemory* memory) {
    std::optional<SolutionMemory> own;
    AlbedoTable table;
    albedo(stack, mu_in, options, surface, memory != nullptr ? *memory : own.emplace(), table);
    return table;
}

void albedo(const Stack& stack, const std::vector<double>& mu_in, const SolverOptions& options,
            const std::function<SurfaceWeights(double mu)>& surface, SolutionMemory& memory,
            AlbedoTable& table) {
    validate(stack);
    validate(options);
    require_cosines(mu_in, "mu_in");
    SolutionMemory::Parts& kept = memory.parts();
    if (kept.mu_in != mu_in) {
        kept.requested = collect(mu_in, {});
        kept.mu_in = mu_in;
    }
    const bool transmits = has_transmittance(lowest_kind(stack), options, bool(surface));
    const std::size_t values_wanted = (mu_in.size() + 1) * (transmits ? 2 : 1);
    const auto solve = [&](const Discretisation& discretisation, Attempt& attempt) {
        albedo_with(stack, kept.requested, options, discretisation,
                    kept.solution_of(discretisation.streams), surface, attempt);
    };
    Attempt& attempt =
        solve_with_estimate(stack, options, values_wanted, 1, std::cref(solve), kept.attempts);
    const auto plane = attempt.values.begin();
    const auto spherical = plane + std::ptrdiff_t(mu_in.size());
    table.plane_albedo.assign(plane, spherical);
    table.spherical_albedo = *spherical;
    table.transmittance.assign(spherical + 1, attempt.values.end());
    find_mirror_reflectances(stack, mu_in, kept.exact, table.mirror_reflectance);
    table.report = attempt.report;
}

}  // namespace miebrdf::rte
