#include "rte/stokes/stokes_reflection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <miebrdf/error.h>
#include "rte/grid/discretisation.h"
#include "rte/math/tolerance_budget.h"
#include "rte/phase/polarisation.h"
#include "rte/stack/hidden_layers.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stokes/polarised_beams.h"
#include "rte/stokes/stokes_solver.h"

namespace miebrdf::rte {
namespace {

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
    int components;
    const SolverOptions& options;
};

void reflect_with(const Request& request, const Discretisation& discretisation,
                  StokesMemory& memory, FourierOrders& orders, StokesFirstOrderOfStack& first_order,
                  Attempt& attempt) {
    const SolverOptions& options = request.options;
    ScaledStack scaled =
        scale_stack(request.stack, discretisation.moments, options.delta_m, NarrowPart::ignored);
    const StackGrids grids(scaled, discretisation.grid, discretisation.streams);
    if (options.single_scattering_correction) split_by_resolution(scaled, grids);
    if (scaled.media.size() > 1 || scaled.base != BaseKind::half_space)
        scaled.brightness = least_brightness(scaled, request.directions);
    StokesScattering multiple = sum_stokes_orders(
        scaled, grids, request.requested, request.directions.azimuth_deg, request.components,
        kFourierTailShare * options.tolerance, options, memory, orders);
    orders = std::move(multiple.by_fourier_order);
    attempt.physical = multiple.physical;
    attempt.values = std::move(multiple.reflection);
    attempt.plane_albedo = std::move(multiple.plane_albedo);
    attempt.plane_albedo.insert(attempt.plane_albedo.end(), multiple.polarised_plane_albedo.begin(),
                                multiple.polarised_plane_albedo.end());
    attempt.report.fourier_orders = multiple.fourier_orders;
    attempt.report.iterations = multiple.iterations;
    attempt.report.converged = multiple.converged && multiple.physical;
    attempt.report.error_estimate = std::max(multiple.tail, multiple.residual);
    if (attempt.physical) first_order.add_to(attempt.values, scaled);
}

// [pair][element][azimuth] to [pair][azimuth][element], and the index of the worst value.
std::vector<double> elements_last(const std::vector<double>& values, std::size_t elements,
                                  std::size_t azimuths) {
    std::vector<double> result(values.size());
    const std::size_t block = elements * azimuths;
    for (std::size_t first = 0; first < values.size(); first += block) {
        for (std::size_t e = 0; e < elements; ++e)
            for (std::size_t a = 0; a < azimuths; ++a)
                result[first + a * elements + e] = values[first + e * azimuths + a];
    }
    return result;
}

void name_worst(const Directions& directions, std::size_t elements, SolverReport& report) {
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

std::vector<double> half_of(const std::vector<double>& both, std::size_t count, bool second) {
    if (both.size() != 2 * count)
        return std::vector<double>(count, std::numeric_limits<double>::quiet_NaN());
    const auto first = both.begin() + std::ptrdiff_t(second ? count : 0);
    return {first, first + std::ptrdiff_t(count)};
}

// Nothing scattered is taken for a beam here: with the optical depths as they are.
std::vector<double> mirror_reflections(const Stack& stack, const std::vector<double>& mu_in,
                                       int components) {
    const ScaledStack exact = scale_stack(stack, 1, false);
    std::vector<double> reflections;
    if (exact.top_index == 1.0 && !exact.has_mirrors()) return reflections;
    for (const double mu : mu_in) {
        const Eigen::Matrix4d M = mueller_of(polarised_mirror_reflection(exact, mu));
        for (int row = 0; row < components; ++row)
            for (int column = 0; column < components; ++column)
                reflections.push_back(M(row, column));
    }
    return reflections;
}

void albedo_with(const Stack& stack, const RequestedDirections& requested,
                 const SolverOptions& options, const Discretisation& discretisation,
                 StokesMemory& memory, Attempt& one) {
    ScaledStack scaled =
        scale_stack(stack, discretisation.moments, options.delta_m, NarrowPart::ignored);
    scaled.transmits = scaled.base != BaseKind::half_space;
    const StackGrids grids(scaled, discretisation.grid, discretisation.streams);
    StokesSolver solver(scaled, grids, requested, 3, options, memory);
    const StokesOrder& order = solver.solve_albedos();
    one.physical = order.physical;
    if (!one.physical) return;
    one.values = order.plane_albedo;
    one.values.insert(one.values.end(), order.polarised_plane_albedo.begin(),
                      order.polarised_plane_albedo.end());
    one.values.push_back(order.spherical_albedo);
    for (const double arriving : order.transmittance)
        one.values.push_back((1.0 - scaled.ground_albedo) * arriving);
    one.report.fourier_orders = 1;
    one.report.iterations = order.iterations;
    one.report.converged = order.converged;
    one.report.error_estimate = order.residual;
}

}  // namespace

Stack with_all_moments(Stack stack) {
    if (stack.base_kind == BaseKind::half_space) pad_moments(stack.base);
    for (Coat& coat : stack.coats) pad_moments(coat.optics);
    return stack;
}

MuellerTable reflect_polarised(const Stack& asked_stack, const Directions& directions,
                               int components, const SolverOptions& options,
                               const LadderWatch& watch) {
    if (components != 3 && components != 4)
        throw UsageError("components", components, "3 (I, Q, U) or 4 (with V)");
    validate(asked_stack);
    validate(options);
    validate(directions);
    require_polarisable(asked_stack, options);
    const Stack stack = with_all_moments(asked_stack);
    const AzimuthProbes probes(stack, directions, options);
    const Directions& judged = probes.directions();
    const RequestedDirections requested = collect_with_probes(judged);
    const auto elements = std::size_t(components * components);
    const std::size_t block = judged.mu_out.size() * judged.azimuth_deg.size() * elements;
    StokesMemory memory;
    FourierOrders orders;  // of the solution before, with fewer nodes
    StokesFirstOrderOfStack first_order(judged, components, options);
    const Request request{stack, judged, requested, components, options};
    Attempts attempts;
    Attempt& attempt = solve_with_estimate(
        stack, options, judged.mu_in.size() * block, block,
        [&](const Discretisation& discretisation, Attempt& one) {
            reflect_with(request, discretisation, memory, orders, first_order, one);
        },
        attempts, watch);
    attempt.report.worst_value = probes.asked_for(attempt.report.worst_value);
    name_worst(directions, elements, attempt.report);
    MuellerTable table;
    table.components = components;
    table.reflection = elements_last(probes.without(std::move(attempt.values)), elements,
                                     directions.azimuth_deg.size());
    table.plane_albedo = half_of(attempt.plane_albedo, directions.mu_in.size(), false);
    table.polarised_plane_albedo = half_of(attempt.plane_albedo, directions.mu_in.size(), true);
    table.mirror_reflection = mirror_reflections(stack, directions.mu_in, components);
    table.report = std::move(attempt.report);
    return table;
}

PolarisedAlbedoTable polarised_albedo(const Stack& asked_stack, const std::vector<double>& mu_in,
                                      const SolverOptions& options) {
    validate(asked_stack);
    validate(options);
    validate(Directions{mu_in, {}, {}});
    require_polarisable(asked_stack, options);
    const Stack stack = with_all_moments(asked_stack);
    const RequestedDirections requested = collect(mu_in, {});
    StokesMemory memory;
    const std::size_t count = mu_in.size();
    const bool transmits = scale_stack(stack, 1, false).base != BaseKind::half_space;
    const std::size_t wanted = 2 * count + 1 + (transmits ? count + 1 : 0);
    Attempts attempts;
    Attempt& attempt = solve_with_estimate(
        stack, options, wanted, wanted,
        [&](const Discretisation& discretisation, Attempt& one) {
            albedo_with(stack, requested, options, discretisation, memory, one);
        },
        attempts);
    const auto begin = attempt.values.begin();
    const auto part = [&](std::size_t from, std::size_t to) {
        return std::vector<double>(begin + std::ptrdiff_t(from), begin + std::ptrdiff_t(to));
    };
    PolarisedAlbedoTable table;
    table.plane_albedo = part(0, count);
    table.polarised_plane_albedo = part(count, 2 * count);
    table.spherical_albedo = attempt.values[2 * count];
    table.transmittance = part(2 * count + 1, wanted);
    table.mirror_reflection = mirror_reflections(stack, mu_in, 3);
    table.report = std::move(attempt.report);
    return table;
}

double strongest_polarisation(const Optics& optics) {
    if (!optics.polarisation || optics.single_scattering_albedo == 0.0) return 0.0;
    // Four samples for each wave of the highest degree, at most one for each 1/20 degree.
    const std::size_t degrees = std::max(optics.chi.size(), optics.polarisation->b1.size());
    const std::size_t steps = std::clamp<std::size_t>(4 * degrees, 180, 3600);
    double strongest = 0.0;
    for (std::size_t k = 0; k <= steps; ++k) {
        const double angle = std::acos(-1.0) * double(k) / double(steps);
        const ScatteringMatrix F = exact_matrix(optics, std::cos(angle));
        if (F.a1 > 0.0) strongest = std::max(strongest, std::abs(F.b1) / F.a1);
    }
    return std::min(strongest, 1.0);
}

}  // namespace miebrdf::rte
