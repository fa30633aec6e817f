// Plane and spherical albedos and transmittances: Fourier order 0 alone.
#include <algorithm>
#include <functional>
#include <optional>

#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/solution_memory.h"

namespace miebrdf::rte {
namespace {

/// Whether transmittances are computed: there is a bottom, the method of coats is automatic, and no
/// surface lies on the layers (the light that enters through it is not known here).
bool has_transmittance(BaseKind base, const SolverOptions& options, bool has_surface) {
    return base != BaseKind::half_space && !has_surface &&
           options.coat_method == CoatMethod::automatic;
}

struct AlbedoRequest {
    const Stack& stack;
    int components;
    const SolverOptions& options;
    const std::function<SurfaceWeights(double mu)>& surface;
};

std::size_t count_of_values(const AlbedoRequest& request, std::size_t incidences) {
    const bool transmits =
        has_transmittance(lowest_kind(request.stack), request.options, bool(request.surface));
    const std::size_t polarised = request.components > 1 ? incidences : 0;
    return incidences + polarised + 1 + (transmits ? incidences + 1 : 0);
}

void albedo_with(const AlbedoRequest& request, const RequestedDirections& requested,
                 const Discretisation& discretisation, SolutionParts::AtStreams& memory,
                 Solution& solution) {
    const SolverOptions& options = request.options;
    ScaledStack& scaled = memory.scaled;
    scale_stack(request.stack, discretisation.moments, options.delta_m, scaled);
    scaled.transmits = has_transmittance(scaled.base, options, bool(request.surface));
    const StackGrids& grids = memory.grids_for(discretisation);
    const ZenithGrid& grid = grids.top();
    Eigen::VectorXd &let_in = memory.let_in, &let_out = memory.let_out;
    let_in = (grid.weights.array() * grid.mu.array()).sqrt();
    let_out = let_in;
    for (Eigen::Index q = 0; request.surface && q < grid.size(); ++q) {
        const SurfaceWeights weights = request.surface(grid.mu[q]);
        let_in[q] *= weights.in;
        let_out[q] *= weights.out;
    }
    StackSolver solver(scaled, grids, requested, request.components, options, memory.memory);
    const StackOrder& order = solver.solve_albedos(let_in, let_out);
    solution.physical = order.physical;
    if (!order.physical) return;
    const auto append = [&](const std::vector<double>& values) {
        solution.values.insert(solution.values.end(), values.begin(), values.end());
    };
    append(order.plane_albedo);
    append(order.polarised_plane_albedo);
    solution.values.push_back(order.spherical_albedo);
    append(order.transmittance);
    solution.report.fourier_orders = 1;
    solution.report.iterations = order.iterations;
    solution.report.converged = order.converged;
    solution.report.error_estimate = order.residual;
}

void find_albedos(const AlbedoRequest& request, const std::vector<double>& mu_in,
                  SolutionMemory& memory, AlbedoTable& table) {
    SolutionParts& kept = SolutionParts::of(memory);
    if (kept.mu_in != mu_in) {
        kept.requested = collect(mu_in, {});
        kept.mu_in = mu_in;
    }
    const std::size_t count = mu_in.size(), polarised = request.components > 1 ? count : 0;
    const std::size_t values_wanted = count_of_values(request, count);
    const auto solve = [&](const Discretisation& discretisation, Solution& solution) {
        albedo_with(request, kept.requested, discretisation,
                    kept.with_streams(discretisation.streams), solution);
    };
    const JudgedValues values{.count = values_wanted,
                              .block = polarised > 0 ? values_wanted : 1,
                              .least_scale = kLeastJudgedFlux};
    Solution& solution = solve_with_estimate(request.stack, request.options, values,
                                             std::cref(solve), kept.solutions_of_albedo);
    const auto plane = solution.values.begin();
    const auto change = plane + std::ptrdiff_t(count),
               spherical = change + std::ptrdiff_t(polarised);
    table.plane_albedo.assign(plane, change);
    table.polarised_plane_albedo.assign(change, spherical);
    table.spherical_albedo = *spherical;
    table.transmittance.assign(spherical + 1, solution.values.end());
    find_mirror_reflectances(request.stack, mu_in, {request.components, true}, kept.exact,
                             table.mirror_reflectance);
    find_unscattered(request.stack, mu_in, request.components, kept.exact,
                     table.unscattered_transmittance);
    table.report = solution.report;
}

}  // namespace

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
    find_albedos({stack, 1, options, surface}, mu_in, memory, table);
}

AlbedoTable polarised_albedo(const Stack& stack, const std::vector<double>& mu_in,
                             const SolverOptions& options, SolutionMemory* memory) {
    validate(stack);
    validate(options);
    require_cosines(mu_in, "mu_in");
    require_polarisable(stack, options);
    std::optional<SolutionMemory> own;
    AlbedoTable table;
    find_albedos({with_all_moments(stack), 3, options, {}}, mu_in,
                 memory != nullptr ? *memory : own.emplace(), table);
    return table;
}

LightComparison compare_albedos(const Stack& stack, const std::vector<double>& mu_in,
                                const SolverOptions& options, SolutionMemory& memory) {
    const Stack whole = with_all_moments(stack);
    const RequestedDirections requested = collect(mu_in, {});
    SolutionParts::AtStreams& kept = SolutionParts::of(memory).with_streams(options.streams);
    const auto solved = [&](int components) {
        const AlbedoRequest request{whole, components, options, {}};
        const auto solve = [&](const Discretisation& discretisation, Solution& solution) {
            albedo_with(request, requested, discretisation, kept, solution);
        };
        Solution solution;
        solve_with_nodes(whole, options, options.streams, count_of_values(request, mu_in.size()),
                         solve, solution);
        return std::move(solution.values);
    };
    LightComparison both{solved(1), solved(3)};
    // Removes the changes by polarised light, which stand behind the plane albedos.
    const auto changes = both.with.begin() + std::ptrdiff_t(mu_in.size());
    both.with.erase(changes, changes + std::ptrdiff_t(mu_in.size()));
    return both;
}

}  // namespace miebrdf::rte
