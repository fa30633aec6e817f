// Rules of `plan` about the parts of a BRDF, or of the optics behind it, that are asked for.
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/scene_optics.h"
#include "rte/math/quadrature.h"
#include "tools/bench/rule_case.h"

namespace miebrdf::bench {
namespace {

BenchCase parts(const std::string& rule, BrdfParts wanted) {
    Request all = spheres_request("index:1.5,0.01");
    all.scene.surface = rte::SurfaceOptions{};
    for (int a = 0; a < 36; ++a) all.directions.azimuth_deg.push_back(5.0 * a);
    Request part = all;
    part.parts = wanted;
    const auto values = [wanted](const Request& request) {
        const auto slice = compute_brdf(request, {.threads = 1}).slices.at(0);
        return wanted.surface ? slice.surface : slice.subsurface;
    };
    return rule_case(
        rule, "One part of a BRDF, and all of them.", [=] { return values(all); },
        [=] { return values(part); });
}

BenchCase reciprocity() {
    Request request = spheres_request("index:1.5,0.01");
    request.scene.surface = rte::SurfaceOptions{};
    request.parts = {.subsurface = false, .surface = true, .total = false};
    request.directions = matrix_request().directions;
    // Nearer to the horizon exp(-tan^2 / alpha^2) of some directions is below the smallest double:
    // a lobe of 0 has no relative error.
    request.directions.mu_in = math::gauss_legendre(32, 0.2, 1.0).nodes;
    request.directions.mu_out = request.directions.mu_in;
    Request unlike = request;
    for (double& mu : unlike.directions.mu_out) mu *= 1.0 - 1e-15;
    const auto lobe = [](const Request& wanted) {
        return compute_brdf(wanted, {.threads = 1}).slices.at(0).surface;
    };
    return rule_case(
        "reciprocity", "The lobe at 32 x 32 x 36 directions, and half of them.",
        [=] { return lobe(unlike); }, [=] { return lobe(request); });
}

BenchCase few_moments() {
    const Request request = spheres_request("index:1.5,0.01");
    const auto albedo_from = [request](PhaseDemand phase) {
        const SceneMedia media(request);
        const auto optics = media.optics({550}, demand_of(request, phase), {.threads = 1});
        return Values{optics[0].stack.base.single_scattering_albedo};
    };
    return rule_case(
        "few moments", "Mie theory of 10 um spheres with the phase function, without.",
        [=] { return albedo_from(PhaseDemand::whole); },
        [=] { return albedo_from(PhaseDemand::moments_only); });
}

}  // namespace

std::vector<BenchCase> part_rules() {
    return {parts("surface alone", {.subsurface = false, .surface = true, .total = false}),
            parts("no surface", {.subsurface = true, .surface = false, .total = false}),
            reciprocity(), few_moments()};
}

}  // namespace miebrdf::bench
