// Integrating spheres: limits that hold for any, and what is refused.
#include <cmath>

#include <miebrdf/error.h>
#include <miebrdf/measured.h>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

SphereMeasurement sphere_of(bool baffle, int spheres = 1) {
    SphereMeasurement m{.spheres = spheres};
    for (const auto& [word, value] : {std::pair("diameter", 200.0),
                                      {"sample_port", 25.0},
                                      {"third_port", 12.0},
                                      {"detector_port", 5.0},
                                      {"wall", 0.97},
                                      {"standard", 0.9},
                                      {"detector", 0.1}})
        set_sphere_word(m, word, value);
    m.above.baffle = m.below.baffle = baffle;
    return m;
}

}  // namespace

TEST_CASE("a sphere reads its standard, and an open port, as what they are", "[measured][sphere]") {
    const bool baffle = GENERATE(false, true);
    const int spheres = GENERATE(1, 2);
    SphereMeasurement m = sphere_of(baffle, spheres);
    m.hits_wall = 0.1;
    CAPTURE(baffle, spheres);
    const SlabLight standard{.r_direct = 0.9, .r_diffuse = 0.9};
    CHECK(std::abs(sphere_reading(m, false, standard) - 0.9) <= 1e-14);
    CHECK(std::abs(sphere_reading(m, false, {})) <= 1e-14);
    const SlabLight open{.t_direct = 1.0, .t_unscattered = 1.0, .t_diffuse = 1.0};
    m.hits_wall = 0.0;
    CHECK(std::abs(sphere_reading(m, true, open) - 1.0) <= 1e-14);
    CHECK(sphere_reading(m, true, {}) == 0.0);
}

TEST_CASE("spheres with small ports, and two beams, read what the sample returns and passes",
          "[measured][sphere]") {
    const SlabLight light{0.4, 0.3, 0.04, 0.1, 0.5, 0.2};
    SphereMeasurement small = sphere_of(GENERATE(false, true), GENERATE(1, 2));
    for (IntegratingSphere* one : {&small.above, &small.below})
        one->sample_port_mm = one->third_port_mm = one->detector_port_mm = 1e-3;
    // What the first wall leaves of scattered light differs by the ports' areas alone, 1e-11.
    CHECK(std::abs(sphere_reading(small, false, light) -
                   (0.36 + 0.04 * (small.spheres == 2   ? 1.0
                                   : small.above.baffle ? 1.0
                                                        : 0.97))) <= 1e-9);
    SphereMeasurement dual;
    set_sphere_word(dual, "dual_beam", 1.0);
    set_sphere_word(dual, "unscattered_reflectance", 0.0);
    CHECK(std::abs(sphere_reading(dual, false, light) - 0.36) <= 1e-15);
    CHECK(std::abs(sphere_reading(dual, true, light) - 0.3) <= 1e-15);
}

TEST_CASE("words of spheres are refused with what is allowed", "[measured][sphere][errors]") {
    SphereMeasurement m;
    CHECK_THROWS_WITH(set_sphere_word(m, "wall", 1.2), Catch::Contains("1.2"));
    CHECK_THROWS_WITH(set_sphere_word(m, "walls", 0.9), Catch::Contains("sample_port"));
    CHECK_THROWS_WITH(validate(m), Catch::Contains("diameter"));
    m = sphere_of(true);
    m.above.sample_port_mm = 300;
    CHECK_THROWS_WITH(validate(m), Catch::Contains("smaller"));
}
