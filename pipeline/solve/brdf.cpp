#include "pipeline/solve/brdf.h"

#include <algorithm>
#include <numbers>

#include "pipeline/plan/rules.h"
#include "pipeline/solve/distinct_directions.h"
#include "pipeline/solve/layers.h"
#include "pipeline/solve/slice_report.h"
#include "pipeline/solve/surface_part.h"

namespace miebrdf {
namespace {

/// The surface at all the requested directions.
SurfacePart surface_at(std::complex<double> index, const Request& request,
                       const RunControl& control) {
    const DistinctDirections distinct(request.directions);
    const auto demand = request.parts.total ? SurfaceDemand::whole : SurfaceDemand::lobe;
    SurfacePart part = surface_part(index, request.scene, distinct.directions(), demand, control);
    part.lobe = distinct.spread(part.lobe);
    if (demand == SurfaceDemand::lobe) return part;
    part.in = distinct.spread_incident(part.in);
    part.out = distinct.spread_outgoing(part.out);
    return part;
}

/// The lobe and what it lets through of the layers: eq. 5.
std::vector<double> total_of(const SurfacePart& surface, const std::vector<double>& subsurface) {
    std::vector<double> total = surface.lobe;
    const std::size_t azimuths = total.size() / (surface.in.size() * surface.out.size());
    std::size_t index = 0;
    for (const double in : surface.in) {
        for (const double out : surface.out) {
            for (std::size_t a = 0; a < azimuths; ++a, ++index) {
                total[index] += in * out * subsurface[index];
            }
        }
    }
    return total;
}

void raise(std::optional<double>& largest, double value) {
    largest = std::max(largest.value_or(0.0), value);
}

/// The largest share of light that comes back: of the layers A, of the whole rho + (1 - rho) A
/// (eq. 5; the reciprocal coupling gives that in the mean over incidences only, so it is left out).
void add_energy(SpectralSlice& slice, const std::vector<double>& plane_albedo,
                const SurfacePart* surface, rte::SurfaceCoupling coupling) {
    for (std::size_t i = 0; i < plane_albedo.size(); ++i) {
        raise(slice.layers_physics.largest_albedo, plane_albedo[i]);
        if (surface != nullptr && !surface->in.empty() && coupling == rte::SurfaceCoupling::paper) {
            raise(slice.physics.largest_albedo,
                  1.0 - surface->in[i] + surface->in[i] * plane_albedo[i]);
        }
    }
    if (surface == nullptr) slice.physics.largest_albedo = slice.layers_physics.largest_albedo;
}

void add_physics(SpectralSlice& slice, const rte::Directions& directions) {
    const auto& whole = !slice.total.empty()     ? slice.total
                        : !slice.surface.empty() ? slice.surface
                                                 : slice.subsurface;
    if (!slice.subsurface.empty()) slice.layers_physics = physics_of(slice.subsurface, directions);
    if (!whole.empty()) slice.physics = physics_of(whole, directions);
}

}  // namespace

BrdfResult compute_brdf(const Request& request, const RunControl& control) {
    validate(request);
    const SceneMedia media(request);
    std::vector<LayerSlice> layers(request.wavelength_nm.size());
    if (wants_layers(request.parts)) {
        layers = compute_layers(request, media, LayerQuantity::reflection, control);
    } else {
        for (LayerSlice& none : layers) none.converged = none.report.converged = true;
    }
    const auto finish = [&](SpectralSlice& slice, LayerSlice layer) {
        slice.subsurface = std::move(layer.values);
        for (double& value : slice.subsurface) value /= std::numbers::pi;
        std::optional<SurfacePart> surface;
        if (wants_lobe(request.scene, request.parts)) {
            surface = surface_at(media.surface_index_at(slice.wavelength_nm), request, control);
            slice.surface = surface->lobe;
            if (request.parts.total) slice.total = total_of(*surface, slice.subsurface);
        } else if (!request.scene.surface) {
            slice.total = slice.subsurface;
        }
        add_physics(slice, request.directions);
        add_energy(slice, layer.plane_albedo, surface ? &*surface : nullptr,
                   request.scene.coupling);
    };
    return assemble<BrdfResult>(std::move(layers), request, media, control, finish);
}

}  // namespace miebrdf
