#include <cmath>
#include <numbers>

#include "rte/math/quadrature.h"
#include "rte/surface/microfacet.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using rte::MicrofacetDistribution;
using rte::Shadowing;
using std::numbers::pi;

namespace {

double integrate(double from, double to, int nodes, const std::function<double(double)>& f) {
    const auto rule = math::gauss_legendre(nodes, from, to);
    double sum = 0;
    for (int i = 0; i < nodes; ++i) sum += rule.weights[i] * f(rule.nodes[i]);
    return sum;
}

rte::SurfaceOptions with(MicrofacetDistribution distribution, Shadowing shadowing, double alpha) {
    rte::SurfaceOptions options;
    options.beckmann_alpha = alpha;
    options.distribution = distribution;
    options.shadowing = shadowing;
    return options;
}

}  // namespace

TEST_CASE("the mirrors' normals project onto the whole surface", "[rte][microfacet]") {
    const auto distribution =
        GENERATE(MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx);
    const double alpha = GENERATE(0.01, 0.1, 0.3, 1.0, 3.0);
    // Integral of D cos dOmega = 2 pi integral of D cos sin dtheta; theta = atan(alpha tan(v))
    // spreads the peak over v in (0, pi/2).
    const double total = integrate(0, pi / 2, 400, [&](double v) {
        const double tangent = alpha * std::tan(v);
        const double theta = std::atan(tangent);
        const double slope = alpha / (std::cos(v) * std::cos(v)) / (1 + tangent * tangent);
        return 2 * pi * rte::normal_density(distribution, alpha, tangent * tangent) *
               std::cos(theta) * std::sin(theta) * slope;
    });
    CAPTURE(alpha);
    CHECK(total == Approx(1.0).epsilon(1e-9));  // the rule's error for tan^2-like ends
}

TEST_CASE("the density of normals stays finite for any slope", "[rte][microfacet]") {
    for (const auto distribution :
         {MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx}) {
        for (const double tan2 : {0.0, 1e10, 1e200, HUGE_VAL}) {
            const double density = rte::normal_density(distribution, 0.3, tan2);
            CHECK(density >= 0);
            CHECK(density <= 1 / (pi * 0.3 * 0.3) * (1 + 1e-15));
        }
    }
    // GGX at tan -> infinity: alpha^2 / pi, from 1 / (pi alpha^2 (cos^2 + sin^2 / alpha^2)^2).
    CHECK(rte::normal_density(MicrofacetDistribution::ggx, 0.3, 1e60) ==
          Approx(0.09 / pi).epsilon(1e-12));
}

TEST_CASE("weak white furnace: the visible mirrors fill the view from any direction",
          "[rte][microfacet]") {
    // Heitz 2014, eq. 14: integral of G1 D(h) max(0, o.h) dOmega_h = mu. In slopes along (x) and
    // across (y) the plane of view: integral of P (mu + x sin) over mu + x sin > 0, = mu / G1.
    const auto distribution =
        GENERATE(MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx);
    const double alpha = GENERATE(0.05, 0.3, 1.0);
    const double mu = GENERATE(1e-6, 0.01, 0.2, 0.6, 0.95);
    const double sine = std::sqrt(1 - mu * mu);
    // Density of one slope: y is integrated out, Gaussian or (1 + x^2/a^2)^(-3/2) / (2 a).
    const auto slope_density = [&](double t) {
        return distribution == MicrofacetDistribution::beckmann
                   ? std::exp(-t * t) / (alpha * std::sqrt(pi))
                   : std::pow(1 + t * t, -1.5) / (2 * alpha);
    };
    // x = alpha tan(v), from the slope that is seen edge-on.
    const double lowest = std::atan(-mu / sine / alpha);
    const double projected = integrate(lowest, pi / 2, 400, [&](double v) {
        const double t = std::tan(v);
        return slope_density(t) * (mu + alpha * t * sine) * alpha * (1 + t * t);
    });
    CAPTURE(alpha, mu);
    CHECK(rte::cosine_over_masking(distribution, alpha, mu) == Approx(projected).epsilon(1e-9));
}

TEST_CASE("masking ends where it should", "[rte][microfacet]") {
    for (const double alpha : {0.01, 0.3, 2.0}) {
        using enum MicrofacetDistribution;
        CHECK(rte::cosine_over_masking(beckmann, alpha, 1.0) == 1.0);  // seen from above: all
        CHECK(rte::cosine_over_masking(ggx, alpha, 1.0) == 1.0);
        // Grazing: mu Lambda -> alpha / (2 sqrt(pi)) and alpha / 2 (head of microfacet.h).
        CHECK(rte::cosine_over_masking(beckmann, alpha, 1e-14) ==
              Approx(alpha / (2 * std::sqrt(pi))).epsilon(1e-11));
        CHECK(rte::cosine_over_masking(ggx, alpha, 1e-14) == Approx(alpha / 2).epsilon(1e-11));
    }
}

TEST_CASE("shadowing is symmetric, at most 1, and the correlated form keeps more light",
          "[rte][microfacet]") {
    const auto distribution =
        GENERATE(MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx);
    for (const double mu_in : {1e-9, 0.1, 0.5, 1.0}) {
        for (const double mu_out : {1e-9, 0.2, 0.9}) {
            const double sin_in = std::sqrt(1 - mu_in * mu_in);
            const double sin_out = std::sqrt(1 - mu_out * mu_out);
            const double cos_facet = std::sqrt(0.5 * (1 + mu_in * mu_out - sin_in * sin_out));
            const double cos_half = (mu_in + mu_out) / (2 * cos_facet);
            double g[3];
            for (int s = 0; s < 3; ++s) {
                const auto options = with(distribution, static_cast<Shadowing>(s), 0.3);
                const rte::ShadowingOverCosines shadowing(options);
                const double there = shadowing({mu_in, mu_out, cos_half, cos_facet});
                const double back = shadowing({mu_out, mu_in, cos_half, cos_facet});
                g[s] = there * mu_in * mu_out;
                CAPTURE(mu_in, mu_out, s);
                CHECK(there == Approx(back).epsilon(1e-14));
                CHECK(g[s] > 0);
                CHECK(g[s] <= 1 + 1e-15);
            }
            CHECK(g[0] >= g[1] * (1 - 1e-15));
        }
    }
}

TEST_CASE("the V-cavity lets everything through at normal incidence and exitance",
          "[rte][microfacet]") {
    const auto options = with(MicrofacetDistribution::beckmann, Shadowing::v_cavity, 0.3);
    const rte::ShadowingOverCosines shadowing(options);
    CHECK(shadowing({1.0, 1.0, 1.0, 1.0}) == 1.0);
    // 60 degrees in the mirror direction: 2 * 0.5 / 0.5 > 1, so nothing is lost.
    CHECK(shadowing({0.5, 0.5, 1.0, 0.5}) * 0.25 == Approx(1.0).epsilon(1e-15));
    // Back towards the source at 75 degrees: cos_half = cos 75, cos_facet = 1: G = 2 cos^2(75).
    const double c = std::cos(75 * pi / 180);
    CHECK(shadowing({c, c, c, 1.0}) * c * c == Approx(2 * c * c).epsilon(1e-14));
}

TEST_CASE("roughness out of range is refused with its value", "[rte][microfacet][errors]") {
    using enum MicrofacetDistribution;
    for (const double alpha : {0.0, -0.3, 5.0, std::nan("")}) {
        CHECK_THROWS_WITH(rte::ShadowingOverCosines(with(beckmann, Shadowing::v_cavity, alpha)),
                          Catch::Contains("beckmann_alpha") && Catch::Contains("0.0001 to 4"));
    }
}
