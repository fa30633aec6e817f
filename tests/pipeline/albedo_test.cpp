#include <miebrdf/brdf.h>
#include <miebrdf/surface.h>
#include <miebrdf/table1.h>

#include <cmath>
#include <numbers>

#include "rte/math/quadrature.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::scene_of;
using support::under_surface;

TEST_CASE("any number of threads gives the same bits of albedos and of Table 1",
          "[pipeline][albedo][table1]") {
    Scene scene = under_surface(scene_of("GaP", {"SiO2@0.1"}));
    scene.particles.sizes.effective_radius_um = 2;
    const auto albedo = [&](int threads) {
        return solve(scene, {450, 500, 550, 600, 650}, {}, {.threads = threads}).albedo({0.3, 1.0});
    };
    const AlbedoValues one = albedo(1);
    Table1Request table;
    table.conventions = table1_conventions();
    const Table1Result one_table = compute_table1(table, {.threads = 1});
    for (const int threads : {2, 7}) {
        const AlbedoValues many = albedo(threads);
        CHECK(many.plane_albedo == one.plane_albedo);
        CHECK(many.spherical_albedo == one.spherical_albedo);
        const Table1Result many_table = compute_table1(table, {.threads = threads});
        REQUIRE(many_table.entries.size() == one_table.entries.size());
        for (std::size_t i = 0; i < one_table.entries.size(); ++i) {
            CHECK(many_table.entries[i].factor == one_table.entries[i].factor);
        }
    }
}

TEST_CASE("complete albedo lies between the layers' own and 1", "[pipeline][albedo]") {
    Scene scene = scene_of("TiO2,radius=2");
    scene.particles.k_floor = 1e-4;
    const AlbedoValues layers = solve(scene, {550}).albedo({0.1, 0.5, 1.0});
    const AlbedoValues complete = solve(under_surface(scene), {550}).albedo({0.1, 0.5, 1.0});
    for (std::size_t i = 0; i < 3; ++i) {
        // rho + (1 - rho) A > A as long as A < 1.
        CHECK(complete.at(0, i) > layers.at(0, i));
        CHECK(complete.at(0, i) < 1.0);
    }
    CHECK(complete.spherical_albedo[0] > layers.spherical_albedo[0]);
    CHECK(complete.spherical_albedo[0] < 1.0);
}

TEST_CASE("with the reciprocal coupling albedo is the integral of the BRDF", "[pipeline][albedo]") {
    Scene scene = under_surface(scene_of("hg:0.97,0.6"), 0.3, std::complex(1.8, 0.01));
    scene.coupling = rte::SurfaceCoupling::reciprocal;
    const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-6});
    const std::vector<double> mu_in = {0.3, 0.9};
    const AlbedoValues albedo = brdf.albedo(mu_in);

    const math::Quadrature rule = math::gauss_legendre(24, 0.0, 1.0);
    const rte::SurfaceLobe lobe(*scene.surface_index, *scene.surface);
    constexpr int kAzimuths = 24;  // 0.6^24 = 5e-6 of the orders alias
    std::vector<double> azimuth_deg;
    for (int a = 0; a < kAzimuths; ++a) azimuth_deg.push_back(a * 15.0);
    const BrdfValues values = brdf.evaluate({mu_in, rule.nodes, azimuth_deg});
    for (std::size_t i = 0; i < 2; ++i) {
        double layers = 0;  // the lobe is too sharp for 24 nodes: its integral is known
        for (std::size_t o = 0; o < rule.nodes.size(); ++o) {
            for (std::size_t a = 0; a < azimuth_deg.size(); ++a) {
                layers += 2 * std::numbers::pi / kAzimuths * rule.weights[o] * rule.nodes[o] *
                          (values.at(0, i, o, a) - values.at(0, i, o, a, BrdfPart::surface));
            }
        }
        const double rho = lobe.directional_reflectance(mu_in[i]);
        CAPTURE(mu_in[i], rho, layers);
        // 24 Gauss nodes for mu ln mu at grazing: 1e-5; the mean transmittance: 1e-5.
        CHECK(std::abs(albedo.at(0, i) - rho - layers) <= 3e-5);
    }
    CHECK(albedo.spherical_albedo[0] < 1);
    CHECK(albedo.spherical_albedo[0] > albedo.at(0, 1));
}

TEST_CASE("large spheres under a surface: albedos meet the tolerance at the incidences asked for",
          "[pipeline][albedo]") {
    // They once were judged at grazing nodes that only the mean over incidences used.
    Scene scene = under_surface(scene_of("index:2.6,1e-4"));
    scene.coupling = GENERATE(rte::SurfaceCoupling::paper, rte::SurfaceCoupling::reciprocal);
    const AlbedoValues albedo = solve(scene, {550}).albedo({0.1, 0.5, 1});
    CAPTURE(albedo.error_estimate());
    CHECK(albedo.converged());
    const AlbedoValues finer = solve(scene, {550}, {.streams = 96}).albedo({0.1, 0.5, 1});
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(std::abs(albedo.at(0, i) / finer.at(0, i) - 1) <= 1e-3);
    CHECK(std::abs(albedo.spherical_albedo[0] / finer.spherical_albedo[0] - 1) <= 1e-3);
}

TEST_CASE("the reciprocal coupling gains or loses no more than the surface's transmittance varies",
          "[pipeline][albedo]") {
    // docs/maths-surface.md: for layers that absorb nothing the spherical albedo is
    // 1 + <v, R v> / T, v = 1 - rho - T, and no eigenvalue of R is beyond -1 and 1.
    Scene scene = under_surface(scene_of("index:1.5,0,radius=5"));
    scene.coupling = rte::SurfaceCoupling::reciprocal;
    const AlbedoValues albedo = solve(scene, {550}).albedo({0.3, 1.0});
    const rte::SurfaceLobe lobe({1.5, 0}, *scene.surface);
    const math::Quadrature rule = math::gauss_legendre(32, 0.0, 1.0);
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double weight = 2 * rule.weights[i] * rule.nodes[i];
        const double let_in = 1 - lobe.directional_reflectance(rule.nodes[i]);
        mean += weight * let_in;
        square += weight * let_in * let_in;
    }
    CAPTURE(albedo.spherical_albedo[0], (square - mean * mean) / mean);
    // 1e-5: the mean transmittance of the coupling.
    CHECK(std::abs(albedo.spherical_albedo[0] - 1) <= (square - mean * mean) / mean + 1e-5);
    REQUIRE(albedo.converged());
}

TEST_CASE("spherical albedo is the mean of plane albedo also where it is given at once",
          "[pipeline][albedo]") {
    const std::size_t n = 2000;  // midpoint rule, error ~ 1 / n^2
    std::vector<double> mu_in(n);
    for (std::size_t i = 0; i < n; ++i) mu_in[i] = (static_cast<double>(i) + 0.5) / n;
    const AlbedoValues albedo =
        solve(scene_of("hg:0.95,0.7"), {550}, {.tolerance = 1e-6}).albedo(mu_in);
    double mean = 0;
    for (std::size_t i = 0; i < n; ++i) mean += 2 * mu_in[i] * albedo.at(0, i) / n;
    CHECK(std::abs(mean / albedo.spherical_albedo[0] - 1) <= 2e-6);
}
