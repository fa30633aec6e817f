#include "pipeline/plan/plan.h"

#include <algorithm>

#include "pipeline/solve/brdf.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

Request pair(std::vector<double> wavelength_nm) {
    Request request;
    request.scene.base = parse_medium("TiO2");
    request.scene.coats = {parse_coat("AlGaAs7@0.1")};
    request.scene.particles.sizes.effective_radius_um = 1;
    request.wavelength_nm = std::move(wavelength_nm);
    request.directions = {{0.5, 1.0}, {0.3, 0.6}, {0, 90}};
    return request;
}

const PlannedStep* step(const Plan& plan, const std::string& stage) {
    for (const PlannedStep& s : plan.steps) {
        if (s.stage == stage) return &s;
    }
    return nullptr;
}

}  // namespace

TEST_CASE(
    "a plan lists the work of a request: Mie theory for each material, transfer for each "
    "wavelength",
    "[pipeline][plan]") {
    const Plan plan = make_plan(pair({450, 550, 650}), LayerQuantity::reflection);
    std::size_t mie = 0;
    for (const PlannedStep& s : plan.steps) mie += s.stage == "single scattering" ? s.jobs : 0;
    CHECK(mie == 6);
    REQUIRE(step(plan, "radiative transfer"));
    CHECK(step(plan, "radiative transfer")->jobs == 3);
    CHECK(plan.seconds() > 0);
    CHECK(step(plan, "surface") == nullptr);
}

TEST_CASE("what is in the cache is planned as nothing, and done as nothing", "[pipeline][plan]") {
    const support::TemporaryFolder folder;
    ResultCache cache(folder / "results.sqlite");
    RunControl control{.threads = 1};
    control.cache = &cache;
    const BrdfResult cold = compute_brdf(pair({450, 550}), control);

    const Plan plan = make_plan(pair({450, 550}), LayerQuantity::reflection, &cache);
    CHECK(plan.leaves_out("in the cache"));
    CHECK(plan.steps.empty());
    std::vector<std::string> stages;
    control.progress = [&](const std::string& stage, std::size_t, std::size_t) {
        stages.push_back(stage);
    };
    const BrdfResult warm = compute_brdf(pair({450, 550}), control);
    CHECK(stages == std::vector<std::string>{"surface", "surface"});  // putting slices together
    for (std::size_t w = 0; w < 2; ++w) {
        CHECK(warm.slices[w].total == cold.slices[w].total);
        CHECK(warm.slices[w].error_estimate == cold.slices[w].error_estimate);
        CHECK(warm.slices[w].physics.largest_albedo == cold.slices[w].physics.largest_albedo);
    }
    // One more wavelength: that one alone.
    const Plan more = make_plan(pair({450, 500, 550}), LayerQuantity::reflection, &cache);
    CHECK(step(more, "radiative transfer")->jobs == 1);
}

TEST_CASE("Mie theory in the cache is taken from there by other directions, and planned so",
          "[pipeline][plan]") {
    const support::TemporaryFolder folder;
    ResultCache cache(folder / "results.sqlite");
    RunControl control{.threads = 1};
    control.cache = &cache;
    compute_brdf(pair({450, 550}), control);
    Request other = pair({450, 500, 550});
    other.directions.mu_out = {0.123};
    const Plan plan = make_plan(other, LayerQuantity::reflection, &cache);
    REQUIRE(step(plan, "single scattering"));
    std::size_t mie = 0;
    for (const PlannedStep& s : plan.steps) mie += s.stage == "single scattering" ? s.jobs : 0;
    CHECK(mie == 2);  // both materials at 500 nm
    CHECK(step(plan, "radiative transfer")->jobs == 3);
    const auto cached = std::find_if(plan.omissions.begin(), plan.omissions.end(),
                                     [](const Omission& o) { return o.rule == "in the cache"; });
    REQUIRE(cached != plan.omissions.end());
    CHECK(cached->reason == "4 Mie runs from the cache");
    CHECK(cached->saved_s > 0);
}

TEST_CASE("every saving is an estimate above or equal to zero", "[pipeline][plan]") {
    Request request = pair({450, 550, 550});
    request.scene.coats.push_back(parse_coat("hg:0.5,0.5@0"));
    request.scene.coats.push_back(parse_coat("isotropic:0@100"));
    for (const auto quantity : {LayerQuantity::reflection, LayerQuantity::albedo}) {
        const Plan plan = make_plan(request, quantity);
        CHECK(plan.omissions.size() >= 4);
        for (const Omission& omission : plan.omissions) {
            CAPTURE(omission.rule, omission.saved_s);
            CHECK(omission.saved_s >= 0);
            CHECK_FALSE(omission.reason.empty());
        }
    }
}
