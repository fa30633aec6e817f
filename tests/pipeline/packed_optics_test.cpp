#include "pipeline/solve/packed_optics.h"

#include <cmath>

#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/brdf.h"
#include "pipeline/solve/scene_optics.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

// Small spheres, so that a test of minutes becomes one of milliseconds.
Request small_spheres(double optical_depth) {
    Request request;
    request.scene.base = parse_medium("index:1.5,0");
    request.scene.coats = {{parse_medium("index:1.6,0.01"), optical_depth}};
    request.scene.particles.sizes.effective_radius_um = 1.0;
    request.wavelength_nm = {500.0, 600.0};
    request.directions = {{0.4, 1.0}, {0.3, 0.9}, {0.0, 180.0}};
    return request;
}

}  // namespace

TEST_CASE("packed optics come back to the last bit, phase function included", "[pipeline][cache]") {
    const Request request = small_spheres(0.1);
    const SceneMedia media(request);
    const bool whole = GENERATE(true, false);
    const OpticsDemand demand =
        demand_of(request, whole ? PhaseDemand::whole : PhaseDemand::moments_only);
    const MediumOptics optics =
        medium_optics(media.media()[1], 500.0, request.scene.particles, demand);
    const MediumOptics copy = unpacked_optics(packed(optics));
    CHECK(copy.refractive_index == optics.refractive_index);
    CHECK(copy.optics.single_scattering_albedo == optics.optics.single_scattering_albedo);
    CHECK(copy.optics.one_minus_albedo == optics.optics.one_minus_albedo);
    CHECK(copy.optics.chi == optics.optics.chi);
    CHECK(copy.optics.has_more_moments == optics.optics.has_more_moments);
    CHECK(copy.q_ext == optics.q_ext);
    CHECK(copy.asymmetry == optics.asymmetry);
    CHECK(copy.error_estimate == optics.error_estimate);
    CHECK(copy.converged == optics.converged);
    REQUIRE(bool(copy.optics.phase) == whole);
    for (double x = -1.0; whole && x <= 1.0; x += 0.01) {
        CHECK(copy.optics.phase(x) == optics.optics.phase(x));
    }
}

TEST_CASE("what is no packed optics is refused, not read beyond its end", "[pipeline][cache]") {
    CHECK_THROWS(unpacked_optics({}));
    CHECK_THROWS(unpacked_optics({1.0, 1.5}));
    CHECK_THROWS(unpacked_optics(std::vector<double>(40, 1e18)));
}

TEST_CASE("scenes that share a medium share its Mie results", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    ResultCache cache(folder / "results.sqlite");
    RunControl control;
    control.cache = &cache;
    compute_brdf(small_spheres(0.1), control);
    const auto entries = cache.info().entries;
    const auto shared = compute_brdf(small_spheres(0.2), control);
    // Two wavelengths of new layers; the two media were known.
    CHECK(cache.info().entries == entries + 2);
    const auto alone = compute_brdf(small_spheres(0.2), RunControl{});
    REQUIRE(shared.slices.size() == alone.slices.size());
    for (std::size_t w = 0; w < alone.slices.size(); ++w) {
        CHECK(shared.slices[w].subsurface == alone.slices[w].subsurface);
    }
}
