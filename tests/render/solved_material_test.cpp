// Materials of the solver in the renderer: what their tables lose, and that pictures show
// what the solver predicts.
#include "pipeline/render/solved_material.h"

#include <miebrdf/error.h>
#include <miebrdf/surface.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "rte/math/quadrature.h"
#include "tests/render/support.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using namespace miebrdf::render;
using support::scene_of;
using support::under_surface;

namespace {

Brdf brdf_of(const Scene& scene, const SolverOptions& options = {}) {
    return solve(scene, {550}, options);
}

SolvedMaterial material_of(const BrdfTable& table) { return SolvedMaterial({&table, 1}); }

/// With the coupling that Brdf::evaluate has.
SolvedMaterial material_of(const Scene& scene, BrdfPart part = BrdfPart::total) {
    const auto coupling = scene.coupling.value_or(rte::SurfaceCoupling::paper);
    return material_of(brdf_of(scene).table({.part = part, .coupling = coupling}));
}

RenderScene sphere_of(const Scene& scene) {
    return sphere_scene(std::make_shared<SolvedMaterial>(material_of(scene)));
}

double value(const RenderBrdf& brdf, double mu_in, double mu_out, double azimuth_deg) {
    std::vector<double> values(brdf.wavelengths());
    brdf.evaluate(mu_in, mu_out, std::cos(azimuth_deg * std::numbers::pi / 180), values);
    return values[0];
}

double disc_mean(const SpectralPicture& picture) {
    return mean_radiance(picture) * 4 / std::numbers::pi;
}

}  // namespace

TEST_CASE("layers that do not show are not computed for a picture either", "[render][solved]") {
    support::Stages stages;
    const Brdf brdf =
        solve(scene_of("index:1.5,0,radius=1", {"hg:0.3,0.1@60"}), {550}, {}, stages.control());
    const SolvedMaterial table = material_of(brdf.table());
    CHECK(stages.jobs["single scattering"] == 1);  // the coat
    const double alone = value(material_of(scene_of("hg:0.3,0.1")), 0.5, 0.6, 40);
    CHECK(std::abs(value(table, 0.5, 0.6, 40) / alone - 1) <= 2e-3);
}

TEST_CASE("the table agrees with the solver between its nodes", "[render][solved]") {
    const Scene scene =
        GENERATE(scene_of("hg:0.95,0.7"), scene_of("isotropic:1"),
                 scene_of("hg:0.95,0.7", {"hg:0.9,0.46@0.1"}),
                 under_surface(scene_of("rayleigh:0.9", {"hg:0.7,0.4@0.3"}), 0.3, 1.5));
    const InterpolationError error =
        interpolation_error(material_of(scene).table(), brdf_of(scene));
    CAPTURE(describe(scene), error.median, error.largest);
    // Fourier orders are summed to a tenth of the tolerance, 1e-4; the rest is the table's.
    CHECK(error.largest <= SolvedMaterial::kTolerance + 1e-4);
    CHECK(error.median <= 0.1 * SolvedMaterial::kTolerance);
}

TEST_CASE("the glory of spheres is as narrow and high as the solver says", "[render][solved]") {
    // 2 um, 550 nm: some 2 degrees wide, far narrower than the table's cosines and azimuths.
    const Scene scene = scene_of("index:1.5,0.001,radius=2", {"index:1.8,0.01,radius=2@0.2"});
    // The solver's tolerance comes on top of the table's, because the two solutions choose their
    // streams at different directions; and points of P, which the solver computes anew where they
    // are too noisy and a table does not (pipeline/solve/phase_errors.h): 4e-4 in all at 1e-4.
    const auto [tolerance, bound] = GENERATE(std::tuple{1e-3, 1e-3 + SolvedMaterial::kTolerance},
                                             std::tuple{1e-4, 4e-4 + SolvedMaterial::kTolerance});
    const Brdf brdf = brdf_of(scene, {.tolerance = tolerance});
    const SolvedMaterial table = material_of(brdf.table({.part = BrdfPart::subsurface}));
    const Directions directions = {
        {0.33, 0.5, 0.77}, {0.33, 0.5, 0.77}, {0, 90, 150, 176, 178, 179, 180}};
    const std::vector<double> exact = brdf.evaluate(directions).slices[0].total;
    const double largest = *std::max_element(exact.begin(), exact.end());
    std::size_t index = 0;
    for (const double in : directions.mu_in) {
        for (const double out : directions.mu_out) {
            for (const double azimuth : directions.azimuth_deg) {
                CAPTURE(tolerance, in, out, azimuth, exact[index], largest);
                CHECK(std::abs(value(table, in, out, azimuth) - exact[index]) <= bound * largest);
                ++index;
            }
        }
    }
}

TEST_CASE("a lossless half-space disappears in a uniform environment",
          "[render][solved][furnace]") {
    RenderScene scene = sphere_of(scene_of("isotropic:1"));
    scene.lighting.environment = Environment::uniform({1.0});
    RenderOptions options{.width = 16, .height = 16, .samples = 8192, .bounces = 1};
    options.environment_visible = true;
    const auto picture = render_picture(scene, parallel_camera(scene), options);
    for (const float radiance : picture.radiance.values)
        CHECK(std::abs(double(radiance) - 1.0) <= 1e-3);
}

TEST_CASE("a solved sphere under a uniform sky has the solver's spherical albedo",
          "[render][solved]") {
    const Scene layers = scene_of("hg:0.95,0.7", {"hg:0.9,0.46@0.1"});
    RenderScene scene = sphere_of(layers);
    scene.lighting.environment = Environment::uniform({1.0});
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 64, .height = 64, .samples = 256, .bounces = 1});
    const double expected = brdf_of(layers).albedo({1.0}).spherical_albedo[0];
    CHECK(std::abs(disc_mean(picture) - expected) <= 1e-3 * expected);
}

TEST_CASE("a solved sphere in opposition sends back what the solver says", "[render][solved]") {
    // Parallel light from behind the observer: mean radiance 2 int f(mu, mu, 180) mu^2 dmu.
    const Scene layers = under_surface(scene_of("hg:0.8,0.3", {"isotropic:0.5@0.2"}), 0.4, 1.5);
    RenderScene scene = sphere_of(layers);
    scene.lighting.directional = {{kFront, {1.0}}};
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 96, .height = 96, .samples = 64, .bounces = 1});
    const auto rule = math::gauss_legendre(24, 0.0, 1.0);
    const Brdf brdf = brdf_of(layers);
    double expected = 0.0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double mu = rule.nodes[k];
        expected += 2 * rule.weights[k] * mu * mu * support::value_at(brdf, {mu, mu, 180.0});
    }
    CHECK(std::abs(disc_mean(picture) - expected) <= 1e-3 * expected);
}

TEST_CASE("solved materials are reciprocal with the reciprocal coupling", "[render][solved]") {
    Scene scene = under_surface(scene_of("hg:0.95,0.7", {"hg:0.9,0.46@0.1"}), 0.3, 1.5);
    scene.coupling = rte::SurfaceCoupling::reciprocal;
    const SolvedMaterial table = material_of(scene);
    // Single precision of the table.
    for (const double azimuth : {0.0, 75.0, 180.0}) {
        CHECK(value(table, 0.31, 0.87, azimuth) ==
              Approx(value(table, 0.87, 0.31, azimuth)).epsilon(1e-5));
    }
}

TEST_CASE("the surface lobe is the solver's between the nodes of its masking", "[render][solved]") {
    const auto distribution =
        GENERATE(rte::MicrofacetDistribution::beckmann, rte::MicrofacetDistribution::ggx);
    // Six of 49 nodes describe mu / G1(mu), of which a slope parameter of 0.03 asks most: 1.6e-4 at
    // mu = 0.03.
    const double bound = 3e-4;
    const double roughness = GENERATE(0.03, 0.3, 1.5);
    Scene scene = under_surface(scene_of("isotropic:0.5"), roughness, 2.4);
    scene.surface->distribution = distribution;
    const SolvedMaterial table = material_of(scene, BrdfPart::surface);
    const rte::SurfaceLobe lobe({2.4, 0.0}, *scene.surface);
    // Far from the mirror direction a narrow lobe is below the smallest normal number.
    const double underflow = 1e-30 * lobe.brdf(0.6, 0.6, 0.0);
    for (const double mu_in : {1e-4, 0.03, 0.4, 0.9, 1.0}) {
        for (const double azimuth : {0.0, 33.0, 180.0}) {
            CAPTURE(roughness, mu_in, azimuth);
            const double expected = lobe.brdf(mu_in, 0.6, azimuth);
            CHECK(std::abs(value(table, mu_in, 0.6, azimuth) - expected) <=
                  bound * expected + underflow);
        }
    }
}

TEST_CASE("tables of different wavelengths join in order", "[render][solved]") {
    const Scene dark = scene_of("isotropic:0.2"), bright = scene_of("isotropic:0.9");
    const std::vector<BrdfTable> tables = {solve(dark, {620}).table(),
                                           solve(bright, {480, 450}).table()};
    const SolvedMaterial joined(tables);
    REQUIRE(joined.wavelengths() == 3);
    CHECK(joined.table().wavelength_nm() == std::vector{620.0, 480.0, 450.0});
    std::vector<double> values(3);
    joined.evaluate(0.5, 0.5, 0.0, values);
    const double bound = SolvedMaterial::kTolerance;
    CHECK(values[0] == Approx(value(material_of(dark), 0.5, 0.5, 90.0)).epsilon(bound));
    CHECK(values[1] == Approx(value(material_of(bright), 0.5, 0.5, 90.0)).epsilon(bound));
    CHECK(values[2] == values[1]);
}

TEST_CASE("a surface that is not there is no material", "[render][solved][errors]") {
    CHECK_THROWS_AS(material_of(scene_of("isotropic:0.5"), BrdfPart::surface), UsageError);
}
