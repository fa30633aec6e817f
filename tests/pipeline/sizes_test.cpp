// Layers with sizes of their own: each layer's optics are those of its own spheres.
#include <miebrdf/error.h>
#include <miebrdf/plan.h>

#include <algorithm>
#include <cmath>

#include "pipeline/cache/result_cache.h"
#include "pipeline/scene/species_keys.h"
#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/layers.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Kind = mie::SizeDistributionKind;

namespace {

const std::vector<double> kWavelengths = {450, 550};
const SolverOptions kOptions = {.streams = 16, .stokes = 1};

Scene scene_of(const std::string& base, const std::string& coat, double radius_um = 1.0) {
    Scene scene = support::scene_of(base, {coat});
    scene.particles.sizes.effective_radius_um = radius_um;
    return scene;
}

Brdf solved(const Scene& scene, const Control& control = {.threads = 1}) {
    return solve(scene, kWavelengths, kOptions, control);
}

std::vector<LayerSlice> layers_of(const Scene& scene) {
    return compute_layers({resolve(scene, kWavelengths), support::few_directions(), kOptions},
                          {.threads = 1});
}

/// R of optics that were computed one medium at a time, on the terms of compute_layers.
std::vector<double> reflection(const MediumOptics& base, const MediumOptics& coat,
                               double optical_depth, SolverOptions solver) {
    rte::Stack stack;
    stack.base = base.optics;
    stack.coats = {{coat.optics, optical_depth}};
    solver.tolerance -= std::max(base.error_estimate, coat.error_estimate);
    return rte::reflect(stack, support::few_directions(), solver).reflection;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]) / std::abs(b[i]));
    return largest;
}

std::size_t mie_jobs(const Plan& plan) {
    std::size_t jobs = 0;
    for (const PlannedStep& s : plan.steps) jobs += s.stage == "single scattering" ? s.jobs : 0;
    return jobs;
}

}  // namespace

TEST_CASE("what a layer leaves out is that of its scene", "[pipeline][sizes]") {
    ParticleOptions scene;
    scene.sizes = {Kind::gamma, 7.0, 0.05};
    const auto own = [&](const char* text) { return sizes_of(species(text), scene); };
    CHECK(own("TiO2,radius=2").effective_radius_um == 2);
    CHECK(own("TiO2,radius=2").effective_variance == 0.05);
    CHECK(own("TiO2,radius=2").kind == Kind::gamma);
    CHECK(own("TiO2,variance=0.3").effective_variance == 0.3);
    CHECK(own("TiO2,distribution=mono").kind == Kind::mono);
    CHECK(own("TiO2").effective_radius_um == 7);
    // A distribution takes the place of a table of sizes.
    scene.sizes = {Kind::tabulated, 7.0, 0.05, {1, 2}, {1, 1}};
    CHECK(own("TiO2,distribution=gamma").radii_um.empty());
}

TEST_CASE("a scene from C++ is held to the same sizes as words", "[pipeline][sizes][errors]") {
    Scene scene = scene_of("index:1.5,0.01", "index:1.6,0.01@0.1");
    scene.layers[0].medium.species[0].sizes.effective_radius_um = -3;
    CHECK_THROWS_AS(solved(scene), UsageError);
    CHECK_THROWS_WITH(solved(scene),
                      Catch::Contains("index:1.6,0.01") && Catch::Contains("radius -3"));
    scene = scene_of("index:1.5,0.01", "index:1.6,0.01,radius=2@0.1");
    scene.particles.sizes = {Kind::tabulated, 1.0, 0.2, {1, 2}, {1, 1}};
    CHECK_THROWS_WITH(solved(scene),
                      Catch::Contains("radius=2") && Catch::Contains("distribution"));
}

TEST_CASE("sizes that are those of the scene change no bit", "[pipeline][sizes]") {
    const auto plain = layers_of(scene_of("index:1.5,0.01", "index:2.2,0.001@0.5"));
    for (const std::string sizes : {",radius=1", ",variance=0.2", ",distribution=power-law",
                                    ",radius=1,variance=0.2,distribution=power-law"}) {
        CAPTURE(sizes);
        const auto coat = layers_of(scene_of("index:1.5,0.01", "index:2.2,0.001" + sizes + "@0.5"));
        const auto base = layers_of(scene_of("index:1.5,0.01" + sizes, "index:2.2,0.001@0.5"));
        for (std::size_t w = 0; w < plain.size(); ++w) {
            CHECK(coat[w].values == plain[w].values);
            CHECK(base[w].values == plain[w].values);
        }
    }
}

TEST_CASE("every layer scatters as its own spheres do alone", "[pipeline][sizes]") {
    // The scene's radius of 1 um holds for whichever layer says nothing. Last: one material in two
    // sizes, which must not be taken for the same Mie job.
    struct Case {
        const char* base;
        const char* coat;
        double base_radius_um, coat_radius_um;
    };
    const Case c =
        GENERATE(Case{"index:1.5,0.01,radius=3", "index:2.2,0.001,radius=0.2@0.5[grey]", 3, 0.2},
                 Case{"index:1.5,0.01,radius=3", "index:2.2,0.001@0.5[grey]", 3, 1},
                 Case{"index:1.5,0.01", "index:2.2,0.001,radius=0.2@0.5[grey]", 1, 0.2},
                 Case{"index:1.5,0.01,radius=3", "index:1.5,0.01,radius=0.2@0.5[grey]", 3, 0.2});
    CAPTURE(c.base, c.coat);
    const Scene scene = scene_of(c.base, c.coat);
    // By the moments alone: points of the phase function are made better where they matter.
    SolverOptions options = kOptions;
    options.single_scattering_correction = false;
    options.stokes = 1;  // of the intensity alone, as what it is compared with
    const auto together =
        compute_layers({resolve(scene, kWavelengths), support::few_directions(), options}, {});

    const OpticsDemand demand = demand_of(options, 0.0, PhaseDemand::whole);
    const auto alone = [&](const Medium& medium, double radius_um, std::size_t w) {
        Scene one;
        one.base = medium;
        one.base.species.front().sizes = {};
        one.particles.sizes.effective_radius_um = radius_um;
        return compute_optics(resolve(one, kWavelengths), 0, w, demand);
    };
    const double depth = scene.layers[0].depth.value;
    for (std::size_t w = 0; w < kWavelengths.size(); ++w) {
        const auto base = alone(scene.base, c.base_radius_um, w);
        const auto coat = alone(scene.layers[0].medium, c.coat_radius_um, w);
        // Equations and options are the same: rounding alone differs.
        CHECK(largest_difference(together[w].values, reflection(base, coat, depth, options)) <=
              1e-12);
        // With the sizes exchanged it is another BRDF: the bound above tells them apart.
        const auto wrong_base = alone(scene.base, c.coat_radius_um, w);
        const auto wrong_coat = alone(scene.layers[0].medium, c.base_radius_um, w);
        CHECK(largest_difference(together[w].values,
                                 reflection(wrong_base, wrong_coat, depth, options)) >= 0.01);
    }
}

TEST_CASE("a plan counts a Mie run for each medium and size, as the run does",
          "[pipeline][sizes][plan]") {
    struct Case {
        const char* base;
        const char* coat;
        std::size_t jobs;
    };
    const Case c =
        GENERATE(Case{"TiO2", "TiO2@0.5[grey]", 2}, Case{"TiO2,radius=2", "TiO2@0.5[grey]", 4},
                 Case{"TiO2,radius=2", "TiO2,radius=2@0.5[grey]", 2},
                 Case{"TiO2,radius=1", "TiO2@0.5[grey]", 2},  // that of the scene
                 Case{"TiO2", "TiO2,variance=0.1@0.5[grey]", 4},
                 Case{"TiO2", "TiO2,distribution=gamma@0.5[grey]", 4},
                 Case{"TiO2,radius=2", "hg:0.9,0.5@0.5[grey]", 2});
    CAPTURE(c.base, c.coat);
    const support::TemporaryFolder folder;
    const auto cache = std::make_shared<ResultCache>(folder / "results.sqlite");
    const Brdf brdf = solved(scene_of(c.base, c.coat), {.threads = 1, .cache = cache});
    CHECK(mie_jobs(plan_evaluate(brdf, support::few_directions())) == c.jobs);
    brdf.evaluate(support::few_directions());
    // Two wavelengths of layers, and Mie theory.
    CHECK(cache->info().entries == static_cast<std::int64_t>(2 + c.jobs));
}

TEST_CASE("larger spheres of one layer make its plan longer", "[pipeline][sizes][plan]") {
    const auto seconds = [](const char* base) {
        return plan_evaluate(solved(scene_of(base, "hg:0.9,0.5@0.5[grey]")),
                             support::few_directions())
            .seconds();
    };
    CHECK(seconds("TiO2,radius=100") > seconds("TiO2"));
    // The spheres are the same: times that a plan measures differ by less than this.
    const double given = seconds("TiO2,radius=1"), as_scene = seconds("TiO2");
    CHECK(given <= 2 * as_scene);
    CHECK(as_scene <= 2 * given);
}

TEST_CASE("two sizes of one material have two places in the cache", "[pipeline][sizes][cache]") {
    const support::TemporaryFolder folder;
    const auto cache = std::make_shared<ResultCache>(folder / "results.sqlite");
    const auto total = [](const Scene& scene, const Control& control) {
        return solved(scene, control).evaluate(support::few_directions()).slices[0].total;
    };
    std::vector<std::vector<double>> all;
    for (const char* coat :
         {"index:1.5,0.01@0.5[grey]", "index:1.5,0.01,radius=0.2@0.5[grey]",
          "index:1.5,0.01,variance=0.1@0.5[grey]", "index:1.5,0.01,distribution=gamma@0.5[grey]"}) {
        CAPTURE(coat);
        const Scene scene = scene_of("hg:0.9,0.5", coat);
        const auto fresh = total(scene, {.threads = 1});
        CHECK(total(scene, {.threads = 1, .cache = cache}) == fresh);
        CHECK(total(scene, {.threads = 1, .cache = cache}) == fresh);
        CHECK(std::find(all.begin(), all.end(), fresh) == all.end());
        all.push_back(fresh);
    }
}

TEST_CASE("sizes that are those of the scene are found under its entry of the cache",
          "[pipeline][sizes][cache]") {
    const auto jobs = [](const Scene& scene) {
        return list_layer_jobs({resolve(scene, kWavelengths), support::few_directions(), kOptions})
            .jobs;
    };
    const auto plain = jobs(scene_of("index:1.5,0.01", "index:2.2,0.001@0.5[grey]"));
    const auto own =
        jobs(scene_of("index:1.5,0.01,radius=1", "index:2.2,0.001,radius=1@0.5[grey]", 9));
    REQUIRE(plain.size() == 2);
    for (std::size_t j = 0; j < 2; ++j) CHECK(own[j].hash == plain[j].hash);
    CHECK(plain[0].hash != plain[1].hash);
}
