// Plane and spherical albedo of a scene: azimuthal order 0 alone, no phase function.
#include <miebrdf/surface.h>
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/layers.h"
#include "pipeline/solve/slice_report.h"
#include "rte/math/quadrature.h"

namespace miebrdf {
namespace {

// rho is smooth in mu but for grazing light on a nearly smooth surface: 32 Gauss nodes integrate it
// to 1e-7 at alpha 0.3.
constexpr int kNodes = 32;

/// Surface and layers together, as eq. 5 adds them: rho + (1 - rho) A. A is of the light that gets
/// in and counts what gets out again (LayerQuantity::albedo_through_surface). In this form layers
/// that absorb nothing give 1 to the last bit.
double with_surface(double rho, double layers) { return layers + rho * (1.0 - layers); }

/// Turns albedos of the layers into those of the whole.
void add_surface(AlbedoSlice& slice, const rte::SurfaceLobe& lobe,
                 const std::vector<double>& mu_in) {
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        slice.plane_albedo[i] =
            with_surface(lobe.directional_reflectance(mu_in[i]), slice.plane_albedo[i]);
    }
    const math::Quadrature rule = math::gauss_legendre(kNodes, 0.0, 1.0);
    double mean_rho = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double mu = rule.nodes[i];
        mean_rho += 2.0 * rule.weights[i] * mu * lobe.directional_reflectance(mu);
    }
    slice.spherical_albedo = with_surface(mean_rho, slice.spherical_albedo);
}

}  // namespace

AlbedoResult compute_albedo(const Request& request, const RunControl& control) {
    validate(request);
    const SceneMedia media(request);
    Request layer_request = request;
    layer_request.directions.mu_out.clear();
    layer_request.directions.azimuth_deg.clear();
    const auto finish = [&](AlbedoSlice& slice, LayerSlice layer) {
        slice.plane_albedo = std::move(layer.values);
        slice.spherical_albedo = slice.plane_albedo.back();
        slice.plane_albedo.pop_back();
        if (!request.scene.surface) return;
        const auto index = media.surface_index_at(slice.wavelength_nm);
        add_surface(slice, rte::SurfaceLobe(index, *request.scene.surface),
                    request.directions.mu_in);
    };
    return assemble<AlbedoResult>(
        compute_layers(layer_request, media, albedo_quantity(request.scene), control), request,
        media, control, finish);
}

}  // namespace miebrdf
