#include <cmath>
#include <complex>
#include <numbers>

#include <miebrdf/surface.h>
#include "rte/surface/fresnel.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using Complex = std::complex<double>;
using std::numbers::pi;

namespace {

struct Vector {
    double x, y, z;
};

double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Beckmann, correlated Smith and exact Fresnel from vectors, each factor as it is printed.
double lobe_from_vectors(Complex index, double alpha, double mu_in, double mu_out,
                         double azimuth_deg) {
    const double sin_in = std::sqrt(1 - mu_in * mu_in);
    const double sin_out = std::sqrt(1 - mu_out * mu_out);
    const double azimuth = azimuth_deg * pi / 180;
    const Vector in{-sin_in, 0, mu_in};  // towards the source; light travels along +x
    const Vector out{sin_out * std::cos(azimuth), sin_out * std::sin(azimuth), mu_out};
    Vector h{in.x + out.x, in.y + out.y, in.z + out.z};
    const double length = std::sqrt(dot(h, h));
    h = {h.x / length, h.y / length, h.z / length};
    const double tan2 = (1 - h.z * h.z) / (h.z * h.z);
    const double density =
        std::exp(-tan2 / (alpha * alpha)) / (pi * alpha * alpha * std::pow(h.z, 4));
    const auto lambda = [&](double mu) {
        const double a = mu / std::sqrt(1 - mu * mu) / alpha;
        return 0.5 * (std::erf(a) - 1 + std::exp(-a * a) / (a * std::sqrt(pi)));
    };
    const double shadowing = 1 / (1 + lambda(mu_in) + lambda(mu_out));
    return density * shadowing * rte::fresnel_reflectance(index, dot(in, h)) / (4 * mu_in * mu_out);
}

}  // namespace

TEST_CASE("the lobe is D G F / (4 mu_in mu_out) with azimuth 0 on the mirror side",
          "[rte][surface]") {
    const Complex index(2.5, 0.1);
    const double alpha = GENERATE(0.1, 0.3, 0.9);
    rte::SurfaceOptions options;
    options.beckmann_alpha = alpha;
    const rte::SurfaceLobe lobe(index, options);
    for (const double mu_in : {0.1, 0.5, 0.99}) {
        for (const double mu_out : {0.05, 0.6, 0.9}) {
            for (const double azimuth : {0.0, 12.0, 90.0, 180.0, 300.0, -60.0}) {
                const double expected = lobe_from_vectors(index, alpha, mu_in, mu_out, azimuth);
                CAPTURE(alpha, mu_in, mu_out, azimuth);
                // Rounding of tan^2 / alpha^2 in the exponential, up to 300 here, and of erf - 1.
                CHECK(lobe.brdf(mu_in, mu_out, azimuth) == Approx(expected).epsilon(1e-11));
            }
        }
    }
    CHECK(lobe.brdf(0.5, 0.5, 0) > lobe.brdf(0.5, 0.5, 180));
}

TEST_CASE("the lobe is reciprocal", "[rte][surface]") {
    rte::SurfaceOptions options;
    options.distribution =
        GENERATE(rte::MicrofacetDistribution::beckmann, rte::MicrofacetDistribution::ggx);
    options.shadowing = GENERATE(rte::Shadowing::smith_correlated, rte::Shadowing::smith_separable,
                                 rte::Shadowing::v_cavity);
    const rte::SurfaceLobe lobe({1.8, 0.4}, options);
    for (const double azimuth : {0.0, 77.0, 180.0}) {
        for (const double a : {1e-7, 0.2, 1.0}) {
            for (const double b : {1e-5, 0.5, 0.9}) {
                const double there = lobe.brdf(a, b, azimuth);
                CHECK(std::abs(there - lobe.brdf(b, a, azimuth)) <= 1e-13 * there);  // rounding
            }
        }
    }
}

TEST_CASE("the lobe is finite and not negative down to grazing and nearly smooth surfaces",
          "[rte][surface]") {
    rte::SurfaceOptions options;
    options.beckmann_alpha = GENERATE(1e-4, 0.01, 0.3, 4.0);
    options.distribution =
        GENERATE(rte::MicrofacetDistribution::beckmann, rte::MicrofacetDistribution::ggx);
    options.shadowing = GENERATE(rte::Shadowing::smith_correlated, rte::Shadowing::smith_separable,
                                 rte::Shadowing::v_cavity);
    const rte::SurfaceLobe lobe({0.05, 3.5}, options);
    for (const double mu_in : {1e-150, 1e-12, 0.01, 0.7, 1.0}) {
        for (const double mu_out : {1e-150, 1e-9, 0.3, 1.0}) {
            for (const double azimuth : {0.0, 1e-9, 90.0, 180.0}) {
                const double value = lobe.brdf(mu_in, mu_out, azimuth);
                CAPTURE(mu_in, mu_out, azimuth, options.beckmann_alpha);
                CHECK(std::isfinite(value));
                CHECK(value >= 0);
            }
        }
    }
}

TEST_CASE("close to the mirror direction a smooth surface keeps its digits", "[rte][surface]") {
    // tan(theta_h) for mu_out = mu_in and a small azimuth p is tan(theta) p / 2: at alpha = 1e-4
    // and p = 1e-4 degrees the exponent is small, and must not be lost to cancellation.
    const double alpha = 1e-4;
    rte::SurfaceOptions options;
    options.beckmann_alpha = alpha;
    const rte::SurfaceLobe lobe({1.5, 0}, options);
    const double mu = 0.5;
    const double azimuth_deg = 1e-3;
    const double tangent = std::sqrt(1 - mu * mu) / mu * std::sin(azimuth_deg * pi / 360);
    const double ratio = lobe.brdf(mu, mu, azimuth_deg) / lobe.brdf(mu, mu, 0);
    // Besides D only cos_facet and cos_half move, by p^2 = 3e-10.
    CHECK(ratio == Approx(std::exp(-tangent * tangent / (alpha * alpha))).epsilon(1e-8));
}

TEST_CASE("the lobe refuses directions that do not exist", "[rte][surface][errors]") {
    const rte::SurfaceLobe lobe({1.5, 0}, {});
    CHECK_THROWS_WITH(lobe.brdf(0, 0.5, 0),
                      Catch::Contains("mu_in: 0") && Catch::Contains("(0, 1]"));
    CHECK_THROWS_WITH(lobe.brdf(0.5, 1.5, 0), Catch::Contains("mu_out: 1.5"));
    CHECK_THROWS_WITH(lobe.brdf(std::nan(""), 0.5, 0), Catch::Contains("nan"));
    CHECK_THROWS_WITH(lobe.brdf(0.5, 0.5, std::nan("")), Catch::Contains("azimuth"));
}
