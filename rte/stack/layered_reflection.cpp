#include "rte/stack/layered_reflection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <miebrdf/error.h>
#include "rte/first_order/first_order.h"
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {

struct SolutionMemory::Parts {
    /// The matrices and grids of one number of nodes.
    struct AtStreams {
        int streams = 0;
        ScaledStack scaled = {};
        std::optional<StackGrids> grids = {};
        StackMemory memory = {};
        Eigen::VectorXd let_in = {}, let_out = {};

        /// The nodes of `scaled`.
        const StackGrids& grids_for(const Discretisation& discretisation) {
            if (!grids || !grids->fit(scaled, discretisation.grid, discretisation.streams))
                grids.emplace(scaled, discretisation.grid, discretisation.streams);
            return *grids;
        }
    };

    std::vector<std::unique_ptr<AtStreams>> by_streams = {};
    RequestedDirections requested = {};
    std::vector<double> mu_in = {};  ///< of `requested`
    ScaledStack exact = {};
    Solutions solutions_of_albedo = {};

    /// Beyond 64 nodes one takes the place of the other: 256 of them are 30 MB.
    AtStreams& with_streams(int streams) {
        constexpr int most = 64;
        streams = std::min(streams, most + 1);
        const auto found = std::find_if(by_streams.begin(), by_streams.end(),
                                        [=](const auto& s) { return s->streams == streams; });
        if (found != by_streams.end()) return **found;
        by_streams.push_back(std::make_unique<AtStreams>());
        by_streams.back()->streams = streams;
        return *by_streams.back();
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
                     std::size_t(medium.narrow.first_degree) + medium.narrow.structure.size());
        for (auto l = std::size_t(medium.narrow.first_degree); l < degrees; ++l) {
            const double share = medium.unresolved_shares[l * kResolvedAngles];
            const double structure =
                medium.narrow.structure[l - std::size_t(medium.narrow.first_degree)];
            const double size = (2.0 * double(l) + 1.0) * std::abs(structure);
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

void require_polarisable(const Stack& stack, const SolverOptions& options) {
    if (options.half_space_method != HalfSpaceMethod::automatic ||
        options.coat_method != CoatMethod::automatic) {
        throw UsageError("polarised light is solved by the automatic methods alone");
    }
    if (stack.boundary && stack.boundary->is_rough()) {
        throw UsageError(
            "polarised light: rough boundaries are not available (their facets turn the plane of "
            "polarisation); take a smooth one (roughness 0), or solve without polarisation");
    }
}

// Lists that were cut short are left as they are.
void pad_moments(Optics& optics) {
    if (!optics.polarisation || optics.has_more_moments) return;
    const Polarisation& p = *optics.polarisation;
    optics.chi.resize(std::max({optics.chi.size(), p.a2.size(), p.a3.size(), p.a4.size(),
                                p.b1.size(), p.b2.size()}),
                      0.0);
}

struct Request {
    const Stack& stack;
    const Directions& directions;
    const RequestedDirections& requested;
    const SolvedLight& light;
    const SolverOptions& options;
};

void reflect_with(const Request& request, const Discretisation& discretisation,
                  SolutionMemory::Parts::AtStreams& memory, FourierOrders& orders,
                  FirstOrderSum& first_order, Solution& solution) {
    const SolverOptions& options = request.options;
    ScaledStack& scaled = memory.scaled;
    scale_stack(request.stack, discretisation.moments, options.delta_m, NarrowPart::ignored,
                scaled);
    if (scaled.media.size() > 1 || scaled.base != BaseKind::half_space)
        scaled.brightness = least_brightness(scaled, request.directions);
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
    // However well two solutions agree: no order but the first is solved better.
    if (multiple.fourier_orders > 1) {
        solution.report.error_estimate =
            std::max(solution.report.error_estimate, kEquationShare * options.tolerance);
    }
    if (!solution.physical) return;
    first_order.add_to(solution.values, scaled,
                       request.light.components == 1 ? &solution.unresolved : nullptr);
    if (!solution.unresolved.empty())
        add_at_zenith(request.directions, more_unresolved_at_zenith(scaled), solution.unresolved);
}

/// Light that passes the layers is gone, or is the ground's; what a surface above does to it is not
/// known here.
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

void albedo_with(const AlbedoRequest& request, const RequestedDirections& requested,
                 const Discretisation& discretisation, SolutionMemory::Parts::AtStreams& memory,
                 Solution& solution) {
    const SolverOptions& options = request.options;
    ScaledStack& scaled = memory.scaled;
    scale_stack(request.stack, discretisation.moments, options.delta_m, NarrowPart::ignored,
                scaled);
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

// `worst_value` counts as ReflectionTable::reflection does.
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

ReflectionTable reflect_light(const Stack& stack, const Directions& directions,
                              const SolvedLight& light, const SolverOptions& options,
                              SolutionMemory* memory, const RefinementCallback& refined) {
    const AzimuthProbes probes(stack, directions, options);
    const Directions& judged = probes.directions();
    const RequestedDirections requested = collect_with_probes(judged);
    const auto elements = std::size_t(light.shown() * light.shown());
    const std::size_t block = judged.mu_out.size() * judged.azimuth_deg.size() * elements;
    std::optional<SolutionMemory> own;
    SolutionMemory::Parts& kept = (memory != nullptr ? *memory : own.emplace()).parts();
    FourierOrders orders;  // of the solution before, with fewer nodes
    int nodes_before = 0;
    FirstOrderSum first_order(judged, options, light.components, light.shown());
    const Request request{stack, judged, requested, light, options};
    Solutions solutions;
    const JudgedValues values{
        .count = judged.mu_in.size() * block,
        .block = block,
        .near_backwards = elements == 1 ? near_retro_reflection(judged) : std::vector<bool>()};
    Solution& solution = solve_with_estimate(
        stack, options, values,
        [&](const Discretisation& discretisation, Solution& one) {
            // One with fewer nodes owes nothing to those with more.
            FourierOrders none;
            const bool is_finer = discretisation.streams >= nodes_before;
            if (is_finer) nodes_before = discretisation.streams;
            reflect_with(request, discretisation, kept.with_streams(discretisation.streams),
                         is_finer ? orders : none, first_order, one);
        },
        solutions, refined);
    solution.report.worst_value = probes.asked_for(solution.report.worst_value);
    name_worst_direction(directions, elements, solution.report);
    if (!solution.physical) {
        constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
        solution.plane_albedo.assign(directions.mu_in.size(), unknown);
        if (light.components > 1)
            solution.polarised_plane_albedo.assign(directions.mu_in.size(), unknown);
    }
    ReflectionTable table;
    table.components = light.shown();
    table.reflection = elements_last(probes.without(std::move(solution.values)), elements,
                                     directions.azimuth_deg.size());
    table.plane_albedo = std::move(solution.plane_albedo);
    table.polarised_plane_albedo = std::move(solution.polarised_plane_albedo);
    if (elements == 1) table.errors = probes.largest_nearby(solution.errors);
    table.steps_converged = solution.steps_converged;
    table.report = std::move(solution.report);
    find_mirror_reflectances(stack, directions.mu_in, light, kept.exact, table.mirror_reflectance);
    return table;
}

void find_albedos(const AlbedoRequest& request, const std::vector<double>& mu_in,
                  SolutionMemory& memory, AlbedoTable& table) {
    SolutionMemory::Parts& kept = memory.parts();
    if (kept.mu_in != mu_in) {
        kept.requested = collect(mu_in, {});
        kept.mu_in = mu_in;
    }
    const bool transmits =
        has_transmittance(lowest_kind(request.stack), request.options, bool(request.surface));
    const std::size_t count = mu_in.size(), polarised = request.components > 1 ? count : 0;
    const std::size_t values_wanted = count + polarised + 1 + (transmits ? count + 1 : 0);
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
    table.report = solution.report;
}

}  // namespace

void find_mirror_reflectances(const Stack& stack, const std::vector<double>& mu_in,
                              const SolvedLight& light, ScaledStack& exact,
                              std::vector<double>& reflectances) {
    reflectances.clear();
    if (!stack.boundary && lowest_kind(stack) != BaseKind::mirror) return;
    scale_stack(stack, 1, false, NarrowPart::ignored, exact);
    if (exact.top_index == 1.0 && !exact.has_mirrors()) return;
    if (exact.boundary && exact.boundary->is_rough()) return;
    for (const double mu : mu_in) {
        if (light.components == 1) {
            reflectances.push_back(mirror_reflection<double>(exact, mu));
            continue;
        }
        const Eigen::Matrix4d M = mueller_of(mirror_reflection<FresnelMatrix>(exact, mu));
        for (int element = 0, c = light.shown(); element < c * c; ++element)
            reflectances.push_back(M(element / c, element % c));
    }
}

std::vector<double> elements_last(std::vector<double> values, std::size_t elements,
                                  std::size_t azimuths) {
    if (elements == 1) return values;
    std::vector<double> result(values.size());
    const std::size_t block = elements * azimuths;
    for (std::size_t first = 0; first < values.size(); first += block) {
        for (std::size_t e = 0; e < elements; ++e)
            for (std::size_t a = 0; a < azimuths; ++a)
                result[first + a * elements + e] = values[first + e * azimuths + a];
    }
    return result;
}

SolutionMemory::SolutionMemory() : parts_(std::make_unique<Parts>()) {}
SolutionMemory::~SolutionMemory() = default;
SolutionMemory::SolutionMemory(SolutionMemory&&) noexcept = default;
SolutionMemory& SolutionMemory::operator=(SolutionMemory&&) noexcept = default;

void validate(const Directions& directions) {
    require_cosines(directions.mu_in, "mu_in");
    require_cosines(directions.mu_out, "mu_out");
    for (const double azimuth : directions.azimuth_deg) {
        if (!(azimuth >= -360.0 && azimuth <= 360.0))
            throw UsageError("azimuth_deg", azimuth, "[-360, 360]");
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
    const int stokes = options.stokes;
    if (!(stokes == 0 || stokes == 1 || stokes == 3 || stokes == 4))
        throw UsageError("stokes", stokes, "1, 3 or 4, or 0: as many as matter");
}

Stack with_all_moments(Stack stack) {
    if (stack.base_kind == BaseKind::half_space) pad_moments(stack.base);
    for (Coat& coat : stack.coats) pad_moments(coat.optics);
    return stack;
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

namespace {

/// MirroredLobe at all pairs of cosines, order by order.
void add_mirrored_orders(const std::vector<double>& mu, TabulatedOrders& table) {
    const int count = mirrored_lobe_orders(table.stack);
    Directions samples{mu, mu, {}};  // one more than orders, from 0 to 180 degrees
    for (int a = 0; a <= count; ++a) samples.azimuth_deg.push_back(180.0 * a / count);
    std::vector<double> lobe(mu.size() * mu.size() * samples.azimuth_deg.size(), 0.0);
    add_mirrored_lobe(lobe, samples, table.stack);
    const auto size = Eigen::Index(mu.size());
    const Eigen::Map<const Eigen::MatrixXd> by_pair(lobe.data(), count + 1, size * size);
    for (int m = 0; m < count; ++m) {
        Eigen::VectorXd weights(count + 1);
        for (int a = 0; a <= count; ++a) {
            const double end = a == 0 || a == count ? 0.5 : 1.0;
            weights[a] = end / count * std::cos(std::numbers::pi * double(m * a) / count);
        }
        const Eigen::VectorXd order = by_pair.transpose() * weights;
        if (m == int(table.orders.size())) table.orders.emplace_back();
        Eigen::MatrixXd& sum = table.orders[std::size_t(m)];
        if (sum.size() == 0) sum.setZero(size, size);
        sum += Eigen::Map<const Eigen::MatrixXd>(order.data(), size, size);
    }
}

}  // namespace

TabulatedOrders tabulate_orders(const Stack& asked_stack, const std::vector<double>& mu,
                                const SolvedLight& light, const SolverReport& solved,
                                const SolverOptions& options) {
    const Stack stack = light.components > 1 ? with_all_moments(asked_stack) : asked_stack;
    TabulatedOrders table;
    table.stack = scale_stack(stack, solved.moments, options.delta_m, NarrowPart::ignored);
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
                                                     memory, {}, KeptOrders::asked_for);
    table.orders = std::move(multiple.by_fourier_order);
    table.converged = multiple.converged;
    table.physical = multiple.physical;
    const bool is_rough = table.stack.boundary && table.stack.boundary->is_rough();
    if (is_rough && table.stack.has_mirrors() && table.physical) add_mirrored_orders(mu, table);
    return table;
}

}  // namespace miebrdf::rte
