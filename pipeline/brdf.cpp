#include "pipeline/brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/parallel.h"
#include "pipeline/phase_lookup.h"
#include "pipeline/scene_optics.h"
#include "rte/math/quadrature.h"
#include "rte/surface_lobe.h"

namespace miebrdf {
namespace {

/// The size average may err by this share of the request's tolerance, so that it does not show.
constexpr double kMieShare = 0.1;

double mie_tolerance(const Request& request) {
    const double wanted = request.scene.particles.tolerance;
    return wanted > 0.0 ? wanted : kMieShare * request.solver.tolerance;
}

OpticsDemand demand_of(const Request& request, bool needs_phase) {
    OpticsDemand demand;
    demand.tolerance = mie_tolerance(request);
    demand.highest_moment = highest_moment(request.solver);
    if (needs_phase && request.solver.single_scattering_correction) {
        const rte::Directions& d = request.directions;
        demand.angles_deg = scattering_angles_deg(d.mu_in, d.mu_out, d.azimuth_deg);
    }
    return demand;
}

/// What both kinds of slices say about how they came about.
template <typename Slice>
void set_report(Slice& slice, const SceneOptics& optics, const rte::SolverReport& report) {
    slice.report = report;
    slice.mie_error_estimate = optics.mie_error_estimate;
    slice.error_estimate = report.error_estimate + optics.mie_error_estimate;
    slice.converged = report.converged && optics.converged;
}

template <typename Result>
void summarise(Result& result) {
    result.converged = true;
    for (const auto& slice : result.slices) {
        result.converged = result.converged && slice.converged;
        result.error_estimate = std::max(result.error_estimate, slice.error_estimate);
    }
}

/// Adds the surface lobe, and what it lets through of the layers, to a slice.
void add_surface(SpectralSlice& slice, const rte::SurfaceLobe& lobe, const Request& request) {
    const rte::Directions& d = request.directions;
    const rte::SurfaceTransmission transmission(lobe, request.scene.coupling);
    slice.surface.reserve(slice.subsurface.size());
    slice.total.reserve(slice.subsurface.size());
    std::vector<double> factor_out;
    for (const double mu_out : d.mu_out) factor_out.push_back(transmission.out(mu_out));
    std::size_t index = 0;
    for (const double mu_in : d.mu_in) {
        const double factor_in = transmission.in(mu_in);
        for (std::size_t o = 0; o < d.mu_out.size(); ++o) {
            for (const double azimuth_deg : d.azimuth_deg) {
                const double surface = lobe.brdf(mu_in, d.mu_out[o], azimuth_deg);
                slice.surface.push_back(surface);
                slice.total.push_back(surface + factor_in * factor_out[o] * slice.subsurface[index++]);
            }
        }
    }
}

SpectralSlice brdf_slice(const Request& request, const SceneOptics& optics, double wavelength_nm) {
    SpectralSlice slice;
    slice.wavelength_nm = wavelength_nm;
    rte::ReflectionTable table = rte::reflect(optics.stack, request.directions, request.solver);
    set_report(slice, optics, table.report);
    slice.subsurface = std::move(table.reflection);
    for (double& value : slice.subsurface) value /= std::numbers::pi;
    if (optics.surface_index) {
        add_surface(slice, rte::SurfaceLobe(*optics.surface_index, *request.scene.surface), request);
    } else {
        slice.total = slice.subsurface;
    }
    return slice;
}

}  // namespace

BrdfResult compute_brdf(const Request& request, const RunControl& control) {
    validate(request);
    const SceneMedia media(request);
    const auto optics = media.optics(demand_of(request, true), control);
    BrdfResult result;
    result.sources = media.sources();
    result.slices.resize(optics.size());
    run_parallel("radiative transfer", optics.size(), control, [&](std::size_t w) {
        result.slices[w] = brdf_slice(request, optics[w], request.wavelength_nm[w]);
    });
    summarise(result);
    return result;
}

}  // namespace miebrdf
