#include <miebrdf/sizes.h>

#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

#include "mie/sizes/size_nodes.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using mie::SizeDistributionKind;

TEST_CASE("the paper's power law runs from 20.4858 to 99.5142 um", "[mie][sizes]") {
    const auto range = mie::radius_range({SizeDistributionKind::power_law, 50, 0.2});
    CHECK(range.smallest_um == Approx(20.485820375655).epsilon(1e-13));
    CHECK(range.largest_um == Approx(99.514179624345).epsilon(1e-13));
}

TEST_CASE("the ends of the power law meet both of its conditions", "[mie][sizes]") {
    const double v = GENERATE(1e-12, 1e-6, 1e-3, 0.1, 1.0, 10.0);
    const auto [r1, r2] = mie::radius_range({SizeDistributionKind::power_law, 3, v});
    CAPTURE(v);
    CHECK(r1 + r2 == Approx(6 * (1 + v)).epsilon(1e-12));
    // r2 - r1 loses the digits that sqrt(v) does not have.
    CHECK((r2 - r1) / std::log(r2 / r1) == Approx(3).epsilon(1e-12 + 1e-15 / std::sqrt(v)));
}

TEST_CASE("both rules of nodes give back effective radius and variance", "[mie][sizes]") {
    // r_eff = <r>, v_eff r_eff^2 = <(r - r_eff)^2> with cross-section weights: Hansen & Travis,
    // eq. 2.53-54.
    const auto kind =
        mie::parse_size_distribution(GENERATE("power-law", "gamma", "log-normal", "rosin-rammler"));
    const double v = GENERATE(0.01, 0.2);
    const bool even = GENERATE(false, true);
    const double offset = even ? GENERATE(0.1, 0.5, 1.0) : 0.0;
    const mie::SizeDistribution d{kind, 7.0, v};
    const auto range = mie::radius_range(d, 1e-12);
    const auto nodes =
        even ? mie::even_size_nodes(d, range, 400, offset) : mie::smooth_size_nodes(d, range, 100);
    double area = 0, radius = 0, square = 0;
    for (std::size_t i = 0; i < nodes.radius_um.size(); ++i) {
        area += nodes.area_share[i];
        radius += nodes.area_share[i] * nodes.radius_um[i];
        square += nodes.area_share[i] * std::pow(nodes.radius_um[i] - 7.0, 2);
    }
    CAPTURE(name_of(kind), v, even, offset);
    // 1e-12 of the tails, times their large radii; the ramp of the even rule is three times
    // differentiable: (1 / (0.05 * 400))^5 of its share.
    const double bound = even ? 1e-7 : 1e-9;
    CHECK(std::abs(area - 1) <= bound);
    CHECK(std::abs(radius / 7 - 1) <= bound);
    CHECK(std::abs(square / (49 * v) - 1) <= 20 * bound);
}

TEST_CASE("of Rosin-Rammler powders exp(-(r / r_0)^s) of the volume is larger than r",
          "[mie][sizes]") {
    // r_0 = r_eff Gamma(1 - 1/s) and 1 + v_eff = (pi/s) / sin(pi/s).
    const double s = GENERATE(1.1, 1.5, 3.0, 20.0, 1e4);
    const double x = std::numbers::pi / s;
    const mie::SizeDistribution d{mie::parse_size_distribution("rosin-rammler"), 7.0,
                                  x / std::sin(x) - 1};
    const double r_0 = 7.0 * std::tgamma(1 - 1 / s);
    CAPTURE(s, d.effective_variance);
    // v loses the digits that s gains: 1e-16 / v of s, times ln(r / r_0).
    const double bound = 1e-13 + 1e-15 / d.effective_variance;
    const auto area = mie::area_density(d);
    for (const double t : {1e-3, 0.3, 1.0, 4.0}) {
        // Share of the volume per radius: n r^3 over <n r^3> = r_eff <n r^2>.
        const double r = r_0 * std::pow(t, 1 / s);
        CHECK(area->at(r) * r / 7.0 == Approx(s * t / r * std::exp(-t)).epsilon(bound));
    }
    // Of the area, what lies below r has volume over r: an incomplete gamma function.
    const mie::RadiusRange below{1e-300, r_0};
    CHECK(mie::area_share_within(d, below) ==
          Approx(boost::math::gamma_p(1 - 1 / s, 1.0)).epsilon(bound));
}

TEST_CASE("two shifted even grids make the finer one", "[mie][sizes]") {
    const mie::SizeDistribution d;
    const auto range = mie::radius_range(d);
    const auto fine = mie::even_size_nodes(d, range, 64, 1.0);
    const auto half = mie::even_size_nodes(d, range, 32, 0.5);
    for (std::size_t i = 0; i < half.radius_um.size(); ++i) {
        CHECK(half.radius_um[i] == Approx(fine.radius_um[2 * i]).epsilon(1e-14));
        CHECK(half.area_share[i] == Approx(2 * fine.area_share[2 * i]).epsilon(1e-14));
    }
}

TEST_CASE("a table of sizes integrates to its own effective radius", "[mie][sizes]") {
    // n = r - 1 on [1, 2]: <r^3>/<r^2> = (31/5 - 15/4) / (15/4 - 7/3).
    const mie::SizeDistribution d{SizeDistributionKind::tabulated, 0, 0, {1, 1.25, 2}, {0, 0.5, 2}};
    CHECK(mie::effective_radius_of(d) ==
          Approx((31.0 / 5 - 15.0 / 4) / (15.0 / 4 - 7.0 / 3)).epsilon(1e-14));
    const auto area = mie::area_density(d);
    CHECK(area->at(1.5) == Approx(0.5 * 2.25 / (15.0 / 4 - 7.0 / 3)).epsilon(1e-14));
    CHECK(area->at(2.5) == 0);
}

TEST_CASE("a size table refuses nonsense with the value in the message", "[mie][sizes][errors]") {
    const auto kind = SizeDistributionKind::tabulated;
    CHECK_THROWS_WITH(mie::radius_range({kind, 0, 0, {1}, {1}}), Catch::Contains("1 radii"));
    CHECK_THROWS_WITH(mie::radius_range({kind, 0, 0, {1, 2}, {1, 1, 1}}),
                      Catch::Contains("3 densities"));
    CHECK_THROWS_WITH(mie::radius_range({kind, 0, 0, {2, 1.5}, {1, 1}}), Catch::Contains("1.5"));
    CHECK_THROWS_WITH(mie::radius_range({kind, 0, 0, {1, 2}, {1, -7}}), Catch::Contains("-7"));
    CHECK_THROWS_WITH(mie::radius_range({kind, 0, 0, {1, 2}, {0, 0}}),
                      Catch::Contains("all densities"));
}

TEST_CASE("sizes refuse nonsense with the value in the message", "[mie][sizes][errors]") {
    CHECK_THROWS_WITH(mie::radius_range({SizeDistributionKind::power_law, -1, 0.2}),
                      Catch::Contains("-1"));
    CHECK_THROWS_WITH(mie::radius_range({SizeDistributionKind::gamma, 1, 0}),
                      Catch::Contains("effective_variance: 0 "));
    CHECK_THROWS_WITH(mie::radius_range({SizeDistributionKind::gamma, NAN, 0.1}),
                      Catch::Contains("nan"));
    CHECK_NOTHROW(mie::radius_range({SizeDistributionKind::mono, 1, 0}));
}
