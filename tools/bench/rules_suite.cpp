// What each rule of `plan` saves: the same values from a request with all the work and from one
// without what the rule leaves out. The error here is their difference, not that of the method.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "pipeline/cache/result_cache.h"
#include "pipeline/scene/request.h"
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/scene_optics.h"
#include "pipeline/solve/shared_work.h"
#include "rte/math/quadrature.h"
#include "tools/bench/suites.h"

namespace miebrdf::bench {
namespace {

constexpr int kStreams = 32;

using Values = std::vector<double>;
using Run = std::function<Values()>;

/// 32 x 32 directions and 36 azimuths of HG paint on an HG base, 32 nodes.
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

/// The same with spheres of 10 um, one direction.
Request spheres_request(const std::string& base) {
    Request request = matrix_request();
    request.scene.base = parse_medium(base);
    request.scene.coats.clear();
    request.scene.particles.sizes.effective_radius_um = 10;
    request.directions = {{0.5}, {0.3}, {60}};
    return request;
}

/// BRDF and plane albedo at the first wavelength, computed as `plan` has it.
Values total(const Request& request) {
    return compute_brdf(request, {.threads = 1}).slices.at(0).total;
}

Values albedo(const Request& request) {
    return compute_albedo(request, {.threads = 1}).slices.at(0).plane_albedo;
}

/// BRDF by the layers' solver itself, whatever the rules say.
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

BenchCase albedo_alone() {
    const auto full = [request = matrix_request()] {
        const Values brdf = total(request);
        const math::Quadrature rule = math::gauss_legendre(32, 0.0, 1.0);
        Values plane;
        std::size_t index = 0;
        for (std::size_t i = 0; i < 32; ++i) {
            double flux = 0;
            for (std::size_t o = 0; o < 32; ++o) {
                double mean = 0;
                for (int a = 0; a < 36; ++a) mean += brdf[index++] / 36;
                flux += 2 * std::numbers::pi * rule.weights[o] * rule.nodes[o] * mean;
            }
            plane.push_back(flux);
        }
        return plane;
    };
    return rule_case("albedo", "Plane albedo at 32 incidences: by integrating the BRDF, and alone.",
                     full, [request = matrix_request()] { return albedo(request); });
}

BenchCase zenith_alone() {
    Request request = matrix_request();
    request.directions.mu_in = {1.0};
    const auto full = [] {
        const Values all = total(matrix_request());
        return Values(all.end() - 32 * 36, all.end());  // the last mu_in is 1
    };
    return rule_case("zenith", "BRDF for light from the zenith, of 32 incidences or alone.", full,
                     [request] { return total(request); });
}

BenchCase one_direction() {
    Request request = matrix_request();
    request.directions.mu_in = {0.5};
    request.directions.mu_out = {request.directions.mu_out[20]};
    request.directions.azimuth_deg = {90};
    const auto full = [] { return Values{total(matrix_request())[(15 * 32 + 20) * 36 + 9]}; };
    return rule_case("listed directions", "BRDF at one of 36,864 combinations, and alone.", full,
                     [request] { return total(request); });
}

BenchCase same_direction() {
    const Request request = matrix_request();
    return rule_case(
        "same direction", "36 azimuths around, of which 19 differ.",
        [request] { return unreduced(request); }, [request] { return total(request); });
}

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

BenchCase same_spheres() {
    Request request = spheres_request("index:1.5,0.01");
    request.scene.coats = {parse_coat("index:1.5,0.01@0.1")};
    Request other = request;
    other.scene.coats = {{IndexMedium{{1.5 + 1e-12, 0.01}}, 0.1}};
    return rule_case(
        "same spheres", "Spheres on the same spheres; or nearly the same.",
        [other] { return total(other); }, [request] { return total(request); });
}

/// Three paints on one base, as results of one run or each on its own.
BenchCase one_half_space() {
    std::vector<Request> paints(3, matrix_request());
    paints[1].scene.coats = {parse_coat("hg:0.8,0.5@2")};
    paints[2].scene.coats = {parse_coat("hg:0.5,0.3@0.2")};
    const auto all = [paints](SharedWork* shared) {
        RunControl control{.threads = 1};
        control.shared = shared;
        Values values;
        for (const Request& paint : paints) {
            if (shared != nullptr) shared->expect(paint, LayerQuantity::reflection);
        }
        for (const Request& paint : paints) {
            const Values one = compute_brdf(paint, control).slices.at(0).total;
            values.insert(values.end(), one.begin(), one.end());
        }
        return values;
    };
    return rule_case(
        "one half-space", "The matrix of three paints on one base, apart and in one run.",
        [all] { return all(nullptr); },
        [all] {
            SharedWork shared;
            return all(&shared);
        });
}

BenchCase same_wavelength() {
    Request request = matrix_request();
    request.wavelength_nm = {450, 550, 650, 750};
    const auto full = [request] {
        for (const double nm : {450, 550, 650}) {
            Request one = request;
            one.wavelength_nm = {nm};
            total(one);
        }
        Request last = request;
        last.wavelength_nm = {750};
        return total(last);
    };
    return rule_case("same wavelength", "Media that do not change, at four wavelengths.", full,
                     [request] { return total(request); });
}

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

/// A cache file that goes with the benchmark.
struct TemporaryCache {
    std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("miebrdf-bench-{}.sqlite", ::getpid());
    ResultCache cache{file};
    ~TemporaryCache() {
        std::error_code ignored;
        for (const char* suffix : {"", "-wal", "-shm"}) {
            std::filesystem::remove(file.string() + suffix, ignored);
        }
    }
};

BenchCase in_the_cache() {
    const Request request = matrix_request();
    const auto cache = std::make_shared<TemporaryCache>();
    return rule_case(
        "in the cache", "The whole matrix, computed and remembered.",
        [request] { return total(request); },
        [request, cache] {
            RunControl control{.threads = 1};
            control.cache = &cache->cache;
            return compute_brdf(request, control).slices.at(0).total;
        });
}

/// Rules about the directions that are asked for.
std::vector<BenchCase> direction_rules() {
    return {albedo_alone(), zenith_alone(), one_direction(), same_direction()};
}

/// Rules about layers and orders that do not matter.
std::vector<BenchCase> layer_rules() {
    return {no_depth(), hidden_layers(), black_ground(), nothing_absorbs(), few_orders()};
}

/// Rules about work that several layers, results or wavelengths share.
std::vector<BenchCase> shared_work_rules() {
    return {same_spheres(), one_half_space(), same_wavelength()};
}

/// Rules about the parts of a BRDF, or of the optics behind it, that are asked for.
std::vector<BenchCase> part_rules() {
    return {parts("surface alone", {.subsurface = false, .surface = true, .total = false}),
            parts("no surface", {.subsurface = true, .surface = false, .total = false}),
            reciprocity(), few_moments()};
}

}  // namespace

std::vector<BenchCase> rules_suite() {
    std::vector<BenchCase> cases = direction_rules();
    for (const auto& more : {layer_rules(), shared_work_rules(), part_rules()}) {
        cases.insert(cases.end(), more.begin(), more.end());
    }
    cases.push_back(in_the_cache());
    return cases;
}

}  // namespace miebrdf::bench
