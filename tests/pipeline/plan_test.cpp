#include <miebrdf/plan.h>

#include <algorithm>
#include <ctime>
#include <limits>
#include <string>

#include "pipeline/cache/result_cache.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

const Directions kDirections = {{0.5, 1.0}, {0.3, 0.6}, {0, 90}};

Brdf pair(const std::vector<double>& wavelength_nm, const Control& control = {}) {
    Scene scene = support::scene_of("TiO2", {"AlGaAs7@0.1"});
    scene.particles.sizes.effective_radius_um = 1;
    return solve(scene, wavelength_nm, {}, control);
}

std::size_t jobs_of(const Plan& plan, const std::string& stage) {
    std::size_t jobs = 0;
    for (const PlannedStep& s : plan.steps) jobs += s.stage == stage ? s.jobs : 0;
    return jobs;
}

}  // namespace

TEST_CASE(
    "a plan lists the work of a request: Mie theory for each material, transfer for each "
    "wavelength",
    "[pipeline][plan]") {
    support::Stages stages;
    const Plan plan = plan_evaluate(pair({450, 550, 650}, stages.control()), kDirections);
    CHECK(jobs_of(plan, "single scattering") == 6);
    CHECK(jobs_of(plan, "radiative transfer") == 3);
    CHECK(plan.seconds() > 0);
    CHECK(plan.memory_bytes > 0);
    CHECK(jobs_of(plan, "surface") == 0);
    CHECK(stages.jobs.empty());  // nothing was computed
}

TEST_CASE("what is in the cache is planned as nothing, and done as nothing", "[pipeline][plan]") {
    const support::TemporaryFolder folder;
    Control control{.threads = 1,
                    .cache = std::make_shared<ResultCache>(folder / "results.sqlite")};
    const BrdfValues cold = pair({450, 550}, control).evaluate(kDirections);

    const Plan plan = plan_evaluate(pair({450, 550}, control), kDirections);
    CHECK(plan.leaves_out("in the cache"));
    CHECK(plan.steps.empty());
    std::vector<std::string> stages;
    control.progress = [&](const std::string& stage, std::size_t, std::size_t) {
        stages.push_back(stage);
    };
    const BrdfValues warm = pair({450, 550}, control).evaluate(kDirections);
    CHECK(stages == std::vector<std::string>{"surface", "surface"});  // putting slices together
    for (std::size_t w = 0; w < 2; ++w) {
        CHECK(warm.slices[w].total == cold.slices[w].total);
        CHECK(warm.wavelengths[w].error_estimate == cold.wavelengths[w].error_estimate);
        CHECK(warm.wavelengths[w].solver.method == cold.wavelengths[w].solver.method);
        CHECK(warm.slices[w].physics.largest_albedo == cold.slices[w].physics.largest_albedo);
    }
    // One more wavelength: that one alone.
    const Plan more = plan_evaluate(pair({450, 500, 550}, control), kDirections);
    CHECK(jobs_of(more, "radiative transfer") == 1);
}

TEST_CASE("Mie theory in the cache is taken from there by other directions, and planned so",
          "[pipeline][plan]") {
    const support::TemporaryFolder folder;
    const Control control{.threads = 1,
                          .cache = std::make_shared<ResultCache>(folder / "results.sqlite")};
    pair({450, 550}, control).evaluate(kDirections);
    const Plan plan = plan_evaluate(pair({450, 500, 550}, control), {{0.5, 1.0}, {0.123}, {0, 90}});
    CHECK(jobs_of(plan, "single scattering") == 2);  // both materials at 500 nm
    CHECK(jobs_of(plan, "radiative transfer") == 3);
    const auto cached = std::find_if(plan.omissions.begin(), plan.omissions.end(),
                                     [](const Omission& o) { return o.rule == "in the cache"; });
    REQUIRE(cached != plan.omissions.end());
    CHECK(cached->reason == "4 Mie runs from the cache");
    CHECK(cached->saved_s > 0);
}

TEST_CASE("an albedo is planned with the moments that its first nodes use, and found in the cache",
          "[pipeline][plan]") {
    const support::TemporaryFolder folder;
    const Control control{.threads = 1,
                          .cache = std::make_shared<ResultCache>(folder / "results.sqlite")};
    const auto reason_of = [](const Plan& plan, const std::string& rule) {
        const auto found = std::find_if(plan.omissions.begin(), plan.omissions.end(),
                                        [&](const Omission& o) { return o.rule == rule; });
        return found == plan.omissions.end() ? std::string() : found->reason;
    };
    // Four moments for each node; 128 are what the most nodes of an automatic choice keep.
    CHECK_THAT(reason_of(plan_albedo(pair({450}, control), {0.5}), "few moments"),
               Catch::Contains("48 moments, as many as the first 12 streams use"));
    pair({450}, control).albedo({0.5});
    const Plan again = plan_albedo(pair({450}, control), {0.7});
    CHECK(jobs_of(again, "single scattering") == 0);
    CHECK(reason_of(again, "in the cache") == "2 Mie runs from the cache");
    CHECK(jobs_of(again, "radiative transfer") == 1);
}

TEST_CASE("every saving is an estimate above or equal to zero", "[pipeline][plan]") {
    Scene scene = support::scene_of("TiO2", {"AlGaAs7@0.1", "hg:0.5,0.5@0", "isotropic:0@100"});
    scene.particles.sizes.effective_radius_um = 1;
    const Brdf brdf = solve(scene, {450, 550, 550});
    for (const Plan& plan : {plan_evaluate(brdf, kDirections), plan_albedo(brdf, {0.5, 1.0})}) {
        CHECK(plan.omissions.size() >= 4);
        for (const Omission& omission : plan.omissions) {
            CAPTURE(omission.rule, omission.saved_s);
            CHECK(omission.saved_s >= 0);
            CHECK_FALSE(omission.reason.empty());
        }
    }
}

TEST_CASE("a plan knows about how many nodes the solution will end with", "[pipeline][plan]") {
    // Spheres that take the first numbers of nodes, and some that take more. The formula has an rms
    // of .38 in the logarithm (cost_model.cpp), and numbers of nodes go in steps of up to 1.5.
    const double radius_um = GENERATE(0.05, 1.0, 6.0);
    Scene scene = support::scene_of("TiO2", {"AlGaAs7@0.1"});
    scene.particles.sizes.effective_radius_um = radius_um;
    const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-3}, {.threads = 1});
    const Plan plan = plan_evaluate(brdf, kDirections);
    const auto transfer =
        std::find_if(plan.steps.begin(), plan.steps.end(),
                     [](const PlannedStep& s) { return s.stage == "radiative transfer"; });
    REQUIRE(transfer != plan.steps.end());
    const std::size_t place = transfer->what.rfind(" streams");
    REQUIRE(place != std::string::npos);
    const double planned =
        std::stod(transfer->what.substr(transfer->what.rfind(' ', place - 1) + 1));
    const double streams = brdf.evaluate(kDirections).wavelengths[0].solver.streams;
    CAPTURE(radius_um, streams, transfer->what);
    CHECK(planned <= 2 * streams);
    CHECK(streams <= 2 * planned);
}

TEST_CASE("a plan tells about the time of a run", "[pipeline][plan]") {
    // A factor of 3 is what formulas reach for most scenes, another is for machines and builds that
    // are faster or slower than the one they were fitted to.
    Scene scene = support::scene_of("TiO2", {"AlGaAs7@0.1"});
    scene.particles.sizes.effective_radius_um = 4;
    const auto solved = [&] { return solve(scene, {450, 500, 550, 600, 650}, {}, {.threads = 1}); };
    const double planned_s = plan_evaluate(solved(), kDirections).seconds();
    double taken_s = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 3; ++round) {
        const Brdf brdf = solved();  // a new one remembers no optics
        const std::clock_t start = std::clock();
        brdf.evaluate(kDirections);
        taken_s = std::min(taken_s, double(std::clock() - start) / CLOCKS_PER_SEC);
    }
    CAPTURE(planned_s, taken_s);
    CHECK(planned_s <= 9 * taken_s);
    CHECK(taken_s <= 9 * planned_s);
}

TEST_CASE("a ground without layers, or with none that has depth, is planned and is no half-space",
          "[pipeline][plan]") {
    // The first medium of such a scene is none: a plan of it asked what it is.
    Scene scene = support::scene_of("isotropic:0", {"hg:0.5,0.2@0"});
    scene.substrate = substrate(GENERATE("black", "none", "lambert:0.5", "mirror:index:0.5,5"));
    if (GENERATE(false, true)) scene.boundary = rte::Boundary{};
    const Plan plan = plan_evaluate(solve(scene, {550}), kDirections);
    CHECK_FALSE(plan.leaves_out("nothing scatters"));
    CHECK_FALSE(plan.leaves_out("one half-space"));
    scene.layers = {layer("isotropic:0@1"), layer("isotropic:0@1")};
    CHECK_FALSE(plan_evaluate(solve(scene, {550}), kDirections).leaves_out("nothing scatters"));
}
