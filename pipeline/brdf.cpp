#include "pipeline/brdf.h"

#include <numbers>

#include "pipeline/parallel.h"
#include "pipeline/scene_optics.h"
#include "pipeline/slice_report.h"
#include "rte/layered_brdf.h"

namespace miebrdf {
namespace {

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
    const auto optics = media.optics(demand_of(request, PhaseDemand::at_directions), control);
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
