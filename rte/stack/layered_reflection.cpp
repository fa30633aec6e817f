#include "rte/stack/layered_reflection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <miebrdf/error.h>
#include "rte/boundary/rough_boundaries.h"
#include "rte/first_order/first_order.h"
#include "rte/first_order/first_order_sum.h"
#include "rte/first_order/glory_correction.h"
#include "rte/grid/discretisation.h"
#include "rte/grid/refraction_grid.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/solution_memory.h"

namespace miebrdf::rte {
namespace {

/// Whether a medium has narrow features (glories) that the nodes do not fully resolve.
bool has_glory(const ScaledStack& stack) {
    return !stack.has_mirrors() &&
           std::any_of(stack.media.begin(), stack.media.end(), [](const ScaledMedium& medium) {
               return !medium.unresolved_shares.empty();
           });
}

/// Within this angle of retro-reflection errors are estimated without trust in agreement
/// (JudgedValues::near_backwards).
constexpr double kNearRetroDeg = 5.0;
/// Directions within this angle of retro-reflection count as straight back: wider than glories.
constexpr double kStraightBackDeg = 1.0;
/// (Error of R straight back) / (the part of the glory that nodes do not resolve,
/// unresolved_glory), which two solutions share and cannot show: the rms difference of solutions
/// with 12, 24 and 48 nodes from 256 nodes (tools/bench/retro_reflection.py has such spheres). At
/// the zenith of 92 half-spaces of spheres of 10 to 50 um, bare and coated, whose glory is a tenth
/// of R or more (docs/internals/numerics-log.md); elsewhere of 22 with spheres of 2 to 12 um.
constexpr double kGloryErrorAtZenith = 0.03, kGloryError = 0.016;

double glory_error(const ScaledStack& stack, double mu_air) {
    const double mu = refracted_cosine(stack.top_index, mu_air);
    const bool at_zenith = mu >= std::cos(kNearRetroDeg * std::numbers::pi / 180.0);
    return (at_zenith ? kGloryErrorAtZenith : kGloryError) *
           straight_paths_factor(stack.top_index, mu_air, mu_air) *
           unresolved_glory(stack.media, mu);
}

// The smaller cosine of each pair of directions in the topmost medium, for each of `repeats`
// values.
std::vector<double> smaller_cosines(const Stack& stack, const Directions& directions,
                                    std::size_t repeats) {
    const double index = stack.coats.empty() ? stack.base_index : stack.coats.back().index;
    std::vector<double> cosines;
    cosines.reserve(directions.mu_in.size() * directions.mu_out.size() * repeats);
    for (const double mu_in : directions.mu_in) {
        for (const double mu_out : directions.mu_out)
            cosines.insert(cosines.end(), repeats,
                           refracted_cosine(index, std::min(mu_in, mu_out)));
    }
    return cosines;
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

// Each error, but at least those of the azimuths beside it and the median of its incidence, because
// two solutions may agree by chance at single values.
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

// Sets the worst direction, and turns worst_value from [pair][element][azimuth] to the order of
// ReflectionTable::reflection.
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

// Errors straight back become at least glory_error(). No more nodes are tried, because no number in
// reach lowers it.
void add_glory_errors(const Directions& directions, const ScaledStack& stack, double tolerance,
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
        std::optional<double> least;
        for (std::size_t k = first; k < first + block; ++k) {
            if (!back[k] || !(brightest > 0.0)) continue;
            if (!least) least = glory_error(stack, directions.mu_in[first / block]) / brightest;
            if (!table.errors.empty()) table.errors[k] = std::max(table.errors[k], *least);
            if (!(*least > report.error_estimate)) continue;
            report.error_estimate = *least;
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

/// The table of a request that has no pair of directions: albedos at each incidence, no R.
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
    FourierOrders orders;  // of the finest solution so far
    int finest = 0;        // its number of nodes
    FirstOrderSum first_order(directions, options, light.components, light.shown());
    const Request request{stack, directions, requested, light, options};
    Solutions solutions;
    const JudgedValues values{
        .count = directions.mu_in.size() * block,
        .block = block,
        .near_backwards =
            elements == 1 ? near_retro_reflection(directions, kNearRetroDeg) : std::vector<bool>(),
        .cosines = smaller_cosines(stack, directions, directions.azimuth_deg.size() * elements)};
    Solution& solution = solve_with_estimate(
        stack, options, values,
        [&](const Discretisation& discretisation, Solution& one) {
            // A solution with fewer nodes takes over no orders of one with more.
            FourierOrders none;
            const bool is_finer = discretisation.streams >= finest;
            if (is_finer) finest = discretisation.streams;
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
        add_glory_errors(directions, scaled, options.tolerance, table);
    }
    find_mirror_reflectances(stack, directions.mu_in, light, kept.exact, table.mirror_reflectance);
    return table;
}

/// Adds the Fourier orders of MirroredLobe between all cosines.
void add_mirrored_orders(const Eigen::VectorXd& mu, TabulatedOrders& table) {
    std::vector<Eigen::MatrixXd> lobe = mirrored_lobe_orders(mu, table.stack);
    table.orders.resize(std::max(table.orders.size(), lobe.size()));
    for (std::size_t m = 0; m < lobe.size(); ++m) {
        Eigen::MatrixXd& sum = table.orders[m];
        sum.size() == 0 ? sum = std::move(lobe[m]) : sum += lobe[m];
    }
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
    by_streams.back()->scaled.kept_layers = kept_layers;
    return *by_streams.back();
}

SolutionMemory::SolutionMemory() : parts_(std::make_unique<SolutionParts>()) {}
SolutionMemory::~SolutionMemory() = default;
SolutionMemory::SolutionMemory(SolutionMemory&&) noexcept = default;
SolutionMemory& SolutionMemory::operator=(SolutionMemory&&) noexcept = default;

SolutionMemory memory_with(std::shared_ptr<RoughBoundaries> boundaries,
                           std::shared_ptr<KeptLayers> layers) {
    SolutionMemory memory;
    SolutionParts::of(memory).rough_boundaries = std::move(boundaries);
    SolutionParts::of(memory).kept_layers = std::move(layers);
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

TabulatedOrders tabulate_orders(const Stack& requested_stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options, SolutionMemory& known) {
    const Stack stack = light.components > 1 ? with_all_moments(requested_stack) : requested_stack;
    TabulatedOrders table;
    table.stack.rough_boundaries = SolutionParts::of(known).rough_boundaries;
    table.stack.kept_layers = SolutionParts::of(known).kept_layers;
    scale_stack(stack, solved.moments, options.delta_m, table.stack);
    const StackGrids grids(table.stack, choose_discretisation(stack, options, solved.streams).grid,
                           solved.streams);
    if (options.single_scattering_correction) split_by_resolution(table.stack, grids);
    RequestedDirections requested;
    requested.mu = Eigen::Map<const Eigen::VectorXd>(mu.data(), Eigen::Index(mu.size()));
    for (int k = 0; k < int(mu.size()); ++k) {
        requested.in.push_back(k);
        requested.out.push_back(k);
    }
    StackMemory memory;
    MultipleScattering multiple = sum_fourier_orders(table.stack, grids, requested, {}, light,
                                                     kFourierTailShare * options.tolerance, options,
                                                     memory, {}, KeptOrders::for_table);
    table.orders = std::move(multiple.by_fourier_order);
    table.converged = multiple.converged;
    table.physical = multiple.physical;
    const bool is_rough = table.stack.boundary && table.stack.boundary->is_rough();
    if (is_rough && table.stack.has_mirrors() && table.physical)
        add_mirrored_orders(requested.mu, table);
    return table;
}

LightComparison compare_light(const Stack& stack, const Directions& directions,
                              const SolverOptions& options, SolutionMemory& memory) {
    const Stack whole = with_all_moments(stack);
    const RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    SolutionParts::AtStreams& kept = SolutionParts::of(memory).with_streams(options.streams);
    LightComparison both;
    Solution solution;
    const auto solve = [&](const Discretisation& discretisation, Solution& one) {
        const ScaledStack& scaled = scale(whole, directions, discretisation, options, kept);
        const StackGrids& grids = kept.grids_for(discretisation);
        const auto sum = [&](const SolvedLight& light) {
            return sum_fourier_orders(scaled, grids, requested, directions.azimuth_deg, light,
                                      kFourierTailShare * options.tolerance, options, kept.memory);
        };
        MultipleScattering without = sum({}), with = sum({3, true});
        one.physical = without.physical && with.physical;
        if (!one.physical) return;
        // Light scattered once has the same R11 with and without polarisation unless it met a
        // boundary or mirror before.
        const bool is_alike = !scaled.refracts() && !scaled.has_mirrors();
        std::vector<double> first(without.reflection.size(), 0.0);
        FirstOrderSum(directions, options).add_to(first, scaled);
        both.with = std::move(with.reflection);
        if (!is_alike) FirstOrderSum(directions, options, 3, 1).add_to(both.with, scaled);
        one.values = std::move(without.reflection);
        for (std::size_t k = 0; k < first.size(); ++k) {
            one.values[k] += first[k];
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
