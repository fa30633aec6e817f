#include "pipeline/brdf.h"

#include <numbers>

#include "pipeline/layers.h"
#include "pipeline/parallel.h"
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
                slice.total.push_back(surface +
                                      factor_in * factor_out[o] * slice.subsurface[index++]);
            }
        }
    }
}

}  // namespace

BrdfResult compute_brdf(const Request& request, const RunControl& control) {
    validate(request);
    const SceneMedia media(request);
    std::vector<LayerSlice> layers =
        compute_layers(request, media, LayerQuantity::reflection, control);
    BrdfResult result;
    result.sources = media.sources();
    result.slices.resize(layers.size());
    run_parallel("surface", layers.size(), control, [&](std::size_t w) {
        SpectralSlice& slice = result.slices[w];
        set_report(slice, layers[w], request.wavelength_nm[w]);
        slice.subsurface = std::move(layers[w].values);
        for (double& value : slice.subsurface) value /= std::numbers::pi;
        if (request.scene.surface) {
            const auto index = media.surface_index_at(slice.wavelength_nm);
            add_surface(slice, rte::SurfaceLobe(index, *request.scene.surface), request);
        } else {
            slice.total = slice.subsurface;
        }
    });
    summarise(result);
    return result;
}

}  // namespace miebrdf
