// Each short cut against the limit in which it is exact.
#include "tools/bench/approximations.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace miebrdf;
using bench::SimpleLayer;
using bench::SimpleStack;

TEST_CASE("without absorption every short cut returns all light", "[bench][approximations]") {
    const SimpleStack white{{1.0, 0.7, 0}, SimpleLayer{1.0, 0.3, 2.0}};
    const SimpleStack bare{{1.0, 0.7, 0}, {}};
    CHECK(std::abs(*bench::kubelka_munk_reflectance(white) - 1) <= 1e-7);
    CHECK(std::abs(*bench::diffusion_reflectance(bare) - 1) <= 1e-15);
    for (const double mu : {0.1, 0.5, 1.0}) {
        // k ~ 1e-6 stands for no absorption (approximations.cpp).
        CHECK(std::abs(bench::two_stream_plane_albedo(white, mu) - 1) <= 2e-5);
        CHECK(std::abs(bench::two_stream_plane_albedo(bare, mu) - 1) <= 2e-5);
    }
}

TEST_CASE("a coat of the base's own material changes nothing", "[bench][approximations]") {
    // Exact for each method: its layers obey the semigroup property.
    for (const double depth : {1e-3, 0.5, 40.0}) {
        const SimpleLayer medium{0.95, 0.6, depth};
        const SimpleStack coated{{0.95, 0.6, 0}, medium}, bare{{0.95, 0.6, 0}, {}};
        CAPTURE(depth);
        CHECK(std::abs(*bench::kubelka_munk_reflectance(coated) -
                       *bench::kubelka_munk_reflectance(bare)) <= 1e-12);
        for (const double mu : {0.1, 0.4, 1.0}) {
            CHECK(std::abs(bench::two_stream_plane_albedo(coated, mu) -
                           bench::two_stream_plane_albedo(bare, mu)) <= 1e-9);
            CHECK(std::abs(bench::single_scattering_reflection(coated, mu, 0.3, 0.8, 0.8) -
                           bench::single_scattering_reflection(bare, mu, 0.3, 0.0, 0.8)) <= 1e-15);
        }
    }
}

TEST_CASE("Kubelka-Munk has no answer where its scattering coefficient is not positive",
          "[bench][approximations]") {
    CHECK_FALSE(bench::kubelka_munk_reflectance({{0.1, 0.5, 0}, {}}));
    CHECK_FALSE(bench::diffusion_reflectance({{0.9, 0.5, 0}, SimpleLayer{}}));
}

TEST_CASE("the two-stream plane albedo of an isotropic half-space is Eddington's",
          "[bench][approximations]") {
    // g = 0: gamma1 = (7 - 4w)/4, gamma2 = (4w - 1)/4, k = sqrt(3 (1 - w)), so that
    // A = w (1/2 + mu0 ... ) of Meador & Weaver 1980; here from the flux equations at w = 0.75:
    // k = sqrt(3)/2, gamma1 = 1, gamma2 = 1/2, gamma3 = gamma4 = 1/2, alpha2 = 3/4.
    const double k = std::sqrt(3.0) / 2;
    for (const double mu : {0.2, 1.0}) {
        const double expected = 0.75 * (0.75 + k / 2) / ((1 + k * mu) * (1 + k));
        CHECK(std::abs(bench::two_stream_plane_albedo({{0.75, 0, 0}, {}}, mu) - expected) <= 1e-15);
    }
}
