// Measures what each rule of `plan` saves: the same values from a request with all the work and
// from one without what the rule leaves out. The error here is their difference, not that of the
// method.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <miebrdf/brdf.h>
#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/single_scattering.h"
#include "rte/math/quadrature.h"
#include "rte/stack/layered_reflection.h"
#include "tools/bench/suites.h"

namespace miebrdf::bench {
namespace {

constexpr int kStreams = 32;

using Values = std::vector<double>;
using Run = std::function<Values()>;

/// A scene at 550 nm, and what is wanted of it.
struct Question {
    Scene scene;
    std::vector<double> wavelength_nm = {550};
    Directions directions;
    BrdfParts parts = {};
    SolverOptions solver = {.streams = kStreams};

    Brdf solved(const Control& control = {.threads = 1}) const {
        return solve(scene, wavelength_nm, solver, control);
    }
    BrdfValues::Slice slice(const Control& control = {.threads = 1}) const {
        return solved(control).evaluate(directions, parts).slices.at(0);
    }
};

/// 32 x 32 directions and 36 azimuths of HG paint on an HG base, 32 nodes.
Question matrix_question() {
    Question question;
    question.scene.base = medium("hg:0.95,0.7");
    question.scene.layers = {layer("hg:0.8,0.5@0.5")};
    for (int i = 1; i <= 32; ++i) question.directions.mu_in.push_back(i / 32.0);
    question.directions.mu_out = math::gauss_legendre(32, 0.0, 1.0).nodes;
    for (int a = 0; a < 36; ++a) question.directions.azimuth_deg.push_back(10.0 * a);
    return question;
}

/// A request for spheres of 10 um at one direction.
Question spheres_question(const std::string& base) {
    Question question = matrix_question();
    question.scene.base = medium(base);
    question.scene.layers.clear();
    question.scene.particles.sizes.effective_radius_um = 10;
    question.directions = {{0.5}, {0.3}, {60}};
    return question;
}

/// BRDF and plane albedo at the first wavelength, computed as `plan` has it.
Values total(const Question& question) { return question.slice().total; }

Values albedo(const Question& question) {
    return question.solved().albedo(question.directions.mu_in).plane_albedo.at(0);
}

/// All layers at the first wavelength, whether they show or not.
rte::Stack whole_stack(const Question& question, PhaseDemand phase) {
    const ResolvedScene scene = resolve(question.scene, question.wavelength_nm);
    const OpticsDemand demand = demand_of(question.solver, scene.particles.tolerance, phase);
    rte::Stack stack;
    for (std::size_t m = 0; m < scene.media.size(); ++m) {
        const rte::Optics optics = compute_optics(scene, m, 0, demand).optics;
        if (m == 0) {
            stack.base = optics;
        } else {
            stack.coats.push_back({optics, scene.depths[m - 1].optical_depth});
        }
    }
    return stack;
}

/// BRDF by the layers' solver itself, whatever the rules say.
Values unreduced(const Question& question) {
    const rte::Stack stack = whole_stack(question, PhaseDemand::whole);
    Values values = rte::reflect(stack, question.directions, question.solver).reflection;
    for (double& v : values) v /= std::numbers::pi;
    return values;
}

BenchCase rule_case(const std::string& rule, const std::string& quantity, const Run& full,
                    const Run& reduced) {
    BenchCase c;
    c.suite = "rules";
    c.name = rule;
    c.quantity = quantity;
    c.truth = "none from outside: the difference from the full question is what the rule changes.";
    c.true_values = full();
    c.contenders = {{"full", "-", full}, {"reduced", "-", reduced}};
    return c;
}

BenchCase albedo_alone() {
    const auto full = [question = matrix_question()] {
        const Values brdf = total(question);
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
                     full, [question = matrix_question()] { return albedo(question); });
}

BenchCase zenith_alone() {
    Question question = matrix_question();
    question.directions.mu_in = {1.0};
    const auto full = [] {
        const Values all = total(matrix_question());
        return Values(all.end() - 32 * 36, all.end());  // the last mu_in is 1
    };
    return rule_case("zenith", "BRDF for light from the zenith, of 32 incidences or alone.", full,
                     [question] { return total(question); });
}

BenchCase one_direction() {
    Question question = matrix_question();
    question.directions.mu_in = {0.5};
    question.directions.mu_out = {question.directions.mu_out[20]};
    question.directions.azimuth_deg = {90};
    const auto full = [] { return Values{total(matrix_question())[(15 * 32 + 20) * 36 + 9]}; };
    return rule_case("listed directions", "BRDF at one of 36,864 combinations, and alone.", full,
                     [question] { return total(question); });
}

BenchCase same_direction() {
    const Question question = matrix_question();
    return rule_case(
        "same direction", "36 azimuths around, of which 19 differ.",
        [question] { return unreduced(question); }, [question] { return total(question); });
}

BenchCase no_depth() {
    Question empty = matrix_question(), thin = empty;
    empty.scene.particles.sizes.effective_radius_um = 10;
    empty.scene.layers = {layer("index:1.5,0.01@0")};
    thin = empty;
    thin.scene.layers[0].depth = 1e-14;
    return rule_case(
        "no depth", "A coat of spheres of optical depth 1e-14, and 0.",
        [thin] { return total(thin); }, [empty] { return total(empty); });
}

BenchCase hidden_layers() {
    Question question = spheres_question("index:1.5,0.01");
    question.scene.layers = {layer("hg:0.5,0.5@40")};
    return rule_case(
        "hidden layers", "HG paint of optical depth 40 on spheres.",
        [question] { return unreduced(question); }, [question] { return total(question); });
}

BenchCase black_ground() {
    Question question = matrix_question();
    question.scene.base = medium("isotropic:0");
    question.directions.azimuth_deg = {0, 90};
    return rule_case(
        "nothing scatters", "Paint on a base of albedo 0.",
        [question] { return unreduced(question); }, [question] { return total(question); });
}

BenchCase nothing_absorbs() {
    Question question = spheres_question("index:1.5,0");
    return rule_case(
        "nothing absorbs", "Plane albedo of spheres without absorption.",
        [question] {
            return rte::albedo(whole_stack(question, PhaseDemand::moments_only),
                               question.directions.mu_in, question.solver)
                .plane_albedo;
        },
        [question] { return albedo(question); });
}

BenchCase few_orders() {
    Question question = matrix_question(), peaked = question;
    question.scene.base = medium("isotropic:0.9");
    question.scene.layers.clear();
    peaked = question;
    // A share of 1e-5 of the light in many orders makes the solver look for them.
    peaked.scene.base = medium("hg:0.9,1e-5");
    return rule_case(
        "few orders", "Isotropic scattering, and hg with g = 1e-5.",
        [peaked] { return total(peaked); }, [question] { return total(question); });
}

BenchCase same_spheres() {
    Question question = spheres_question("index:1.5,0.01");
    question.scene.layers = {layer("index:1.5,0.01@0.1")};
    Question other = question;
    other.scene.layers[0].medium.species[0].parameters[0] += 1e-12;
    return rule_case(
        "same spheres", "Spheres on the same spheres; or nearly the same.",
        [other] { return total(other); }, [question] { return total(question); });
}

BenchCase same_wavelength() {
    Question question = matrix_question();
    question.wavelength_nm = {450, 550, 650, 750};
    const auto full = [question] {
        for (const double nm : {450, 550, 650}) {
            Question one = question;
            one.wavelength_nm = {nm};
            total(one);
        }
        Question last = question;
        last.wavelength_nm = {750};
        return total(last);
    };
    return rule_case("same wavelength", "Media that do not change, at four wavelengths.", full,
                     [question] { return total(question); });
}

BenchCase parts(const std::string& rule, BrdfParts wanted) {
    Question all = spheres_question("index:1.5,0.01");
    all.scene.surface = rte::SurfaceOptions{};
    for (int a = 0; a < 36; ++a) all.directions.azimuth_deg.push_back(5.0 * a);
    Question part = all;
    part.parts = wanted;
    const auto values = [wanted](const Question& question) {
        const BrdfValues::Slice slice = question.slice();
        return wanted.surface ? slice.surface : slice.subsurface;
    };
    return rule_case(
        rule, "One part of a BRDF, and all of them.", [=] { return values(all); },
        [=] { return values(part); });
}

BenchCase reciprocity() {
    Question question = spheres_question("index:1.5,0.01");
    question.scene.surface = rte::SurfaceOptions{};
    question.parts = {.subsurface = false, .surface = true, .total = false};
    question.directions = matrix_question().directions;
    // Nearer to the horizon exp(-tan^2 / alpha^2) of some directions is below the smallest double:
    // a lobe of 0 has no relative error.
    question.directions.mu_in = math::gauss_legendre(32, 0.2, 1.0).nodes;
    question.directions.mu_out = question.directions.mu_in;
    Question unlike = question;
    for (double& mu : unlike.directions.mu_out) mu *= 1.0 - 1e-15;
    const auto lobe = [](const Question& wanted) { return wanted.slice().surface; };
    return rule_case(
        "reciprocity", "The lobe at 32 x 32 x 36 directions, and half of them.",
        [=] { return lobe(unlike); }, [=] { return lobe(question); });
}

BenchCase few_moments() {
    const Question question = spheres_question("index:1.5,0.01");
    const auto albedo_from = [question](PhaseDemand phase) {
        return Values{whole_stack(question, phase).base.single_scattering_albedo};
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
    std::shared_ptr<ResultCache> cache = std::make_shared<ResultCache>(file);
    ~TemporaryCache() {
        std::error_code ignored;
        for (const char* suffix : {"", "-wal", "-shm"}) {
            std::filesystem::remove(file.string() + suffix, ignored);
        }
    }
};

BenchCase in_the_cache() {
    const Question question = matrix_question();
    const auto cache = std::make_shared<TemporaryCache>();
    return rule_case(
        "in the cache", "The whole matrix, computed and remembered.",
        [question] { return total(question); },
        [question, cache] {
            Control control{.threads = 1};
            control.cache = cache->cache;
            return question.slice(control).total;
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
std::vector<BenchCase> shared_work_rules() { return {same_spheres(), same_wavelength()}; }

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
