#include "rte/stack/layered_reflection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <miebrdf/error.h>
#include "rte/first_order/first_order_sum.h"
#include "rte/first_order/glory_correction.h"
#include "rte/grid/discretisation.h"
#include "rte/grid/refraction_grid.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/solution_memory.h"

namespace miebrdf::rte {
namespace {

/// Whether a medium has narrow features (glories) that the nodes resolve in part or not at all.
bool has_glory(const ScaledStack& stack) {
    return !stack.has_mirrors() &&
           std::any_of(stack.media.begin(), stack.media.end(), [](const ScaledMedium& medium) {
               return !medium.unresolved_shares.empty();
           });
}

/// Within this angle of retro-reflection all of the difference of solutions counts.
constexpr double kNearRetroDeg = 5.0;
/// Directions within this angle of retro-reflection count as straight back: wider than glories.
constexpr double kStraightBackDeg = 1.0;
/// The error of the part of a glory that nodes do not resolve (unresolved_glory), as a share of
/// this part, straight back, however well two solutions agree. The rms difference from solutions
/// with 256 nodes, of solutions with 12, 24 and 48 (tools/bench/retro_reflection.py has such
/// spheres): at the zenith of 92 half-spaces of spheres of 10 to 50 um, bare and coated, whose
/// glory is a tenth of R or more (docs/internals/numerics-log.md); elsewhere of 22 of 2 to 12 um.
constexpr double kGloryDoubtAtZenith = 0.03, kGloryDoubt = 0.016;

double doubt_of_glory(const ScaledStack& stack, double mu_air) {
    const double mu = refracted_cosine(stack.top_index, mu_air);
    const bool at_zenith = mu >= std::cos(kNearRetroDeg * std::numbers::pi / 180.0);
    return (at_zenith ? kGloryDoubtAtZenith : kGloryDoubt) *
           straight_paths_factor(stack.top_index, mu_air, mu_air) *
           unresolved_glory(stack.media, mu);
}

struct Request {
    const Stack& stack;
    const Directions& directions;
    const RequestedDirections& requested;
    const SolvedLight& light;
    const SolverOptions& options;
};

ScaledStack& scale(const Stack& stack, const Directions& directions,
                   const Discretisation& discretisation, const SolverOptions& options,
                   SolutionParts::AtStreams& memory) {
    ScaledStack& scaled = memory.scaled;
    scale_stack(stack, discretisation.moments, options.delta_m, scaled);
    if (scaled.media.size() > 1 || scaled.base != BaseKind::half_space)
        scaled.brightness = least_brightness(scaled, directions);
    return scaled;
}

void reflect_with(const Request& request, const Discretisation& discretisation,
                  SolutionParts::AtStreams& memory, FourierOrders& orders,
                  FirstOrderSum& first_order, Solution& solution) {
    const SolverOptions& options = request.options;
    ScaledStack& scaled = scale(request.stack, request.directions, discretisation, options, memory);
    const StackGrids& grids = memory.grids_for(discretisation);
    if (options.single_scattering_correction) split_by_resolution(scaled, grids);
    MultipleScattering multiple = sum_fourier_orders(
        scaled, grids, request.requested, request.directions.azimuth_deg, request.light,
        kFourierTailShare * options.tolerance, options, memory.memory, orders);
    orders = std::move(multiple.by_fourier_order);
    solution.physical = multiple.physical;
    solution.values = std::move(multiple.reflection);
    solution.plane_albedo = std::move(multiple.plane_albedo);
    solution.polarised_plane_albedo = std::move(multiple.polarised_plane_albedo);
    solution.report.fourier_orders = multiple.fourier_orders;
    solution.report.iterations = multiple.iterations;
    solution.report.converged = multiple.converged && multiple.physical;
    solution.report.error_estimate = std::max(multiple.tail, multiple.residual);
    if (!solution.physical) return;
    first_order.add_to(solution.values, scaled);
    solution.has_glory = has_glory(scaled);
}

// Each error, but no less than those of the azimuths beside it and than the median at its
// incidence: two solutions may agree by accident at single values.
std::vector<double> largest_nearby(const std::vector<double>& errors,
                                   const Directions& directions) {
    const std::size_t azimuths = directions.azimuth_deg.size();
    const std::size_t block = directions.mu_out.size() * azimuths;
    std::vector<double> all, sorted;
    all.reserve(errors.size());
    for (std::size_t k = 0; k < errors.size(); ++k) {
        if (k % block == 0) {
            const auto first = errors.begin() + std::ptrdiff_t(k);
            sorted.assign(first, first + std::ptrdiff_t(block));
            std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(block / 2),
                             sorted.end());
        }
        const std::size_t a = k % azimuths;
        const auto here = errors.begin() + std::ptrdiff_t(k);
        all.push_back(std::max(*std::max_element(here - (a > 0), here + 1 + (a + 1 < azimuths)),
                               sorted[block / 2]));
    }
    return all;
}

// From [pair][element][azimuth] to the order of ReflectionTable::reflection, and the direction
// there.
void name_worst_direction(const Directions& directions, std::size_t elements,
                          SolverReport& report) {
    const std::size_t azimuths = directions.azimuth_deg.size();
    const std::size_t outgoing = directions.mu_out.size();
    if (azimuths == 0 || outgoing == 0 || directions.mu_in.empty()) return;
    const std::size_t azimuth = report.worst_value % azimuths;
    const std::size_t element = report.worst_value / azimuths % elements;
    const std::size_t pair = report.worst_value / azimuths / elements;
    report.worst_azimuth_deg = directions.azimuth_deg[azimuth];
    report.worst_mu_out = directions.mu_out[pair % outgoing];
    report.worst_mu_in = directions.mu_in[pair / outgoing];
    report.worst_value = (pair * azimuths + azimuth) * elements + element;
}

// States the error of glories straight back (doubt_of_glory). No further nodes are tried: those in
// reach do not lower it.
void add_doubt_of_glories(const Directions& directions, const ScaledStack& stack, double tolerance,
                          ReflectionTable& table) {
    if (!has_glory(stack)) return;
    const std::vector<bool> back = near_retro_reflection(directions, kStraightBackDeg);
    const auto elements = std::size_t(table.components * table.components);
    const std::size_t azimuths = directions.azimuth_deg.size();
    const std::size_t block = directions.mu_out.size() * azimuths;
    SolverReport& report = table.report;
    for (std::size_t first = 0; first < back.size(); first += block) {
        double brightest = 0.0;
        for (std::size_t k = first; k < first + block; ++k)
            brightest = std::max(brightest, table.reflection[k * elements]);
        std::optional<double> doubt;
        for (std::size_t k = first; k < first + block; ++k) {
            if (!back[k] || !(brightest > 0.0)) continue;
            if (!doubt) doubt = doubt_of_glory(stack, directions.mu_in[first / block]) / brightest;
            if (!table.errors.empty()) table.errors[k] = std::max(table.errors[k], *doubt);
            if (!(*doubt > report.error_estimate)) continue;
            report.error_estimate = *doubt;
            report.worst_value = k / azimuths * azimuths * elements + k % azimuths;
            name_worst_direction(directions, elements, report);
        }
    }
    report.converged = has_converged(report.error_estimate, tolerance, report.converged);
    if (report.converged || table.errors.empty()) return;
    const auto within = std::count_if(table.errors.begin(), table.errors.end(),
                                      [&](double error) { return error <= tolerance; });
    report.share_within_tolerance = double(within) / double(table.errors.size());
}

/// The table of a request without any pair of directions: albedos at each incidence, no R.
ReflectionTable without_pairs(const Stack& stack, const std::vector<double>& mu_in,
                              const SolvedLight& light, const SolverOptions& options,
                              SolutionMemory& memory) {
    AlbedoTable albedos = light.components > 1 ? polarised_albedo(stack, mu_in, options, &memory)
                                               : albedo(stack, mu_in, options, {}, &memory);
    ReflectionTable table;
    table.components = light.shown();
    table.plane_albedo = std::move(albedos.plane_albedo);
    table.polarised_plane_albedo = std::move(albedos.polarised_plane_albedo);
    table.steps_converged = albedos.report.converged;
    table.report = std::move(albedos.report);
    find_mirror_reflectances(stack, mu_in, light, SolutionParts::of(memory).exact,
                             table.mirror_reflectance);
    return table;
}

ReflectionTable reflect_light(const Stack& stack, const Directions& directions,
                              const SolvedLight& light, const SolverOptions& options,
                              SolutionMemory* memory, const RefinementCallback& refined) {
    std::optional<SolutionMemory> own;
    if (memory == nullptr) memory = &own.emplace();
    if (directions.mu_in.empty() || directions.mu_out.empty() || directions.azimuth_deg.empty())
        return without_pairs(stack, directions.mu_in, light, options, *memory);
    const RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    const auto elements = std::size_t(light.shown() * light.shown());
    const std::size_t block = directions.mu_out.size() * directions.azimuth_deg.size() * elements;
    SolutionParts& kept = SolutionParts::of(*memory);
    FourierOrders orders;  // of the coarser solution before
    int nodes_before = 0;
    FirstOrderSum first_order(directions, options, light.components, light.shown());
    const Request request{stack, directions, requested, light, options};
    Solutions solutions;
    const JudgedValues values{
        .count = directions.mu_in.size() * block,
        .block = block,
        .near_backwards =
            elements == 1 ? near_retro_reflection(directions, kNearRetroDeg) : std::vector<bool>()};
    Solution& solution = solve_with_estimate(
        stack, options, values,
        [&](const Discretisation& discretisation, Solution& one) {
            // A solution with fewer nodes takes over no orders of one with more.
            FourierOrders none;
            const bool is_finer = discretisation.streams >= nodes_before;
            if (is_finer) nodes_before = discretisation.streams;
            reflect_with(request, discretisation, kept.with_streams(discretisation.streams),
                         is_finer ? orders : none, first_order, one);
        },
        solutions, refined);
    name_worst_direction(directions, elements, solution.report);
    if (!solution.physical) {
        constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
        solution.plane_albedo.assign(directions.mu_in.size(), unknown);
        if (light.components > 1)
            solution.polarised_plane_albedo.assign(directions.mu_in.size(), unknown);
    }
    ReflectionTable table;
    table.components = light.shown();
    table.reflection =
        elements_last(std::move(solution.values), elements, directions.azimuth_deg.size());
    table.plane_albedo = std::move(solution.plane_albedo);
    table.polarised_plane_albedo = std::move(solution.polarised_plane_albedo);
    if (elements == 1) table.errors = largest_nearby(solution.errors, directions);
    table.steps_converged = solution.steps_converged;
    table.report = std::move(solution.report);
    if (solution.physical) {
        const ScaledStack& scaled = kept.with_streams(table.report.streams).scaled;
        add_doubt_of_glories(directions, scaled, options.tolerance, table);
    }
    find_mirror_reflectances(stack, directions.mu_in, light, kept.exact, table.mirror_reflectance);
    return table;
}

}  // namespace

SolutionParts::AtStreams& SolutionParts::with_streams(int streams) {
    constexpr int most = 64;
    streams = std::min(streams, most + 1);
    const auto found = std::find_if(by_streams.begin(), by_streams.end(),
                                    [=](const auto& s) { return s->streams == streams; });
    if (found != by_streams.end()) return **found;
    by_streams.push_back(std::make_unique<AtStreams>());
    by_streams.back()->streams = streams;
    by_streams.back()->scaled.rough_boundaries = rough_boundaries;
    return *by_streams.back();
}

SolutionMemory::SolutionMemory() : parts_(std::make_unique<SolutionParts>()) {}
SolutionMemory::~SolutionMemory() = default;
SolutionMemory::SolutionMemory(SolutionMemory&&) noexcept = default;
SolutionMemory& SolutionMemory::operator=(SolutionMemory&&) noexcept = default;

SolutionMemory memory_with(std::shared_ptr<RoughBoundaries> boundaries) {
    SolutionMemory memory;
    SolutionParts::of(memory).rough_boundaries = std::move(boundaries);
    return memory;
}

ReflectionTable reflect(const Stack& stack, const Directions& directions,
                        const SolverOptions& options, SolutionMemory* memory,
                        const RefinementCallback& refined) {
    validate(stack);
    validate(options);
    validate(directions);
    return reflect_light(stack, directions, {}, options, memory, refined);
}

ReflectionTable reflect_polarised(const Stack& stack, const Directions& directions,
                                  const SolvedLight& light, const SolverOptions& options,
                                  SolutionMemory* memory, const RefinementCallback& refined) {
    if (light.components != 3 && light.components != 4)
        throw UsageError("components", light.components, "3 (I, Q, U) or 4 (with V)");
    validate(stack);
    validate(options);
    validate(directions);
    require_polarisable(stack, options);
    return reflect_light(with_all_moments(stack), directions, light, options, memory, refined);
}

LightComparison compare_light(const Stack& stack, const Directions& directions,
                              const SolverOptions& options, SolutionMemory& memory) {
    const Stack whole = with_all_moments(stack);
    const RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    SolutionParts::AtStreams& kept = SolutionParts::of(memory).with_streams(options.streams);
    LightComparison both;
    Solution solution;
    const auto solve = [&](const Discretisation& discretisation, Solution& numbers) {
        const ScaledStack& scaled = scale(whole, directions, discretisation, options, kept);
        const StackGrids& grids = kept.grids_for(discretisation);
        const auto sum = [&](const SolvedLight& light) {
            return sum_fourier_orders(scaled, grids, requested, directions.azimuth_deg, light,
                                      kFourierTailShare * options.tolerance, options, kept.memory);
        };
        MultipleScattering without = sum({}), with = sum({3, true});
        numbers.physical = without.physical && with.physical;
        if (!numbers.physical) return;
        // Light scattered once has the same R11 with and without polarisation unless it met a
        // boundary or mirror before.
        const bool is_alike = !scaled.refracts() && !scaled.has_mirrors();
        std::vector<double> first(without.reflection.size(), 0.0);
        FirstOrderSum(directions, options).add_to(first, scaled);
        both.with = std::move(with.reflection);
        if (!is_alike) FirstOrderSum(directions, options, 3, 1).add_to(both.with, scaled);
        numbers.values = std::move(without.reflection);
        for (std::size_t k = 0; k < first.size(); ++k) {
            numbers.values[k] += first[k];
            if (is_alike) both.with[k] += first[k];
        }
    };
    solve_with_nodes(
        whole, options, options.streams,
        directions.mu_in.size() * directions.mu_out.size() * directions.azimuth_deg.size(), solve,
        solution);
    both.without = std::move(solution.values);
    if (!solution.physical) both.with = both.without;
    return both;
}

}  // namespace miebrdf::rte
