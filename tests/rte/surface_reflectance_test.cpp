#include <cmath>
#include <complex>
#include <numbers>

#include <miebrdf/surface.h>
#include "rte/surface/fresnel.h"
#include "rte/surface/reflectance_table.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using rte::MicrofacetDistribution;
using rte::Shadowing;

namespace {

/// rho by the definition: midpoints over the outgoing hemisphere, nothing clever. The lobe is
/// resolved when a cell is small against alpha; midpoint converges as cells^-2.
double brute_force(const rte::SurfaceLobe& lobe, double mu_in, int rows, int columns) {
    double sum = 0;
    for (int i = 0; i < rows; ++i) {
        const double mu_out = (i + 0.5) / rows;
        for (int j = 0; j < columns; ++j) {
            sum += mu_out * lobe.brdf(mu_in, mu_out, 180.0 * (j + 0.5) / columns);
        }
    }
    return sum * 2 * std::numbers::pi / (static_cast<double>(rows) * columns);
}

}  // namespace

TEST_CASE("rho is the integral of the lobe over the outgoing hemisphere", "[rte][rho]") {
    rte::SurfaceOptions options;
    options.distribution = GENERATE(MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx);
    options.shadowing =
        GENERATE(Shadowing::smith_correlated, Shadowing::smith_separable, Shadowing::v_cavity);
    options.fresnel = GENERATE(rte::FresnelKind::exact, rte::FresnelKind::schlick);
    options.beckmann_alpha = GENERATE(0.3, 0.8);
    const rte::SurfaceLobe lobe({2.0, 0.5}, options);
    for (const double mu_in : {0.1, 0.4, 0.8, 1.0}) {
        const double coarse = brute_force(lobe, mu_in, 200, 200);
        const double fine = brute_force(lobe, mu_in, 400, 400);
        const auto rho = rte::directional_reflectance({2.0, 0.5}, options, mu_in);
        CAPTURE(mu_in, rho.value, fine, fine - coarse);
        CHECK(rho.converged);
        // The midpoint rule's own error, a third of its last change, with a factor 3 to spare
        // for the edge at mu_out = 0; and the tolerance of 1e-6.
        CHECK(std::abs(rho.value - fine) <= std::abs(fine - coarse) + 1e-6);
        CHECK(std::abs(fine - coarse) <= 1e-3);
    }
}

TEST_CASE("rho keeps its tolerance where mirrors reflect totally beyond a critical angle",
          "[rte][rho]") {
    // The reflectance ends like a square root at the critical angle: 4e-5 were lost there.
    rte::SurfaceOptions options;
    options.distribution = GENERATE(MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx);
    options.shadowing = GENERATE(Shadowing::smith_correlated, Shadowing::v_cavity);
    const double n = GENERATE(0.3, 0.7, 0.95), k = GENERATE(0.0, 1e-3);
    options.beckmann_alpha = 0.3;
    const rte::SurfaceLobe lobe({n, k}, options);
    // At 0.714 = sqrt(1 - 0.7^2) the flat surface itself is at the critical angle.
    for (const double mu : {0.05, 0.3, 0.7, 0.714, 0.9, 1.0}) {
        const auto rho = rte::directional_reflectance({n, k}, options, mu, 1e-6);
        const auto truth = rte::directional_reflectance({n, k}, options, mu, 2e-8);
        CAPTURE(n, k, mu, rho.nodes, rho.error_estimate, truth.value);
        CHECK(truth.converged);
        CHECK(std::abs(rho.value - truth.value) <= 1e-6);
        // Midpoints know nothing of the kink: a grid may meet it well or badly.
        const double coarse = brute_force(lobe, mu, 200, 200);
        const double fine = brute_force(lobe, mu, 400, 400);
        CHECK(std::abs(rho.value - fine) <= 2 * std::abs(fine - coarse) + 1e-5);
        CHECK(std::abs(fine - coarse) <= 1e-3);
    }
}

TEST_CASE("a thinner medium without absorption lets through what a closed form says",
          "[rte][rho]") {
    // Roughness 1e-4 is flat: inside the critical angle 1 - rho is that of Fresnel, beyond it 0.
    rte::SurfaceOptions options;
    options.beckmann_alpha = 1e-4;
    const auto fresnel = [](double cosine) { return rte::fresnel_reflectance({0.7, 0.0}, cosine); };
    for (const double flat_mu : {0.1, 0.5, 0.70, 0.72, 0.9}) {
        CHECK(rte::directional_reflectance({0.7, 0.0}, options, flat_mu).value ==
              Approx(fresnel(flat_mu)).margin(2e-5));
    }
    // At the critical angle itself half of all mirrors reflect totally: the mean of F over slopes x
    // along the plane of incidence, by midpoints; slopes across it change the cosine by alpha^2.
    const double mu = std::sqrt(1.0 - 0.7 * 0.7), sine = 0.7;
    const double alpha = options.beckmann_alpha;
    double sum = 0;
    const int points = 400000;
    for (int i = 0; i < points; ++i) {
        const double u = 12.4 * ((i + 0.5) / points - 0.5), x = alpha * u;
        const double cosine = (mu + x * sine) / std::sqrt(1.0 + x * x);
        sum += std::exp(-u * u) * (1.0 + x * sine / mu) * fresnel(cosine);
    }
    sum *= 12.4 / points / std::sqrt(std::numbers::pi);
    CHECK(rte::directional_reflectance({0.7, 0.0}, options, mu).value == Approx(sum).margin(1e-6));
}

TEST_CASE("rho is right where the lobe is too narrow for a grid over the hemisphere",
          "[rte][rho]") {
    // Brute force over a patch around the mirror direction alone, 12 alpha wide on each side.
    const double alpha = 0.01;
    rte::SurfaceOptions options;
    options.beckmann_alpha = alpha;
    const rte::SurfaceLobe lobe({1.5, 0}, options);
    const double theta_in = 50 * std::numbers::pi / 180;
    const int cells = 600;
    const double half_theta = 12 * alpha;
    const double half_azimuth = 12 * alpha / std::tan(theta_in);
    double sum = 0;
    for (int i = 0; i < cells; ++i) {
        const double theta = theta_in + half_theta * (2 * (i + 0.5) / cells - 1);
        for (int j = 0; j < cells; ++j) {
            const double azimuth = half_azimuth * (2 * (j + 0.5) / cells - 1);
            sum +=
                lobe.brdf(std::cos(theta_in), std::cos(theta), azimuth * 180 / std::numbers::pi) *
                std::cos(theta) * std::sin(theta);
        }
    }
    sum *= 4 * half_theta * half_azimuth / (static_cast<double>(cells) * cells);
    // The midpoint rule is exact to rounding for a Gaussian that fits; the patch leaves out e^-36.
    CHECK(lobe.directional_reflectance(std::cos(theta_in)) == Approx(sum).epsilon(2e-6));
}

TEST_CASE("a nearly smooth surface reflects like a mirror", "[rte][rho]") {
    rte::SurfaceOptions options;
    options.beckmann_alpha = 1e-4;
    const std::complex<double> m(2.5, 0.3);
    const double mu = GENERATE(0.05, 0.3, 0.9, 1.0);
    // Corrections are of order (alpha / mu)^2 <= 4e-6.
    CHECK(rte::directional_reflectance(m, options, mu).value ==
          Approx(rte::fresnel_reflectance(m, mu)).margin(2e-5));
}

TEST_CASE("the error estimate of rho holds from normal to grazing, smooth to rough", "[rte][rho]") {
    rte::SurfaceOptions options;
    options.distribution = GENERATE(MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx);
    options.shadowing = GENERATE(Shadowing::smith_correlated, Shadowing::smith_separable);
    options.beckmann_alpha = GENERATE(1e-4, 0.01, 0.1, 0.3, 1.0, 4.0);
    const std::complex<double> m =
        GENERATE(std::complex<double>(1.5, 0), std::complex<double>(0.05, 3.5));
    for (const double mu : {1e-12, 1e-6, 1e-3, 0.03, 0.3, 0.7, 0.99, 1.0}) {
        const auto rho = rte::directional_reflectance(m, options, mu, 1e-6);
        const auto truth = rte::directional_reflectance(m, options, mu, 2e-8);
        CAPTURE(options.beckmann_alpha, mu, rho.nodes, rho.error_estimate);
        CHECK(truth.converged);
        CHECK(rho.converged);
        CHECK(std::abs(rho.value - truth.value) <= 1e-6);
        CHECK(rho.value >= 0);
        CHECK(rho.value <= 1);
    }
}

TEST_CASE("index-matched surfaces reflect nothing and let everything in", "[rte][rho]") {
    const rte::SurfaceLobe lobe({1.0, 0.0}, {});
    CHECK(lobe.brdf(0.3, 0.4, 0) == 0);
    CHECK(lobe.directional_reflectance(1e-3) == 0);
    CHECK(lobe.averaged_diffuse_reflectance_factor() == Approx(1.0).epsilon(1e-14));
}

TEST_CASE("means over the hemisphere are those of closed forms", "[rte][rho]") {
    using rte::HemisphereMean;
    const auto cube = [](double mu) { return mu * mu * mu; };
    CHECK(rte::mean_transmittance(cube, HemisphereMean::solid_angle).value ==
          Approx(1 - 1.0 / 4).epsilon(1e-14));
    CHECK(rte::mean_transmittance(cube, HemisphereMean::cosine).value ==
          Approx(1 - 2.0 / 5).epsilon(1e-14));
    // A layer of 0.01 at grazing: mean of exp(-mu / w) is w (1 - e^(-1/w)).
    const auto layer = [](double mu) { return std::exp(-mu / 0.01); };
    CHECK(rte::mean_transmittance(layer, HemisphereMean::solid_angle).value ==
          Approx(0.99).margin(1e-5));  // the default tolerance
    // The cosine-weighted mean of a smooth glass surface n = 1.5 is 0.90822, its external diffuse
    // reflectance 0.09178 (Duntley 1942's formula; Egan & Hilgeman 1979, table 1: 0.092).
    const auto glass = [](double mu) { return rte::fresnel_reflectance(1.5, mu); };
    CHECK(rte::mean_transmittance(glass, HemisphereMean::cosine, 1e-7).value ==
          Approx(1 - 0.09178).margin(6e-6));
}

TEST_CASE("rho refuses nonsense with the value", "[rte][rho][errors]") {
    CHECK_THROWS_WITH(rte::directional_reflectance({1.5, 0}, {}, 0.0), Catch::Contains("(0, 1]"));
    CHECK_THROWS_WITH(rte::directional_reflectance({1.5, 0}, {}, 1.1), Catch::Contains("1.1"));
    CHECK_THROWS_WITH(rte::directional_reflectance({-1.5, 0}, {}, 0.5), Catch::Contains("-1.5"));
    CHECK_THROWS_WITH(rte::directional_reflectance({1.5, 0}, {}, 0.5, 0.0),
                      Catch::Contains("tolerance"));
}

TEST_CASE("a table of reflectances has those of any index", "[rte][surface]") {
    rte::SurfaceOptions options;
    options.beckmann_alpha = GENERATE(0.05, 0.3, 0.8);
    options.distribution = GENERATE(MicrofacetDistribution::beckmann, MicrofacetDistribution::ggx);
    options.shadowing = GENERATE(Shadowing::v_cavity, Shadowing::smith_correlated);
    const std::vector<double> mu{0.02, 0.2, 0.7, 1.0};
    const rte::ReflectanceTable table(options, mu, 100);
    for (const std::complex<double> index :
         {std::complex(1.01, 0.0), std::complex(1.5, 0.0), std::complex(2.7, 1e-3),
          std::complex(0.2, 3.4), std::complex(1.8, 8.3), std::complex(0.7, 0.0)}) {
        const std::vector<double> found = table.at(index);
        for (std::size_t k = 0; k < mu.size(); ++k) {
            const double direct = rte::directional_reflectance(index, options, mu[k], 1e-9).value;
            CAPTURE(options.beckmann_alpha, index, mu[k], found[k], direct);
            CHECK(std::abs(found[k] - direct) <= 2e-6);
        }
    }
}
