// Films over two grounds, reflectance under a sky: against closed forms and second methods.
#include <miebrdf/colour.h>
#include <miebrdf/error.h>

#include <cmath>
#include <limits>

#include "rte/math/quadrature.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace miebrdf;
using support::scene_of;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> visible() {
    std::vector<double> list;
    for (int nm = 400; nm <= 700; nm += 30) list.push_back(nm);
    return list;
}

Scene film_of(const std::string& words) {
    Scene film;
    film.layers = {layer(words)};
    return film;
}

const char* const kPaint =
    "index:2.6,1e-4,radius=0.13,distribution=gamma,volume=15% in index:1.5@12um";

/// Integral of the BRDF times mu over all incidences at one mu_out.
double from_all_sides(const Brdf& brdf, double mu_out, int nodes, int azimuths) {
    const auto rule = math::gauss_legendre(nodes, 0.0, 1.0);
    Directions directions{{rule.nodes.begin(), rule.nodes.end()}, {mu_out}, {}};
    for (int a = 0; a < azimuths; ++a) directions.azimuth_deg.push_back((a + 0.5) * 180 / azimuths);
    const BrdfValues values = brdf.evaluate(directions);
    double sum = 0;
    for (int i = 0; i < nodes; ++i) {
        for (int a = 0; a < azimuths; ++a) {
            sum += rule.weights[i] * rule.nodes[i] *
                   values.at(0, std::size_t(i), 0, std::size_t(a)) * 2 * M_PI / azimuths;
        }
    }
    return sum;
}

}  // namespace

TEST_CASE("a Lambertian ground has its albedo under every sky", "[pipeline][hdrf]") {
    Scene bare = film_of("isotropic:0@1e-13");
    bare.substrate = substrate("lambert:0.37");
    for (const double share : {0.0, 0.3, 1.0}) {
        const HdrfValues values = solve(bare, {550}).hdrf(support::few_directions(), share);
        for (const double value : values.hdrf[0]) CHECK(std::abs(value - 0.37) <= 1e-12);
        CHECK(values.converged());
        CHECK(std::abs(solve(bare, {550}).albedo({0.4}).under_sky(0, 0, share) - 0.37) <= 1e-12);
    }
}

TEST_CASE("under a uniform sky the factor is the integral of the BRDF over all incidences",
          "[pipeline][hdrf]") {
    const Brdf brdf =
        solve(scene_of("hg:0.95,0.6", {"hg:0.8,0.3@0.5"}), {550}, {.tolerance = 1e-5});
    for (const double mu_out : {0.2, 0.7, 1.0}) {
        const HdrfValues values = brdf.hdrf({{0.5}, {mu_out}, {30}}, 1.0);
        // 40 nodes leave 1e-6 of the peak at grazing incidence.
        CHECK(std::abs(values.hdrf[0][0] - from_all_sides(brdf, mu_out, 40, 32)) <= 2e-5);
    }
}

TEST_CASE("a rough surface with reciprocal coupling does so too", "[pipeline][hdrf]") {
    Scene scene = support::under_surface(scene_of("hg:0.9,0.5"), 0.4, 1.5);
    scene.coupling = rte::SurfaceCoupling::reciprocal;
    const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-4});
    const HdrfValues values = brdf.hdrf({{0.5}, {0.8}, {0}}, 1.0);
    CHECK(std::abs(values.hdrf[0][0] - from_all_sides(brdf, 0.8, 60, 60)) <= 1e-3);
    scene.coupling = rte::SurfaceCoupling::paper;
    CHECK_THROWS_WITH(solve(scene, {550}).hdrf({{0.5}, {0.8}, {0}}, 0.2),
                      Catch::Contains("reciprocal"));
    CHECK(solve(scene, {550}).hdrf({{0.5}, {0.8}, {0}}, 0.0).hdrf[0][0] > 0);
}

TEST_CASE("sun and sky are mixed by their shares of the flux", "[pipeline][hdrf]") {
    const Brdf brdf = solve(scene_of("hg:0.9,0.7"), {550});
    const Directions directions{{0.3, 1.0}, {0.2, 0.9}, {0.0, 70.0, 180.0}};
    const auto sun = brdf.hdrf(directions, 0.0), sky = brdf.hdrf(directions, 1.0),
               both = brdf.hdrf(directions, 0.25);
    const BrdfValues brdfs = brdf.evaluate(directions);
    const AlbedoValues albedos = brdf.albedo(directions.mu_out);
    for (std::size_t i = 0; i < both.hdrf[0].size(); ++i) {
        CHECK(sun.hdrf[0][i] == M_PI * brdfs.slices[0].total[i]);
        CHECK(sky.hdrf[0][i] == albedos.at(0, i / 3 % 2));
        CHECK(std::abs(both.hdrf[0][i] - 0.75 * sun.hdrf[0][i] - 0.25 * sky.hdrf[0][i]) <= 1e-15);
    }
    CHECK(std::abs(albedos.under_sky(0, 1, 0.25) - 0.75 * albedos.at(0, 1) -
                   0.25 * albedos.spherical_albedo[0]) <= 1e-15);
}

TEST_CASE("shares of diffuse light outside [0, 1] are refused", "[pipeline][hdrf][errors]") {
    const Brdf brdf = solve(scene_of("hg:0.9,0.7"), {550});
    for (const double wrong : {-0.1, 1.2, kNan}) {
        CHECK_THROWS_WITH(brdf.hdrf({{0.5}, {0.5}, {0}}, wrong), Catch::Contains("[0, 1]"));
        CHECK_THROWS_AS(brdf.albedo({0.5}).under_sky(0, 0, wrong), UsageError);
    }
    CHECK_THROWS_WITH(brdf.hdrf({{0.0}, {0.5}, {0}}, 1.0), Catch::Contains("mu_in"));
}

TEST_CASE("a film over a Lambertian ground is its black-backed self and what returns through it",
          "[pipeline][drawdown]") {
    // R_G = R_0 + G T t / (1 - G r): T through the film from mu_in, t of uniform light, r of its
    // own underside, which for one layer is that of its upper side.
    const Drawdown result = draw_down(film_of(kPaint), visible(), {0.4, 1.0});
    const double ground = kWhiteChartAlbedo;
    for (std::size_t w = 0; w < visible().size(); ++w) {
        const double r = result.over_dark.spherical_albedo[w];
        const double t = result.over_dark.spherical_transmittance[w];
        for (std::size_t i = 0; i < 2; ++i) {
            const double through = result.over_dark.plane_transmittance[w][i];
            const double truth =
                result.over_dark.at(w, i) + ground * through * t / (1 - ground * r);
            // Streams are chosen anew over each ground.
            CHECK(std::abs(result.over_light.at(w, i) - truth) <= 1e-5);
        }
    }
}

TEST_CASE("at the depth that hides the contrast ratio is what was asked for",
          "[pipeline][drawdown]") {
    DrawdownOptions options;
    options.hiding_contrast_ratio = GENERATE(0.9, 0.98, 0.995);
    options.viewing = viewing("d65,10");
    const Drawdown result = draw_down(film_of(kPaint), visible(), {1.0}, options);
    for (std::size_t light = 0; light < 2; ++light) {
        const Hiding& hiding = result.hiding[light];
        REQUIRE(hiding.relative_depth);
        CHECK(*hiding.thickness_um == Approx(12 * *hiding.relative_depth).epsilon(1e-14));
        CHECK(*hiding.spreading_rate_m2_per_l == Approx(1000 / *hiding.thickness_um));
        // Asked anew, by other functions.
        Scene film = film_of(kPaint);
        film.layers[0].depth.value = *hiding.thickness_um;
        const auto y_over = [&](const Substrate& ground) {
            film.substrate = ground;
            const AlbedoValues values = solve(film, visible()).albedo({1.0});
            std::vector<double> spectrum;
            for (std::size_t w = 0; w < visible().size(); ++w)
                spectrum.push_back(light == 0 ? values.at(w, 0) : values.spherical_albedo[w]);
            return Colorimeter(visible(), options.viewing)(spectrum).xyz.y;
        };
        const double ratio = y_over(substrate("black")) / y_over(substrate("lambert:0.8"));
        // A part in 1e4 of the depth is less than that of 1 - ratio.
        CHECK(std::abs(ratio - options.hiding_contrast_ratio) <=
              3e-4 * (1 - options.hiding_contrast_ratio));
    }
}

TEST_CASE("white paint hides in diffuse light where Kubelka and Munk say", "[pipeline][drawdown]") {
    // Without absorption R_0 = S h / (1 + S h), R_G = ((1 - G) S h + G) / ((1 - G) S h + 1); the
    // S h at which their ratio is 0.98, by bisection.
    const std::string paint =
        "index:2.75,0,radius=0.13,distribution=gamma,volume=15% in index:1.5@40um";
    std::vector<double> one_colour = visible();
    const Drawdown result = draw_down(film_of(paint), one_colour, {1.0});
    double low = 0.1, high = 1e3;
    while (high - low > 1e-9) {
        const double x = 0.5 * (low + high), over_black = x / (1 + x);
        const double over_white = (0.2 * x + 0.8) / (0.2 * x + 1);
        (over_black / over_white < 0.98 ? low : high) = x;
    }
    // S differs over the visible; its value at 560 nm, where Y weighs most, stands for all.
    const auto layers = solve(
                            [&] {
                                Scene film = film_of(paint);
                                film.substrate = substrate("black");
                                return film;
                            }(),
                            {560})
                            .layers();
    CHECK(std::abs(*result.hiding[1].thickness_um * *layers[0].s_km / low - 1) <= 0.05);
    CHECK(result.hiding[0].contrast_ratio < result.hiding[1].contrast_ratio);
}

TEST_CASE("drawdowns that make no sense are refused", "[pipeline][drawdown][errors]") {
    const Scene film = film_of(kPaint);
    DrawdownOptions options;
    std::swap(options.dark, options.light);
    CHECK_THROWS_WITH(draw_down(film, visible(), {1.0}, options), Catch::Contains("lighter"));
    options = {};
    for (const double wrong : {1.0, -2.0, kNan}) {
        options.hiding_contrast_ratio = wrong;
        CHECK_THROWS_WITH(draw_down(film, visible(), {1.0}, options), Catch::Contains("[0, 1)"));
    }
    CHECK_THROWS_WITH(draw_down(film, {450, 550}, {1.0}), Catch::Contains("eight wavelengths"));
    CHECK_THROWS_WITH(draw_down(film, visible(), {0.0}), Catch::Contains("mu_in"));
    CHECK_THROWS_WITH(draw_down({}, visible(), {1.0}), Catch::Contains("layer"));
    CHECK_THROWS_WITH(draw_down(film_of("hg:0.9,0.5@0"), visible(), {1.0}),
                      Catch::Contains("depth"));
}

TEST_CASE("a film that only absorbs hides at no depth", "[pipeline][drawdown]") {
    const Drawdown result = draw_down(film_of("isotropic:0@1"), visible(), {1.0});
    for (const Hiding& hiding : result.hiding) {
        CHECK(hiding.y_over_light > 0.03);
        CHECK(std::abs(hiding.contrast_ratio) <= 1e-12);
        CHECK(!hiding.relative_depth);
    }
}
