// Materials of the solver in the renderer: what the table loses, and that pictures show what the
// solver predicts.
#include "pipeline/render/solved_brdf.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <miebrdf/error.h>
#include "pipeline/render/table_nodes.h"
#include "pipeline/solve/brdf.h"
#include "rte/math/quadrature.h"
#include "tests/render/support.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::render;

namespace {

constexpr double kPi = std::numbers::pi;

Request request_of(const std::string& base, const std::vector<std::string>& coats = {}) {
    Request request;
    request.scene.base = parse_medium(base);
    for (const std::string& coat : coats) request.scene.coats.push_back(parse_coat(coat));
    request.wavelength_nm = {550.0};
    return request;
}

Request with_surface(Request request, double roughness, double index) {
    request.scene.surface = rte::SurfaceOptions{};
    request.scene.surface->beckmann_alpha = roughness;
    request.scene.surface_index = {index, 0.0};
    return request;
}

double value(const RenderBrdf& brdf, double mu_in, double mu_out, double azimuth_deg) {
    std::vector<double> values(brdf.wavelengths());
    brdf.evaluate(mu_in, mu_out, std::cos(azimuth_deg * kPi / 180), values);
    return values[0];
}

double disc_mean(const SpectralPicture& picture) { return mean_radiance(picture) * 4 / kPi; }

}  // namespace

TEST_CASE("layers that do not show are not computed for a picture either", "[render][solved]") {
    Request request = request_of("index:1.5,0", {"hg:0.3,0.1@60"});
    request.scene.particles.sizes.effective_radius_um = 1;
    std::size_t media = 0;
    RunControl control{.threads = 1};
    control.progress = [&](const std::string& stage, std::size_t, std::size_t total) {
        if (stage == "single scattering") media = std::max(media, total);
    };
    const auto brdf = solve_brdf({request}, Component::total, {}, control);
    CHECK(media == 1);  // the coat
    CHECK(std::abs(
              value(*brdf, 0.5, 0.6, 40) /
                  value(*solve_brdf({request_of("hg:0.3,0.1")}, Component::total), 0.5, 0.6, 40) -
              1) <= 2e-3);
}

TEST_CASE("the table agrees with the solver between its nodes", "[render][solved]") {
    const Request request =
        GENERATE(request_of("hg:0.95,0.7"), request_of("isotropic:1"),
                 request_of("hg:0.95,0.7", {"hg:0.9,0.46@0.1"}),
                 with_surface(request_of("rayleigh:0.9", {"hg:0.7,0.4@0.3"}), 0.3, 1.5));
    const auto brdf = solve_brdf({request}, Component::total);
    const InterpolationError error = interpolation_error(*brdf, request);
    CAPTURE(describe(request.scene.base), request.scene.coats.size(), error.median, error.largest);
    // Azimuthal orders are summed to a tenth of the tolerance, 1e-4; single precision and cubic
    // interpolation are below that (1.2e-5 measured).
    CHECK(error.largest <= 1e-4);
    CHECK(error.median <= 1e-5);
}

TEST_CASE("the glory of spheres is as narrow and high as the solver says", "[render][solved]") {
    // 2 um, 550 nm: some 2 degrees wide, far narrower than the table's cosines and azimuths.
    Request request = request_of("index:1.5,0.001", {"index:1.8,0.01@0.2"});
    request.scene.particles.sizes.effective_radius_um = 2.0;
    // What the narrow features leave in the table changes within some degrees of azimuth. With the
    // usual table its 33 azimuths are the largest error, 8e-4; with twice as many it is 1.3e-4, the
    // scattering angles' table (the number of cosines does not matter). The solver's tolerance
    // comes on top, because the two solutions choose their streams at different directions.
    const auto [tolerance, azimuths, bound] =
        GENERATE(std::tuple{1e-3, 33, 1e-3 + 1e-3}, std::tuple{1e-4, 33, 1e-3 + 1e-4},
                 std::tuple{1e-4, 65, 1.5e-4 + 1e-4});
    request.solver.tolerance = tolerance;
    const auto brdf = solve_brdf({request}, Component::subsurface, {49, azimuths});
    request.directions = {{0.33, 0.5, 0.77}, {0.33, 0.5, 0.77}, {0, 90, 150, 176, 178, 179, 180}};
    const auto exact = compute_brdf(request).slices.front().total;
    const double largest = *std::max_element(exact.begin(), exact.end());
    std::size_t index = 0;
    for (const double in : request.directions.mu_in) {
        for (const double out : request.directions.mu_out) {
            for (const double azimuth : request.directions.azimuth_deg) {
                CAPTURE(tolerance, azimuths, in, out, azimuth, exact[index], largest);
                CHECK(std::abs(value(*brdf, in, out, azimuth) - exact[index]) <= bound * largest);
                ++index;
            }
        }
    }
}

TEST_CASE("a lossless half-space disappears in a uniform environment",
          "[render][solved][furnace]") {
    RenderScene scene = sphere_scene(solve_brdf({request_of("isotropic:1")}, Component::total));
    scene.lighting.environment = Environment::uniform({1.0});
    RenderOptions options{.width = 16, .height = 16, .samples = 8192, .bounces = 1};
    options.environment_visible = true;
    const auto picture = render_picture(scene, parallel_camera(scene), options);
    for (const float radiance : picture.radiance.values)
        CHECK(std::abs(double(radiance) - 1.0) <= 1e-3);
}

TEST_CASE("a solved sphere under a uniform sky has the solver's spherical albedo",
          "[render][solved]") {
    const Request request = request_of("hg:0.95,0.7", {"hg:0.9,0.46@0.1"});
    RenderScene scene = sphere_scene(solve_brdf({request}, Component::total));
    scene.lighting.environment = Environment::uniform({1.0});
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 64, .height = 64, .samples = 256, .bounces = 1});
    Request albedo = request;
    albedo.directions.mu_in = {1.0};
    const double expected = compute_albedo(albedo).slices.front().spherical_albedo;
    CHECK(std::abs(disc_mean(picture) - expected) <= 1e-3 * expected);
}

TEST_CASE("a solved sphere in opposition sends back what the solver says", "[render][solved]") {
    // Parallel light from behind the observer: mean radiance 2 int f(mu, mu, 180) mu^2 dmu.
    Request request = with_surface(request_of("hg:0.8,0.3", {"isotropic:0.5@0.2"}), 0.4, 1.5);
    RenderScene scene = sphere_scene(solve_brdf({request}, Component::total));
    scene.lighting.directional = {{kFront, {1.0}}};
    const auto picture = render_picture(scene, parallel_camera(scene),
                                        {.width = 96, .height = 96, .samples = 64, .bounces = 1});
    const auto nodes = math::gauss_legendre(24, 0.0, 1.0);
    double expected = 0.0;
    for (std::size_t k = 0; k < nodes.nodes.size(); ++k) {
        const double mu = nodes.nodes[k];
        request.directions = {{mu}, {mu}, {180.0}};
        expected +=
            2 * nodes.weights[k] * mu * mu * compute_brdf(request).slices.front().total.front();
    }
    CHECK(std::abs(disc_mean(picture) - expected) <= 1e-3 * expected);
}

TEST_CASE("solved materials are reciprocal with the reciprocal coupling", "[render][solved]") {
    Request request = with_surface(request_of("hg:0.95,0.7", {"hg:0.9,0.46@0.1"}), 0.3, 1.5);
    request.scene.coupling = rte::SurfaceCoupling::reciprocal;
    const auto brdf = solve_brdf({request}, Component::total);
    // Single precision of the table.
    for (const double azimuth : {0.0, 75.0, 180.0}) {
        CHECK(value(*brdf, 0.31, 0.87, azimuth) ==
              Approx(value(*brdf, 0.87, 0.31, azimuth)).epsilon(1e-5));
    }
}

TEST_CASE("the surface lobe is the solver's to rounding", "[render][solved]") {
    // Beckmann's masking of the light is interpolated in single precision, GGX's is not.
    const auto [distribution, bound] =
        GENERATE(std::pair{rte::MicrofacetDistribution::beckmann, 2e-7},
                 std::pair{rte::MicrofacetDistribution::ggx, 1e-10});
    const double roughness = GENERATE(0.03, 0.3, 1.5);
    Request request = with_surface(request_of("isotropic:0.5"), roughness, 2.4);
    request.scene.surface->distribution = distribution;
    const auto brdf = solve_brdf({request}, Component::surface);
    const rte::SurfaceLobe lobe({2.4, 0.0}, *request.scene.surface);
    for (const double mu_in : {1e-4, 0.03, 0.4, 0.9, 1.0}) {
        for (const double azimuth : {0.0, 33.0, 180.0}) {
            CAPTURE(roughness, mu_in, azimuth);
            CHECK(value(*brdf, mu_in, 0.6, azimuth) ==
                  Approx(lobe.brdf(mu_in, 0.6, azimuth)).epsilon(bound));
        }
    }
}

TEST_CASE("nodes are where their taps are looked for", "[render][solved]") {
    const auto is_at = [](const CubicTaps& taps, std::size_t node) {
        const std::size_t k = node - taps.first;
        // Single precision, and next to an end the root of a rounding error.
        return k < 4 && std::abs(double(taps.weight[k]) - 1.0) <= 1e-5;
    };
    const auto mu = cosine_nodes(49), azimuth = azimuth_nodes_deg(33),
               angle = scattering_angle_nodes(1025);
    // The first cosine only stands for the horizon.
    for (std::size_t i = 1; i < mu.size(); ++i) CHECK(is_at(cosine_taps(mu[i], 49), i));
    for (std::size_t i = 0; i < azimuth.size(); ++i)
        CHECK(is_at(azimuth_taps(std::cos(azimuth[i] * kPi / 180), 33), i));
    for (std::size_t i = 0; i < angle.size(); ++i)
        CHECK(is_at(scattering_angle_taps(std::cos(angle[i]), 1025), i));
}

TEST_CASE("requests of different wavelengths join in order", "[render][solved]") {
    Request first = request_of("isotropic:0.2"), second = request_of("isotropic:0.9");
    first.wavelength_nm = {620.0};
    second.wavelength_nm = {480.0};
    const auto brdf = solve_brdf({first, second}, Component::total);
    REQUIRE(brdf->wavelengths() == 2);
    CHECK(brdf->wavelength_nm() == std::vector{620.0, 480.0});
    std::vector<double> values(2);
    brdf->evaluate(0.5, 0.5, 0.0, values);
    CHECK(values[0] == Approx(value(*solve_brdf({first}, Component::total), 0.5, 0.5, 90.0)));
    CHECK(values[1] == Approx(value(*solve_brdf({second}, Component::total), 0.5, 0.5, 90.0)));
}

TEST_CASE("solving for a picture refuses what it cannot show", "[render][solved][errors]") {
    CHECK_THROWS_WITH(solve_brdf({request_of("isotropic:0.5")}, Component::surface),
                      Catch::Contains("--roughness"));
    CHECK_THROWS_AS(solve_brdf({request_of("isotropic:0.5")}, Component::total, {3, 33}),
                    UsageError);
    CHECK_THROWS_AS(solve_brdf({}, Component::total), UsageError);
}
