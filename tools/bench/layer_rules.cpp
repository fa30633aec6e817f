// Rules of `plan` about layers and orders that do not matter.
#include "pipeline/solve/scene_optics.h"
#include "tools/bench/rule_case.h"

namespace miebrdf::bench {
namespace {

BenchCase no_depth() {
    Request empty = matrix_request(), thin = empty;
    empty.scene.particles.sizes.effective_radius_um = 10;
    empty.scene.coats = {parse_coat("index:1.5,0.01@0")};
    thin = empty;
    thin.scene.coats[0].optical_depth = 1e-14;
    return rule_case(
        "no depth", "A coat of spheres of optical depth 1e-14, and 0.",
        [thin] { return total(thin); }, [empty] { return total(empty); });
}

BenchCase hidden_layers() {
    Request request = spheres_request("index:1.5,0.01");
    request.scene.coats = {parse_coat("hg:0.5,0.5@40")};
    return rule_case(
        "hidden layers", "HG paint of optical depth 40 on spheres.",
        [request] { return unreduced(request); }, [request] { return total(request); });
}

BenchCase black_ground() {
    Request request = matrix_request();
    request.scene.base = parse_medium("isotropic:0");
    request.directions.azimuth_deg = {0, 90};
    return rule_case(
        "nothing scatters", "Paint on a base of albedo 0.",
        [request] { return unreduced(request); }, [request] { return total(request); });
}

BenchCase nothing_absorbs() {
    Request request = spheres_request("index:1.5,0");
    return rule_case(
        "nothing absorbs", "Plane albedo of spheres without absorption.",
        [request] {
            const SceneMedia media(request);
            const auto demand = demand_of(request, PhaseDemand::moments_only);
            const auto optics = media.optics({550}, demand, {.threads = 1});
            return rte::albedo(optics[0].stack, request.directions.mu_in, request.solver)
                .plane_albedo;
        },
        [request] { return albedo(request); });
}

BenchCase few_orders() {
    Request request = matrix_request(), peaked = request;
    request.scene.base = parse_medium("isotropic:0.9");
    request.scene.coats.clear();
    peaked = request;
    // A share of 1e-5 of the light in many orders makes the solver look for them.
    peaked.scene.base = HenyeyGreensteinMedium{0.9, 1e-5};
    return rule_case(
        "few orders", "Isotropic scattering, and hg with g = 1e-5.",
        [peaked] { return total(peaked); }, [request] { return total(request); });
}

}  // namespace

std::vector<BenchCase> layer_rules() {
    return {no_depth(), hidden_layers(), black_ground(), nothing_absorbs(), few_orders()};
}

}  // namespace miebrdf::bench
