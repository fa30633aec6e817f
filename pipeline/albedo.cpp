// Plane and spherical albedo of a scene: azimuthal order 0 alone, no phase function.
#include <algorithm>

#include "pipeline/brdf.h"
#include "pipeline/error.h"
#include "pipeline/parallel.h"
#include "pipeline/scene_optics.h"
#include "pipeline/slice_report.h"
#include "rte/layered_brdf.h"
#include "rte/math/quadrature.h"

namespace miebrdf {
namespace {

// rho and A are smooth in mu but for mu ln mu at grazing: 32 Gauss nodes integrate both to 1e-7.
constexpr int kSphericalNodes = 32;

/// Surface and layers together, as eq. 5 adds them: rho + (1 - rho) A.
double with_surface(const rte::SurfaceLobe& lobe, double mu, double layers) {
    const double rho = lobe.directional_reflectance(mu);
    return rho + (1.0 - rho) * layers;
}

void add_surface(AlbedoSlice& slice, const SceneOptics& optics, const Request& request) {
    const rte::SurfaceLobe lobe(*optics.surface_index, *request.scene.surface);
    const std::vector<double>& mu_in = request.directions.mu_in;
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        slice.plane_albedo[i] = with_surface(lobe, mu_in[i], slice.plane_albedo[i]);
    }
    const math::Quadrature rule = math::gauss_legendre(kSphericalNodes, 0.0, 1.0);
    const rte::AlbedoTable layers = rte::albedo(optics.stack, rule.nodes, request.solver);
    slice.spherical_albedo = 0.0;
    for (int i = 0; i < kSphericalNodes; ++i) {
        slice.spherical_albedo += 2.0 * rule.weights[i] * rule.nodes[i] *
                                  with_surface(lobe, rule.nodes[i], layers.plane_albedo[i]);
    }
}

AlbedoSlice albedo_slice(const Request& request, const SceneOptics& optics, double wavelength_nm) {
    AlbedoSlice slice;
    slice.wavelength_nm = wavelength_nm;
    rte::AlbedoTable table = rte::albedo(optics.stack, request.directions.mu_in, request.solver);
    set_report(slice, optics, table.report);
    slice.plane_albedo = std::move(table.plane_albedo);
    slice.spherical_albedo = table.spherical_albedo;
    if (optics.surface_index) add_surface(slice, optics, request);
    return slice;
}

}  // namespace

AlbedoResult compute_albedo(const Request& request, const RunControl& control) {
    validate(request);
    if (request.scene.surface && request.scene.coupling != rte::SurfaceCoupling::paper) {
        throw UsageError("albedo with a surface is known for the paper's coupling only; leave out "
                         "--coupling, or --roughness");
    }
    const SceneMedia media(request);
    const auto optics = media.optics(demand_of(request, PhaseDemand::none), control);
    AlbedoResult result;
    result.sources = media.sources();
    result.slices.resize(optics.size());
    run_parallel("radiative transfer", optics.size(), control, [&](std::size_t w) {
        result.slices[w] = albedo_slice(request, optics[w], request.wavelength_nm[w]);
    });
    summarise(result);
    return result;
}

}  // namespace miebrdf
