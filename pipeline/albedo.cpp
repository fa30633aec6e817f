// Plane and spherical albedo of a scene: azimuthal order 0 alone, no phase function.
#include "pipeline/brdf.h"
#include "pipeline/layers.h"
#include "pipeline/slice_report.h"
#include "rte/math/quadrature.h"
#include "rte/surface_lobe.h"

namespace miebrdf {
namespace {

// rho and A are smooth in mu but for mu ln mu at grazing: 32 Gauss nodes integrate both to 1e-7.
constexpr int kSphericalNodes = 32;

/// Surface and layers together, as eq. 5 adds them: rho + (1 - rho) A. With the reciprocal coupling
/// A counts the light that the surface lets out again (LayerQuantity::albedo_through_surface).
double with_surface(const rte::SurfaceLobe& lobe, double mu, double layers) {
    const double rho = lobe.directional_reflectance(mu);
    return rho + (1.0 - rho) * layers;
}

/// Turns plane albedos of the layers, at the request's mu_in and then at the rule's nodes, into
/// those of the whole.
void add_surface(AlbedoSlice& slice, const rte::SurfaceLobe& lobe, const std::vector<double>& mu_in,
                 const math::Quadrature& rule) {
    const std::size_t count = mu_in.size();
    slice.spherical_albedo = 0.0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double mu = rule.nodes[i];
        slice.spherical_albedo +=
            2.0 * rule.weights[i] * mu * with_surface(lobe, mu, slice.plane_albedo[count + i]);
    }
    slice.plane_albedo.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        slice.plane_albedo[i] = with_surface(lobe, mu_in[i], slice.plane_albedo[i]);
    }
}

}  // namespace

AlbedoResult compute_albedo(const Request& request, const RunControl& control) {
    validate(request);
    const SceneMedia media(request);
    Request layer_request = request;
    layer_request.directions.mu_out.clear();
    layer_request.directions.azimuth_deg.clear();
    const math::Quadrature rule = math::gauss_legendre(kSphericalNodes, 0.0, 1.0);
    if (request.scene.surface) {
        std::vector<double>& mu_in = layer_request.directions.mu_in;
        mu_in.insert(mu_in.end(), rule.nodes.begin(), rule.nodes.end());
    }
    const auto finish = [&](AlbedoSlice& slice, LayerSlice layer) {
        slice.plane_albedo = std::move(layer.values);
        slice.spherical_albedo = slice.plane_albedo.back();
        slice.plane_albedo.pop_back();
        if (!request.scene.surface) return;
        const auto index = media.surface_index_at(slice.wavelength_nm);
        add_surface(slice, rte::SurfaceLobe(index, *request.scene.surface),
                    request.directions.mu_in, rule);
    };
    return assemble<AlbedoResult>(
        compute_layers(layer_request, media, albedo_quantity(request.scene), control), request,
        media, control, finish);
}

}  // namespace miebrdf
