// Gloss: against Fresnel, a Lambertian ground, and rays counted one by one.
#include <miebrdf/colour.h>
#include <miebrdf/error.h>

#include <cmath>
#include <complex>

#include "rte/math/quadrature.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;

namespace {

constexpr double kRadiansOfDegree = M_PI / 180;

Scene black_below(double n, const std::string& boundary) {
    Scene scene;
    say(scene, "substrate", {"black"});
    say(scene, "host-index", {std::to_string(n)});
    say(scene, "boundary", {boundary});
    return scene;
}

/// Fresnel's equations as textbooks have them.
double textbook_fresnel(double n, double degrees) {
    const double c = std::cos(degrees * kRadiansOfDegree), q = std::sqrt(n * n - 1 + c * c);
    const double s = (c - q) / (c + q), p = (n * n * c - q) / (n * n * c + q);
    return 0.5 * (s * s + p * p);
}

/// The flux by a rule over the source and a rule over the receptor, each ray by itself.
double flux_of_rays(const Brdf& brdf, double degrees, double in_plane, double across) {
    const auto source = math::gauss_legendre(6, -0.375, 0.375);
    const auto source_across = math::gauss_legendre(6, -1.25, 1.25);
    const auto receptor = math::gauss_legendre(20, -0.5 * in_plane, 0.5 * in_plane);
    const auto receptor_across = math::gauss_legendre(20, -0.5 * across, 0.5 * across);
    const double sine = std::sin(degrees * kRadiansOfDegree);
    Directions directions;
    for (const double d : source.nodes)
        directions.mu_in.push_back(std::cos((degrees + d) * kRadiansOfDegree));
    for (const double d : receptor.nodes)
        directions.mu_out.push_back(std::cos((degrees + d) * kRadiansOfDegree));
    for (const double a : source_across.nodes) {
        for (const double b : receptor_across.nodes)
            directions.azimuth_deg.push_back((b - a) / sine);
    }
    const BrdfValues values = brdf.evaluate(directions);
    double flux = 0;
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t o = 0; o < 20; ++o) {
            const double out = (degrees + receptor.nodes[o]) * kRadiansOfDegree;
            for (std::size_t a = 0; a < 120; ++a)
                flux += source.weights[i] / 0.75 * source_across.weights[a / 20] / 2.5 *
                        receptor.weights[o] * receptor_across.weights[a % 20] * kRadiansOfDegree *
                        kRadiansOfDegree * std::cos(out) * std::sin(out) / sine *
                        values.at(0, i, o, a);
        }
    }
    return flux;
}

}  // namespace

TEST_CASE("a polished black surface has Fresnel's gloss", "[pipeline][gloss]") {
    // Fresnel's reflectance of an index over that of 1.567, in units, to one decimal.
    struct Row {
        double n, units[3];
    };
    for (const auto& [n, units] :
         {Row{1.4, {57.0, 71.9, 96.6}}, Row{1.5, {82.0, 89.1, 99.0}}, Row{1.54, {92.7, 95.7, 99.6}},
          Row{1.567, {100, 100, 100}}, Row{1.6, {109.1, 105.2, 100.4}}}) {
        const GlossValues values = gloss(solve(black_below(n, "smooth"), {550}));
        CAPTURE(n);
        REQUIRE(values.angles.size() == 3);
        CHECK(values.converged());
        for (std::size_t a = 0; a < 3; ++a) {
            const Gloss& at = values.angles[a];
            CHECK(std::abs(at.reflectance / textbook_fresnel(n, at.angle_deg) - 1) <= 1e-12);
            CHECK(std::abs(at.units - units[a]) <= 0.05);
        }
    }
}

TEST_CASE("of a matt ground the receptor takes its solid angle", "[pipeline][gloss]") {
    Scene ground;
    say(ground, "substrate", {"lambert:0.6"});
    const GlossValues values = gloss(solve(ground, {550}));
    const double width[3][2] = {{1.8, 3.6}, {4.4, 11.7}, {4.0, 6.0}};
    for (std::size_t a = 0; a < 3; ++a) {
        const Gloss& at = values.angles[a];
        const double flux = 0.6 / M_PI * std::cos(at.angle_deg * kRadiansOfDegree) * width[a][0] *
                            width[a][1] * kRadiansOfDegree * kRadiansOfDegree;
        // The cosine curves over the apertures: 4.4 degrees squared over 12, twice.
        CHECK(std::abs(at.reflectance / flux - 1) <= 3e-3);
    }
}

TEST_CASE("a nearly smooth surface has nearly the gloss of a smooth one", "[pipeline][gloss]") {
    Scene scene;
    say(scene, "substrate", {"black"});
    const GlossValues values =
        gloss(solve(support::under_surface(scene, 1e-3, std::complex<double>(1.5, 0)), {550}));
    for (const Gloss& at : values.angles) {
        CAPTURE(at.angle_deg, at.reflectance);
        // At 85 degrees the lobe is .01 degrees wide across, a 200th of the plateau's half.
        CHECK(std::abs(at.reflectance / textbook_fresnel(1.5, at.angle_deg) - 1) <= 1.5e-2);
    }
}

TEST_CASE("gloss of rough boundaries is the flux of all rays from the source into the receptor",
          "[pipeline][gloss]") {
    double before[3] = {1e9, 1e9, 1e9};
    for (const double alpha : {0.05, 0.2}) {
        const Brdf brdf =
            solve(black_below(1.5, "rough:" + std::to_string(alpha)), {550}, {.tolerance = 1e-4});
        const GlossValues values = gloss(brdf);
        const double width[3][2] = {{1.8, 3.6}, {4.4, 11.7}, {4.0, 6.0}};
        for (std::size_t a = 0; a < 3; ++a) {
            const Gloss& at = values.angles[a];
            CAPTURE(alpha, at.angle_deg, at.units);
            const double rays = flux_of_rays(brdf, at.angle_deg, width[a][0], width[a][1]);
            // Fresnel's slope moves the share of the source; at 85 degrees .4 degrees are 4 %.
            CHECK(std::abs(at.reflectance / rays - 1) <= (a == 2 ? 1e-2 : 2e-3));
            CHECK(at.units < before[a]);
            before[a] = at.units;
        }
    }
}

TEST_CASE("gloss needs ascending wavelengths", "[pipeline][gloss][errors]") {
    CHECK_THROWS_AS(gloss(solve(black_below(1.5, "smooth"), {620, 535})), UsageError);
}
