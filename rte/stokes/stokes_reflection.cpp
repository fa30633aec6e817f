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
#include "rte/stokes/stokes_first_order.h"
#include "rte/stokes/stokes_sum.h"

namespace miebrdf::rte {
namespace {

void require_polarisable(const Stack& stack, const SolverOptions& options) {
    if (options.half_space_method != HalfSpaceMethod::automatic ||
        options.coat_method != CoatMethod::automatic) {
        throw UsageError("polarised light is solved by the automatic methods alone");
    }
    if (stack.boundary) {
        throw UsageError(
            "polarised light: refracting boundaries are not available (their Fresnel matrices are "
            "not part of the equations yet); leave the boundary out, or solve without "
            "polarisation");
    }
    if (stack.base_kind == BaseKind::mirror) {
        throw UsageError(
            "polarised light: mirrors are not available (their Fresnel matrices are not part of "
            "the equations yet); take a Lambertian or black ground, or solve without polarisation");
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

Attempt reflect_with(const Request& request, const Discretisation& discretisation,
                     StokesMemory& memory, FourierOrders& orders, StokesFirstOrder& first_order) {
    const SolverOptions& options = request.options;
    ScaledStack scaled = scale_stack(request.stack, discretisation.moments, options.delta_m);
    if (scaled.media.size() > 1 || scaled.base != BaseKind::half_space)
        scaled.brightness = least_brightness(scaled.media, request.directions);
    StokesScattering multiple =
        sum_stokes_orders(scaled, make_zenith_grid(discretisation.grid, discretisation.streams),
                          request.requested, request.directions.azimuth_deg, request.components,
                          kFourierTailShare * options.tolerance, options, memory, orders);
    orders = std::move(multiple.by_fourier_order);
    Attempt attempt;
    attempt.physical = multiple.physical;
    attempt.values = std::move(multiple.reflection);
    attempt.plane_albedo = std::move(multiple.plane_albedo);
    attempt.plane_albedo.insert(attempt.plane_albedo.end(), multiple.polarised_plane_albedo.begin(),
                                multiple.polarised_plane_albedo.end());
    attempt.report.fourier_orders = multiple.fourier_orders;
    attempt.report.iterations = multiple.iterations;
    attempt.report.converged = multiple.converged && multiple.physical;
    attempt.report.error_estimate = std::max(multiple.tail, multiple.residual);
    if (attempt.physical) first_order.add_to(attempt.values, scaled.media);
    return attempt;
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

}  // namespace

Stack with_all_moments(Stack stack) {
    if (stack.base_kind == BaseKind::half_space) pad_moments(stack.base);
    for (Coat& coat : stack.coats) pad_moments(coat.optics);
    return stack;
}

MuellerTable reflect_polarised(const Stack& asked_stack, const Directions& directions,
                               int components, const SolverOptions& options) {
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
    StokesFirstOrder first_order(judged, components, options);
    const Request request{stack, judged, requested, components, options};
    Attempt attempt = solve_with_estimate(stack, options, judged.mu_in.size() * block, block,
                                          [&](const Discretisation& discretisation) {
                                              return reflect_with(request, discretisation, memory,
                                                                  orders, first_order);
                                          });
    attempt.report.worst_value = probes.asked_for(attempt.report.worst_value);
    name_worst(directions, elements, attempt.report);
    MuellerTable table;
    table.components = components;
    table.reflection = elements_last(probes.without(std::move(attempt.values)), elements,
                                     directions.azimuth_deg.size());
    table.plane_albedo = half_of(attempt.plane_albedo, directions.mu_in.size(), false);
    table.polarised_plane_albedo = half_of(attempt.plane_albedo, directions.mu_in.size(), true);
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
    Attempt attempt = solve_with_estimate(
        stack, options, 2 * count + 1, 2 * count + 1, [&](const Discretisation& discretisation) {
            const ScaledStack scaled =
                scale_stack(stack, discretisation.moments, options.delta_m, NarrowPart::ignored);
            const ZenithGrid grid = make_zenith_grid(discretisation.grid, discretisation.streams);
            StokesSolver solver(scaled, grid, requested, 3, options, memory);
            const StokesOrder& order = solver.solve_albedos();
            Attempt one;
            one.physical = order.physical;
            if (!one.physical) return one;
            one.values = order.plane_albedo;
            one.values.insert(one.values.end(), order.polarised_plane_albedo.begin(),
                              order.polarised_plane_albedo.end());
            one.values.push_back(order.spherical_albedo);
            one.report.fourier_orders = 1;
            one.report.iterations = order.iterations;
            one.report.converged = order.converged;
            one.report.error_estimate = order.residual;
            return one;
        });
    PolarisedAlbedoTable table;
    table.spherical_albedo = attempt.values.back();
    attempt.values.pop_back();
    table.plane_albedo = half_of(attempt.values, count, false);
    table.polarised_plane_albedo = half_of(attempt.values, count, true);
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
