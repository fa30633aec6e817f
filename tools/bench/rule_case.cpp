#include "tools/bench/rule_case.h"

#include <numbers>

#include "pipeline/solve/brdf.h"
#include "pipeline/solve/scene_optics.h"
#include "rte/math/quadrature.h"

namespace miebrdf::bench {
namespace {

constexpr int kStreams = 32;

}  // namespace

Request matrix_request() {
    Request request;
    request.scene.base = parse_medium("hg:0.95,0.7");
    request.scene.coats = {parse_coat("hg:0.8,0.5@0.5")};
    request.wavelength_nm = {550};
    for (int i = 1; i <= 32; ++i) request.directions.mu_in.push_back(i / 32.0);
    request.directions.mu_out = math::gauss_legendre(32, 0.0, 1.0).nodes;
    for (int a = 0; a < 36; ++a) request.directions.azimuth_deg.push_back(10.0 * a);
    request.solver.streams = kStreams;
    return request;
}

Request spheres_request(const std::string& base) {
    Request request = matrix_request();
    request.scene.base = parse_medium(base);
    request.scene.coats.clear();
    request.scene.particles.sizes.effective_radius_um = 10;
    request.directions = {{0.5}, {0.3}, {60}};
    return request;
}

Values total(const Request& request) {
    return compute_brdf(request, {.threads = 1}).slices.at(0).total;
}

Values albedo(const Request& request) {
    return compute_albedo(request, {.threads = 1}).slices.at(0).plane_albedo;
}

Values unreduced(const Request& request) {
    const SceneMedia media(request);
    const auto optics = media.optics({550}, demand_of(request, PhaseDemand::whole), {.threads = 1});
    rte::Stack stack = optics[0].stack;
    Values values = rte::reflect(stack, request.directions, request.solver).reflection;
    for (double& v : values) v /= std::numbers::pi;
    return values;
}

BenchCase rule_case(const std::string& rule, const std::string& quantity, const Run& full,
                    const Run& reduced) {
    BenchCase c;
    c.suite = "rules";
    c.name = rule;
    c.quantity = quantity;
    c.truth = "none from outside: the difference from the full request is what the rule changes.";
    c.true_values = full();
    c.contenders = {{"full", "-", full}, {"reduced", "-", reduced}};
    return c;
}

}  // namespace miebrdf::bench
