// Single scattering that a BRDF keeps, and that the scenes of one run have in common.
#include <miebrdf/error.h>
#include <miebrdf/plan.h>

#include <thread>

#include "pipeline/solve/brdf_state.h"
#include "pipeline/solve/optics_memo.h"
#include "pipeline/solve/resolved_scene.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::few_directions;
using support::scene_of;

namespace {

const std::vector<double> kWavelengths = {450, 550};
// One component: `auto` averages the scattering matrices of spheres as small as these, too.
const SolverOptions kOptions = {.streams = 16, .stokes = 1};

/// Spheres under one paint or another.
std::vector<Scene> painted_spheres() {
    std::vector<Scene> scenes;
    for (const char* coat :
         {"hg:0.5,0.5@0.3", "index:2.2,0.001,radius=1@0.1[grey]", "isotropic:0.9@1"})
        scenes.push_back(scene_of("index:1.5,0.01,radius=1", {coat}));
    return scenes;
}

/// The totals of every scene of one run.
std::vector<std::vector<double>> run(const std::vector<Scene>& scenes, const Control& control) {
    std::vector<std::vector<double>> totals;
    for (const Scene& scene : scenes) {
        const BrdfValues values =
            solve(scene, kWavelengths, kOptions, control).evaluate(few_directions());
        for (const BrdfValues::Slice& slice : values.slices) totals.push_back(slice.total);
    }
    return totals;
}

}  // namespace

TEST_CASE("a BRDF that is asked twice computes Mie theory once", "[pipeline][memo]") {
    // Nobody gives a memo here: every BRDF has its own.
    const Brdf brdf = solve(painted_spheres()[1], kWavelengths, kOptions, {.threads = 1});
    const OpticsMemo& memo = *BrdfState::of(brdf).control.memo;
    const auto first = brdf.evaluate(few_directions());
    CHECK(memo.found() == 0);
    const Brdf copy = brdf;
    const auto second = copy.evaluate(few_directions());
    CHECK(memo.found() == 4);  // two media at two wavelengths
    CHECK(second.slices[1].total == first.slices[1].total);
    brdf.evaluate({{0.7}, {0.6}, {10}});
    CHECK(memo.found() == 8);
    brdf.table();
    CHECK(memo.found() == 12);
    // Albedos need moments alone, which is another, cheaper computation.
    brdf.albedo({0.5});
    CHECK(memo.found() == 12);
    brdf.albedo({0.6});
    CHECK(memo.found() == 16);
}

TEST_CASE("scenes of one run share their spheres, to the same bits on any number of threads",
          "[pipeline][memo]") {
    const auto alone = run(painted_spheres(), {.threads = 1});
    for (const int threads : {1, 2, 7}) {
        const auto memo = make_optics_memo();
        CAPTURE(threads);
        CHECK(run(painted_spheres(), {.threads = threads, .memo = memo}) == alone);
        CHECK(memo->found() == 4);  // two wavelengths, the second and the third scene
    }
}

TEST_CASE("no more is kept than the limit, and what is not kept is computed", "[pipeline][memo]") {
    const auto memo = make_optics_memo(1000);  // bytes
    CHECK(run(painted_spheres(), {.threads = 1, .memo = memo}) ==
          run(painted_spheres(), {.threads = 1}));
    CHECK(memo->found() == 0);

    // Room for one of two.
    MediumOptics optics;
    optics.optics.chi.assign(100, 0.5);
    OpticsMemo small(1000);
    small.keep("first", optics);
    small.keep("second", optics);
    CHECK(small.find("first"));
    CHECK_FALSE(small.find("second"));
    // Optics that are kept again take no room.
    OpticsMemo again(1800);
    for (int i = 0; i < 5; ++i) again.keep("first", optics);
    again.keep("second", optics);
    CHECK(again.find("second"));
}

namespace {

double mie_seconds(const Plan& plan) {
    double sum = 0.0;
    for (const PlannedStep& step : plan.steps)
        sum += step.stage == "single scattering" ? step.seconds : 0.0;
    return sum;
}

}  // namespace

TEST_CASE("the plan of a run says what its scenes share, as they do", "[pipeline][memo][plan]") {
    struct Case {
        const char* what;
        Scene scene;
        std::vector<double> wavelength_nm = kWavelengths;
        SolverOptions options = kOptions;
        Directions directions = few_directions();
        bool shares = true;
    };
    const Scene first = painted_spheres()[0];
    std::vector<Case> cases;
    cases.push_back({.what = "another coat", .scene = painted_spheres()[2]});
    cases.push_back({.what = "other azimuths", .scene = first});
    cases.back().directions.azimuth_deg = {10};
    cases.push_back({.what = "other cosines", .scene = first});
    cases.back().directions.mu_in = {0.4};
    cases.push_back({.what = "the same spheres, said by the scene",
                     .scene = scene_of("index:1.5,0.01", {"hg:0.9,0.2@0.3"})});
    cases.back().scene.particles.sizes.effective_radius_um = 1;
    cases.push_back({.what = "another base",
                     .scene = scene_of("index:1.6,0.01,radius=1", {"hg:0.5,0.5@0.3"}),
                     .shares = false});
    cases.push_back({.what = "other spheres",
                     .scene = scene_of("index:1.5,0.01,radius=2", {"hg:0.5,0.5@0.3"}),
                     .shares = false});
    cases.push_back({.what = "another host", .scene = first, .shares = false});
    cases.back().scene.particles.host.index = 1.33;
    cases.push_back({.what = "another tolerance",
                     .scene = first,
                     .options = {.tolerance = 1e-4, .streams = 16},
                     .shares = false});
    cases.push_back(
        {.what = "other wavelengths", .scene = first, .wavelength_nm = {500}, .shares = false});
    for (const Case& c : cases) {
        CAPTURE(c.what);
        const auto memo = make_optics_memo();
        const Control control{.threads = 1, .memo = memo};
        const Brdf before = solve(first, kWavelengths, kOptions, control);
        const Brdf brdf = solve(c.scene, c.wavelength_nm, c.options, control);
        EarlierWork earlier;
        const Plan alone = plan_evaluate(brdf, c.directions);
        plan_evaluate(before, few_directions(), {}, &earlier);
        const Plan plan = plan_evaluate(brdf, c.directions, {}, &earlier);
        CHECK(plan.leaves_out("same spheres") == c.shares);
        CHECK_FALSE(alone.leaves_out("same spheres"));
        if (c.shares) CHECK(mie_seconds(plan) < mie_seconds(alone));

        before.evaluate(few_directions());
        brdf.evaluate(c.directions);
        CHECK((memo->found() > 0) == c.shares);
    }
}

TEST_CASE("after an interrupted result the others are what they would have been",
          "[pipeline][memo]") {
    const auto memo = make_optics_memo();
    bool cancelled = false;
    Control control{.threads = 1, .memo = memo};
    control.is_cancelled = [&] { return cancelled; };
    control.progress = [&](const std::string& stage, std::size_t, std::size_t) {
        if (stage == "radiative transfer") cancelled = true;  // after the first wavelength
    };
    CHECK_THROWS_AS(run({painted_spheres()[0]}, control), Cancelled);
    cancelled = false;
    control.progress = {};
    CHECK(run(painted_spheres(), control) == run(painted_spheres(), {.threads = 1}));
    CHECK(memo->found() == 6);
}

TEST_CASE("several threads may use one memo", "[pipeline][memo]") {
    OpticsMemo memo(std::size_t{1} << 20);
    std::vector<std::thread> threads;
    std::vector<int> wrong(4, 0);
    for (std::size_t t = 0; t < wrong.size(); ++t) {
        threads.emplace_back([&memo, &wrong, t] {
            for (int job = 0; job < 200; ++job) {
                MediumOptics optics;
                optics.asymmetry = job;
                memo.keep(std::to_string(job), optics);
                const auto found = memo.find(std::to_string((job + 50) % 200));
                if (found && found->asymmetry != (job + 50) % 200) ++wrong[t];
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(wrong == std::vector<int>(4, 0));
}

TEST_CASE("names that a run has looked up are the same from its memo", "[pipeline][memo]") {
    NamedIndexMemo memo;
    Scene scene =
        scene_of("SiO2,radius=1,mass=20% + TiO2,radius=0.1,mass=1% in H2O", {"Au,radius=0.1@1"});
    const auto alone = resolve(scene, kWavelengths);
    for (int round = 0; round < 2; ++round) {
        const auto resolved = resolve(scene, kWavelengths, &memo);
        REQUIRE(resolved.media.size() == alone.media.size());
        for (std::size_t m = 0; m < alone.media.size(); ++m)
            CHECK(resolved.media[m].key == alone.media[m].key);
        CHECK(resolved.media[0].species[1].density_g_cm3 ==
              alone.media[0].species[1].density_g_cm3);
        CHECK(resolved.sources == alone.sources);
    }
    // Other wavelengths and a floor of k are other look-ups.
    scene.particles.k_floor = 0.01;
    CHECK(resolve(scene, kWavelengths, &memo).media[0].key ==
          resolve(scene, kWavelengths).media[0].key);
    CHECK(resolve(scene, {500}, &memo).media[1].key == resolve(scene, {500}).media[1].key);
}
