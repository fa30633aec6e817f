// Measures what each rule of `plan` saves: the same values from a request with all the work and
// from one without what the rule leaves out. The error here is their difference, not that of the
// method.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
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

using Values = std::vector<double>;

/// A scene at 550 nm, and what is wanted of it.
struct Question {
    Scene scene;
    std::vector<double> wavelength_nm = {550};
    Directions directions;
    BrdfParts parts = {};
    SolverOptions solver = {.streams = 32};

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
    Question question;
    question.scene.base = medium(base);
    question.scene.particles.sizes.effective_radius_um = 10;
    question.directions = {{0.5}, {0.3}, {60}};
    return question;
}

/// BRDF, lobe and plane albedo at the first wavelength, computed as `plan` has it.
Values total(const Question& question) { return question.slice().total; }
Values lobe(const Question& question) { return question.slice().surface; }
Values below(const Question& question) { return question.slice().subsurface; }
Values albedo(const Question& question) {
    return question.solved().albedo(question.directions.mu_in).plane_albedo.at(0);
}

/// All layers at the first wavelength, whether they show or not.
rte::Stack whole_stack(const Question& question, PhaseDemand phase) {
    const ResolvedScene scene = resolve(question.scene, question.wavelength_nm);
    const OpticsDemand demand = demand_of(question.solver, scene.particles.tolerance, phase);
    rte::Stack stack;
    stack.base = compute_optics(scene, 0, 0, demand).optics;
    for (std::size_t m = 1; m < scene.media.size(); ++m) {
        stack.coats.push_back(
            {compute_optics(scene, m, 0, demand).optics, scene.depths[m - 1].optical_depth});
    }
    return stack;
}

/// BRDF and plane albedo by the layers' solver itself, whatever the rules say.
Values unreduced(const Question& question) {
    const rte::Stack stack = whole_stack(question, PhaseDemand::whole);
    Values values = rte::reflect(stack, question.directions, question.solver).reflection;
    for (double& v : values) v /= std::numbers::pi;
    return values;
}
Values unreduced_albedo(const Question& question) {
    return rte::albedo(whole_stack(question, PhaseDemand::moments_only), question.directions.mu_in,
                       question.solver)
        .plane_albedo;
}

/// @param full, reduced  how the two questions are answered
template <typename Full, typename Reduced>
BenchCase rule_case(const std::string& rule, const std::string& quantity, const Question& whole,
                    const Full& full, const Question& part, const Reduced& reduced) {
    BenchCase c{
        "rules", rule, quantity,
        "none from outside: the difference from the full question is what the rule changes.",
        full(whole)};
    c.add("full", "-", [=] { return Values(full(whole)); });
    c.add("reduced", "-", [=] { return Values(reduced(part)); });
    return c;
}

/// Rules about the directions that are asked for.
void add_direction_rules(std::vector<BenchCase>& cases) {
    const Question matrix = matrix_question();
    const auto integrated = [](const Question& question) {
        const Values brdf = total(question);
        const math::Quadrature rule = math::gauss_legendre(32, 0.0, 1.0);
        Values plane(32, 0.0);
        for (std::size_t index = 0; index < brdf.size(); ++index) {
            const std::size_t o = index / 36 % 32;
            plane[index / (32 * 36)] +=
                2 * std::numbers::pi * rule.weights[o] * rule.nodes[o] * brdf[index] / 36;
        }
        return plane;
    };
    cases.push_back(rule_case("albedo",
                              "Plane albedo at 32 incidences: by integrating the BRDF, and alone.",
                              matrix, integrated, matrix, albedo));
    Question zenith = matrix, one = matrix;
    zenith.directions.mu_in = {1.0};
    const auto last = [](const Question& question) {
        const Values all = total(question);
        return Values(all.end() - 32 * 36, all.end());  // the last mu_in is 1
    };
    cases.push_back(rule_case("zenith",
                              "BRDF for light from the zenith, of 32 incidences or alone.", matrix,
                              last, zenith, total));
    one.directions = {{0.5}, {matrix.directions.mu_out[20]}, {90}};
    const auto picked = [](const Question& question) {
        return Values{total(question)[(15 * 32 + 20) * 36 + 9]};
    };
    cases.push_back(rule_case("listed directions", "BRDF at one of 36,864 combinations, and alone.",
                              matrix, picked, one, total));
    cases.push_back(rule_case("same direction", "36 azimuths around, of which 19 differ.", matrix,
                              unreduced, matrix, total));
}

/// Rules about layers and orders that do not matter.
void add_layer_rules(std::vector<BenchCase>& cases) {
    Question empty = matrix_question();
    empty.scene.particles.sizes.effective_radius_um = 10;
    empty.scene.layers = {layer("index:1.5,0.01@0")};
    Question thin = empty;
    thin.scene.layers[0].depth = 1e-14;
    cases.push_back(rule_case("no depth", "A coat of spheres of optical depth 1e-14, and 0.", thin,
                              total, empty, total));
    Question hidden = spheres_question("index:1.5,0.01");
    hidden.scene.layers = {layer("hg:0.5,0.5@40")};
    cases.push_back(rule_case("hidden layers", "HG paint of optical depth 40 on spheres.", hidden,
                              unreduced, hidden, total));
    Question black = matrix_question();
    black.scene.base = medium("isotropic:0");
    black.directions.azimuth_deg = {0, 90};
    cases.push_back(rule_case("nothing scatters", "Paint on a base of albedo 0.", black, unreduced,
                              black, total));
    const Question clear = spheres_question("index:1.5,0");
    cases.push_back(rule_case("nothing absorbs", "Plane albedo of spheres without absorption.",
                              clear, unreduced_albedo, clear, albedo));
    Question isotropic = matrix_question();
    isotropic.scene.base = medium("isotropic:0.9");
    isotropic.scene.layers.clear();
    Question peaked = isotropic;
    // A share of 1e-5 of the light in many orders makes the solver look for them.
    peaked.scene.base = medium("hg:0.9,1e-5");
    cases.push_back(rule_case("few orders", "Isotropic scattering, and hg with g = 1e-5.", peaked,
                              total, isotropic, total));
}

/// Rules about work that several layers, results or wavelengths share.
void add_shared_work_rules(std::vector<BenchCase>& cases) {
    Question same = spheres_question("index:1.5,0.01");
    same.scene.layers = {layer("index:1.5,0.01@0.1")};
    Question other = same;
    other.scene.layers[0].medium.species[0].parameters[0] += 1e-12;
    cases.push_back(rule_case("same spheres", "Spheres on the same spheres; or nearly the same.",
                              other, total, same, total));
    Question grey = matrix_question();
    grey.wavelength_nm = {450, 550, 650, 750};
    const auto one_by_one = [](Question question) {
        Values last;
        for (const double nm : {450, 550, 650, 750}) {
            question.wavelength_nm = {nm};
            last = total(question);
        }
        return last;
    };
    cases.push_back(rule_case("same wavelength", "Media that do not change, at four wavelengths.",
                              grey, one_by_one, grey, total));
}

/// Rules about the parts of a BRDF, or of the optics behind it, that are asked for.
void add_part_rules(std::vector<BenchCase>& cases) {
    const Question spheres = spheres_question("index:1.5,0.01");
    Question all = spheres;
    all.scene.surface = rte::SurfaceOptions{};
    for (int a = 0; a < 36; ++a) all.directions.azimuth_deg.push_back(5.0 * a);
    Question surface = all, no_surface = all;
    surface.parts = {.subsurface = false, .surface = true, .total = false};
    no_surface.parts = {.subsurface = true, .surface = false, .total = false};
    const char* const one_part = "One part of a BRDF, and all of them.";
    cases.push_back(rule_case("surface alone", one_part, all, lobe, surface, lobe));
    cases.push_back(rule_case("no surface", one_part, all, below, no_surface, below));
    Question symmetric = surface;
    symmetric.directions = matrix_question().directions;
    // Nearer to the horizon exp(-tan^2 / alpha^2) of some directions is below the smallest double:
    // a lobe of 0 has no relative error.
    symmetric.directions.mu_in = math::gauss_legendre(32, 0.2, 1.0).nodes;
    symmetric.directions.mu_out = symmetric.directions.mu_in;
    Question unlike = symmetric;
    for (double& mu : unlike.directions.mu_out) mu *= 1.0 - 1e-15;
    cases.push_back(rule_case("reciprocity",
                              "The lobe at 32 x 32 x 36 directions, and half of them.", unlike,
                              lobe, symmetric, lobe));
    const auto albedo_from = [](PhaseDemand phase) {
        return [phase](const Question& question) {
            return Values{whole_stack(question, phase).base.single_scattering_albedo};
        };
    };
    cases.push_back(rule_case(
        "few moments", "Mie theory of 10 um spheres with the phase function, without.", spheres,
        albedo_from(PhaseDemand::whole), spheres, albedo_from(PhaseDemand::moments_only)));
}

/// A cache file that goes with the benchmark.
struct TemporaryCache {
    std::filesystem::path file =
        std::filesystem::temp_directory_path() / fmt::format("miebrdf-bench-{}.sqlite", ::getpid());
    std::shared_ptr<ResultCache> cache = std::make_shared<ResultCache>(file);
    ~TemporaryCache() {
        std::error_code ignored;
        for (const char* suffix : {"", "-wal", "-shm"})
            std::filesystem::remove(file.string() + suffix, ignored);
    }
};

}  // namespace

std::vector<BenchCase> rules_suite() {
    std::vector<BenchCase> cases;
    add_direction_rules(cases);
    add_layer_rules(cases);
    add_shared_work_rules(cases);
    add_part_rules(cases);
    const auto remembered = [cache = std::make_shared<TemporaryCache>()](const Question& question) {
        Control control{.threads = 1};
        control.cache = cache->cache;
        return question.slice(control).total;
    };
    cases.push_back(rule_case("in the cache", "The whole matrix, computed and remembered.",
                              matrix_question(), total, matrix_question(), remembered));
    return cases;
}

}  // namespace miebrdf::bench
