// Layers with sizes of their own: how they are written, and that each layer's optics are those of
// its own spheres.
#include "pipeline/scene/layer_sizes.h"

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>
#include "pipeline/cache/result_cache.h"
#include "pipeline/plan/plan.h"
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/layers.h"
#include "pipeline/solve/shared_work.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Kind = mie::SizeDistributionKind;

namespace {

Request scene_of(const std::string& base, const std::string& coat, double radius_um = 1.0) {
    Request request;
    request.scene.base = parse_medium(base);
    request.scene.coats = {parse_coat(coat)};
    request.scene.particles.sizes.effective_radius_um = radius_um;
    request.wavelength_nm = {450, 550};
    request.directions = {{0.3, 1.0}, {0.2, 0.9}, {0.0, 70.0, 180.0}};
    request.solver.streams = 16;
    return request;
}

std::vector<LayerSlice> layers_of(const Request& request) {
    return compute_layers(request, SceneMedia(request), LayerQuantity::reflection, {.threads = 1});
}

/// R of optics that were computed one medium at a time, on the terms of compute_layers.
std::vector<double> reflection(const Request& request, const MediumOptics& base,
                               const MediumOptics& coat) {
    rte::Stack stack;
    stack.base = base.optics;
    stack.coats = {{coat.optics, request.scene.coats[0].optical_depth}};
    rte::SolverOptions solver = request.solver;
    solver.tolerance -= std::max(base.error_estimate, coat.error_estimate);
    return rte::reflect(stack, request.directions, solver).reflection;
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

TEST_CASE("sizes follow a medium in any order and are written back", "[pipeline][sizes]") {
    const std::string text =
        GENERATE("TiO2,radius=0.25", "sopra:TIO2,variance=0.1", "index:1.5,0.01,radius=2",
                 "titanium dioxide,distribution=log-normal",
                 "index:1.5,0,radius=1e-05,variance=0.3,distribution=gamma");
    CHECK(describe(parse_medium(text)) == text);

    const Medium medium = parse_medium("index:1.5,0.01, distribution = mono ,radius=2");
    CHECK(describe(medium) == "index:1.5,0.01,radius=2,distribution=mono");
    CHECK(std::get<IndexMedium>(medium).refractive_index == std::complex<double>(1.5, 0.01));
    CHECK(sizes_of(medium).effective_radius_um == 2.0);
    CHECK(sizes_of(medium).distribution == Kind::mono);
    CHECK_FALSE(sizes_of(medium).effective_variance);

    const CoatMedium coat = parse_coat("TiO2,radius=0.1,variance=0.3@1");
    CHECK(coat.optical_depth == 1);
    CHECK(describe(coat.medium) == "TiO2,radius=0.1,variance=0.3");
    CHECK(describe(with_sizes(coat.medium, {})) == "TiO2");
    CHECK(describe(with_sizes(parse_medium("hg:0.9,0.5"), sizes_of(coat.medium))) == "hg:0.9,0.5");
}

TEST_CASE("what a layer leaves out is that of its scene", "[pipeline][sizes]") {
    ParticleOptions scene;
    scene.sizes = {Kind::gamma, 7.0, 0.05};
    scene.host_index = 1.33;
    const auto own = [&](const char* text) { return particles_of(parse_medium(text), scene); };
    CHECK(own("TiO2,radius=2").sizes.effective_radius_um == 2);
    CHECK(own("TiO2,radius=2").sizes.effective_variance == 0.05);
    CHECK(own("TiO2,radius=2").sizes.kind == Kind::gamma);
    CHECK(own("TiO2,radius=2").host_index == 1.33);
    CHECK(own("TiO2,variance=0.3").sizes.effective_variance == 0.3);
    CHECK(own("TiO2,distribution=mono").sizes.kind == Kind::mono);
    CHECK(own("TiO2").sizes.effective_radius_um == 7);
    // A distribution takes the place of a table of sizes.
    scene.sizes = {Kind::tabulated, 7.0, 0.05, {1, 2}, {1, 1}};
    CHECK(own("TiO2,distribution=gamma").sizes.radii_um.empty());
}

TEST_CASE("sizes that are wrong are refused with layer, key, value and what is allowed",
          "[pipeline][sizes][errors]") {
    struct Case {
        const char* text;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {"TiO2,radius=0", {"'TiO2,radius=0'", "radius 0", "> 0", "um"}},
        {"TiO2,radius=-1", {"radius -1", "> 0"}},
        {"TiO2,radius=nan", {"radius", "nan"}},
        {"index:1.5,0,radius=x", {"'index:1.5,0,radius=x'", "radius", "'x'", "not a number"}},
        {"TiO2,radius=", {"radius", "not a number"}},
        {"TiO2,variance=0", {"variance 0", "up to 10"}},
        {"TiO2,variance=10.5", {"variance 10.5", "up to 10"}},
        {"TiO2,distribution=gama", {"TiO2", "distribution 'gama'", "gamma", "log-normal"}},
        {"TiO2,radius=1,radius=2", {"radius", "twice"}},
        {"TiO2,raduis=1", {"'raduis'", "radius, variance, distribution", "did you mean radius?"}},
        {"TiO2,effective-variance=1", {"'effective-variance'", "did you mean variance?"}},
        {"TiO2,host=1.3", {"'host'", "radius, variance, distribution"}},
        {"index:1.5,radius=1", {"index:N,K"}},
        {",radius=1", {"empty medium"}},
        {"hg:0.9,0.5,radius=1", {"hg:", "',radius=1'", "Mie theory"}},
        {"isotropic:0.9,variance=1", {"isotropic:", "Mie theory"}},
        {"rayleigh:0.9,distribution=mono", {"rayleigh:", "Mie theory"}},
        {"moments:no such file,radius=1", {"moments:", "Mie theory"}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.text);
        CHECK_THROWS_AS(parse_medium(c.text), UsageError);
        for (const std::string& word : c.words)
            CHECK_THROWS_WITH(parse_medium(c.text), Catch::Contains(word));
    }
}

TEST_CASE("sizes after a coat's optical depth are put right", "[pipeline][sizes][errors]") {
    CHECK_THROWS_AS(parse_coat("TiO2@1,radius=0.1"), UsageError);
    CHECK_THROWS_WITH(
        parse_coat("TiO2@1,radius=0.1"),
        Catch::Contains("before the optical depth") && Catch::Contains("TiO2@1,radius=0.1"));
}

TEST_CASE("a moments file may have commas and equals signs in its name", "[pipeline][sizes]") {
    const support::TemporaryFolder folder;
    const std::string file =
        folder.write("g=0,albedo=0.9.csv", "# single_scattering_albedo: 0.9\nl,chi\n0,1\n1,0.1\n");
    CHECK(describe(parse_medium("moments:" + file)) == "moments:" + file);
}

TEST_CASE("a request from C++ is held to the same sizes", "[pipeline][sizes][errors]") {
    Request request = scene_of("index:1.5,0.01", "index:1.6,0.01@0.1");
    std::get<IndexMedium>(request.scene.coats[0].medium).sizes.effective_radius_um = -3;
    CHECK_THROWS_AS(compute_brdf(request), UsageError);
    CHECK_THROWS_WITH(compute_brdf(request),
                      Catch::Contains("index:1.6,0.01") && Catch::Contains("radius -3"));
    request = scene_of("index:1.5,0.01", "index:1.6,0.01,radius=2@0.1");
    request.scene.particles.sizes = {Kind::tabulated, 1.0, 0.2, {1, 2}, {1, 1}};
    CHECK_THROWS_WITH(compute_brdf(request),
                      Catch::Contains("radius=2") && Catch::Contains("distribution"));
}

TEST_CASE("sizes that are those of the scene change no bit", "[pipeline][sizes]") {
    const auto plain = layers_of(scene_of("index:1.5,0.01", "index:2.2,0.001@0.5"));
    for (const char* sizes : {",radius=1", ",variance=0.2", ",distribution=power-law",
                              ",radius=1,variance=0.2,distribution=power-law"}) {
        CAPTURE(sizes);
        const auto coat =
            layers_of(scene_of("index:1.5,0.01", std::string("index:2.2,0.001") + sizes + "@0.5"));
        const auto base =
            layers_of(scene_of(std::string("index:1.5,0.01") + sizes, "index:2.2,0.001@0.5"));
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
        GENERATE(Case{"index:1.5,0.01,radius=3", "index:2.2,0.001,radius=0.2@0.5", 3, 0.2},
                 Case{"index:1.5,0.01,radius=3", "index:2.2,0.001@0.5", 3, 1},
                 Case{"index:1.5,0.01", "index:2.2,0.001,radius=0.2@0.5", 1, 0.2},
                 Case{"index:1.5,0.01,radius=3", "index:1.5,0.01,radius=0.2@0.5", 3, 0.2});
    CAPTURE(c.base, c.coat);
    const Request request = scene_of(c.base, c.coat);
    const auto together = layers_of(request);

    const OpticsDemand demand = demand_of(request, PhaseDemand::whole);
    MediumResolver resolver;
    const auto alone = [&](const Medium& medium, double radius_um, double wavelength_nm) {
        ParticleOptions particles;
        particles.sizes.effective_radius_um = radius_um;
        return medium_optics(resolver.resolve(with_sizes(medium, {})), wavelength_nm, particles,
                             demand);
    };
    for (std::size_t w = 0; w < request.wavelength_nm.size(); ++w) {
        const double nm = request.wavelength_nm[w];
        const auto base = alone(request.scene.base, c.base_radius_um, nm);
        const auto coat = alone(request.scene.coats[0].medium, c.coat_radius_um, nm);
        // The same equations with the same options: rounding alone.
        CHECK(largest_difference(together[w].values, reflection(request, base, coat)) <= 1e-12);
        // With the sizes exchanged it is another BRDF: the bound above tells them apart.
        const auto wrong_base = alone(request.scene.base, c.coat_radius_um, nm);
        const auto wrong_coat = alone(request.scene.coats[0].medium, c.base_radius_um, nm);
        CHECK(largest_difference(together[w].values, reflection(request, wrong_base, wrong_coat)) >=
              0.01);
    }
}

TEST_CASE("a plan counts a Mie run for each medium and size, as the run does",
          "[pipeline][sizes][plan]") {
    struct Case {
        const char* base;
        const char* coat;
        std::size_t jobs;
    };
    const Case c = GENERATE(Case{"TiO2", "TiO2@0.5", 2}, Case{"TiO2,radius=2", "TiO2@0.5", 4},
                            Case{"TiO2,radius=2", "TiO2,radius=2@0.5", 2},
                            Case{"TiO2,radius=1", "TiO2@0.5", 2},  // that of the scene
                            Case{"TiO2", "TiO2,variance=0.1@0.5", 4},
                            Case{"TiO2", "TiO2,distribution=gamma@0.5", 4},
                            Case{"TiO2,radius=2", "hg:0.9,0.5@0.5", 2});
    CAPTURE(c.base, c.coat);
    const Request request = scene_of(c.base, c.coat);
    const Plan plan = make_plan(request, LayerQuantity::reflection);
    CHECK(mie_jobs(plan) == c.jobs);

    const support::TemporaryFolder folder;
    ResultCache cache(folder / "results.sqlite");
    RunControl control{.threads = 1};
    control.cache = &cache;
    compute_layers(request, SceneMedia(request), LayerQuantity::reflection, control);
    // Two wavelengths of layers, and Mie theory.
    CHECK(cache.info().entries == static_cast<std::int64_t>(2 + c.jobs));
}

TEST_CASE("larger spheres of one layer make its plan longer", "[pipeline][sizes][plan]") {
    const auto seconds = [](const char* base) {
        return make_plan(scene_of(base, "hg:0.9,0.5@0.5"), LayerQuantity::reflection).seconds();
    };
    CHECK(seconds("TiO2,radius=100") > seconds("TiO2"));
    CHECK(seconds("TiO2,radius=1") == seconds("TiO2"));
}

TEST_CASE("two sizes of one material have two places in the cache", "[pipeline][sizes][cache]") {
    const support::TemporaryFolder folder;
    ResultCache cache(folder / "results.sqlite");
    RunControl cached{.threads = 1};
    cached.cache = &cache;
    const char* coats[] = {"index:1.5,0.01@0.5", "index:1.5,0.01,radius=0.2@0.5",
                           "index:1.5,0.01,variance=0.1@0.5",
                           "index:1.5,0.01,distribution=gamma@0.5"};
    std::vector<std::vector<double>> all;
    for (const char* coat : coats) {
        CAPTURE(coat);
        const Request request = scene_of("hg:0.9,0.5", coat);
        const auto fresh = layers_of(request);
        const auto first =
            compute_layers(request, SceneMedia(request), LayerQuantity::reflection, cached);
        const auto again =
            compute_layers(request, SceneMedia(request), LayerQuantity::reflection, cached);
        CHECK(first[0].values == fresh[0].values);
        CHECK(again[0].values == fresh[0].values);
        CHECK(std::find(all.begin(), all.end(), fresh[0].values) == all.end());
        all.push_back(fresh[0].values);
    }
}

TEST_CASE("sizes that are those of the scene are found under its entry of the cache",
          "[pipeline][sizes][cache]") {
    const Request plain = scene_of("index:1.5,0.01", "index:2.2,0.001@0.5");
    const Request own = scene_of("index:1.5,0.01,radius=1", "index:2.2,0.001,radius=1@0.5", 9);
    for (const double nm : {450.0, 550.0}) {
        const JobKey empty("layers");
        JobKey a = empty, b = empty;
        SceneMedia(plain).add_to(a, nm);
        SceneMedia(own).add_to(b, nm);
        CHECK(a.hash() == b.hash());
    }
}

TEST_CASE("results of a run share Mie theory only where the sizes of its spheres agree",
          "[pipeline][sizes][shared]") {
    const Request first = scene_of("index:1.5,0.01,radius=2", "hg:0.5,0.5@0.3");
    for (const double scene_radius_um : {1.0, 2.0}) {
        const Request second = scene_of("index:1.5,0.01", "hg:0.9,0.2@0.3", scene_radius_um);
        SharedWork shared;
        shared.expect(first, LayerQuantity::reflection);
        shared.expect(second, LayerQuantity::reflection);
        RunControl control{.threads = 1};
        control.shared = &shared;
        compute_layers(first, SceneMedia(first), LayerQuantity::reflection, control);
        const auto slices =
            compute_layers(second, SceneMedia(second), LayerQuantity::reflection, control);
        const auto alone = layers_of(second);
        for (std::size_t w = 0; w < slices.size(); ++w) CHECK(slices[w].values == alone[w].values);
        CHECK((shared.optics_found() > 0) == (scene_radius_um == 2.0));
    }
}
