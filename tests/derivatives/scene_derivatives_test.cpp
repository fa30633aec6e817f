// Derivatives of what a scene is asked for, against differences of it.
#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include <miebrdf/value_derivatives.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

/// Nodes are given and equations solved far below what is compared.
SolverOptions fixed_nodes() {
    SolverOptions options;
    options.tolerance = 1e-10;
    options.streams = 12;
    return options;
}

Brdf solved(const Scene& scene, const std::string& name, double value) {
    return solve(with_values(scene, {{name, value}}), {550}, fixed_nodes());
}

/// The central difference, to fourth order in the step.
template <typename Ask>
double difference(const Scene& scene, const NamedNumber& number, const Ask& ask) {
    const double h = 1e-3 * number.value;
    const auto at = [&](double steps) {
        return ask(solved(scene, number.name, number.value + steps * h));
    };
    return (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h);
}

Scene half_space() {
    Scene scene;
    say(scene, "base", {"hg:{w=0.9},{g=0.6}"});
    say(scene, "coat", {"isotropic:{a=0.97}@{tau=0.5}"});
    return scene;
}

Scene named_asymmetry(double g) {
    Scene scene;
    say(scene, "base", {"hg:0.93,{g=" + std::to_string(g) + "}"});
    return scene;
}

Scene film() {
    Scene scene;
    say(scene, "substrate", {"lambert:{ground=0.3}"});
    say(scene, "coat", {"hg:{w=0.9},{g=0.6}@{tau=2}"});
    return scene;
}

}  // namespace

TEST_CASE("derivatives of albedos are those of the values", "[derivatives]") {
    const Scene scene = GENERATE(half_space(), film());
    const std::vector<double> mu_in = {0.3, 1.0};
    const std::vector<NamedNumber> numbers = named_numbers(scene);
    std::vector<std::string> names;
    for (const NamedNumber& number : numbers) names.push_back(number.name);
    const auto all = solve(scene, {550}, fixed_nodes()).derivatives(names).albedo(mu_in);
    REQUIRE(all.parameters == names);
    REQUIRE(all.derivatives.size() == names.size());
    double largest = 0.0;
    for (std::size_t p = 0; p < numbers.size(); ++p)
        largest = std::max(largest, std::abs(numbers[p].value * all.derivatives[p].at(0, 0)));
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        CAPTURE(describe(scene), names[p]);
        const auto within = [&](double derivative, double truth) {
            CAPTURE(derivative, truth);
            CHECK(std::abs(numbers[p].value * (derivative - truth)) <= 1e-6 * largest);
        };
        const AlbedoValues& derivative = all.derivatives[p];
        within(derivative.at(0, 0), difference(scene, numbers[p], [&](const Brdf& brdf) {
                   return brdf.albedo(mu_in).at(0, 0);
               }));
        within(derivative.spherical_albedo[0], difference(scene, numbers[p], [&](const Brdf& brdf) {
                   return brdf.albedo(mu_in).spherical_albedo[0];
               }));
        if (!scene.substrate) continue;
        within(derivative.plane_transmittance[0][1],
               difference(scene, numbers[p], [&](const Brdf& brdf) {
                   return brdf.albedo(mu_in).plane_transmittance[0][1];
               }));
    }
}

TEST_CASE("derivatives of a BRDF are those of the values", "[derivatives]") {
    Scene scene = GENERATE(half_space(), film());
    const bool has_lobe = GENERATE(false, true);
    if (has_lobe) {
        say(scene, "roughness", {"{m=0.3}"});
        say(scene, "surface-index", {"{n=1.5},0"});
    }
    const Directions directions{{0.3, 1.0}, {0.2, 0.9}, {0.0, 70.0, 180.0}};
    const std::vector<NamedNumber> numbers = named_numbers(scene);
    std::vector<std::string> names;
    for (const NamedNumber& number : numbers) names.push_back(number.name);
    const auto all = solve(scene, {550}, fixed_nodes()).derivatives(names).evaluate(directions);
    double largest = 0.0;
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        for (const double one : all.derivatives[p].slices[0].total)
            largest = std::max(largest, std::abs(numbers[p].value * one));
    }
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        for (const std::size_t azimuth : {0u, 1u, 2u}) {
            const double derivative = all.derivatives[p].at(0, 0, 1, azimuth);
            const double truth = difference(scene, numbers[p], [&](const Brdf& brdf) {
                return brdf.evaluate(directions).at(0, 0, 1, azimuth);
            });
            CAPTURE(describe(scene), names[p], azimuth, derivative, truth);
            CHECK(std::abs(numbers[p].value * (derivative - truth)) <= 1e-6 * largest);
        }
    }
}

TEST_CASE("derivatives under a sky of sun and diffuse light are those of the values",
          "[derivatives][hdrf]") {
    const Scene scene = half_space();
    const Directions directions{{0.3}, {0.2, 0.9}, {70.0}};
    for (const double share : {0.0, 0.3, 1.0}) {
        const auto all =
            hdrf_derivatives(solve(scene, {550}, fixed_nodes()), {"w", "tau"}, directions, share);
        CHECK(all.values.hdrf == solve(scene, {550}, fixed_nodes()).hdrf(directions, share).hdrf);
        for (std::size_t p = 0; p < 2; ++p) {
            const NamedNumber number{all.parameters[p], p == 0 ? 0.9 : 0.5};
            for (const std::size_t i : {0u, 1u}) {
                const double derivative = all.derivatives[p].hdrf[0][i];
                const double truth = difference(scene, number, [&](const Brdf& brdf) {
                    return brdf.hdrf(directions, share).hdrf[0][i];
                });
                CAPTURE(share, number.name, i, derivative, truth);
                CHECK(std::abs(derivative - truth) <= 1e-6 * std::max(1.0, std::abs(truth)));
            }
        }
    }
    CHECK_THROWS_WITH(hdrf_derivatives(solve(scene, {550}), {"w"}, directions, 1.2),
                      Catch::Contains("diffuse_fraction"));
}

TEST_CASE("derivatives of colours are those of the colours", "[derivatives][colour]") {
    const std::vector<double> nm = {400, 440, 480, 520, 560, 600, 640, 680};
    // The second is dark: below the cube root of Lab and the power of sRGB.
    const double scale = GENERATE(1.0, 1e-3);
    std::vector<double> reflectance, slope;
    for (const double one : nm) {
        reflectance.push_back(scale * (0.3 + 0.2 * std::sin(one / 60)));
        slope.push_back(scale * std::cos(one / 45));
    }
    const Colorimeter colorimeter(nm, Viewing(Illuminant::d50, Observer::ten_degrees));
    const auto list = [](const Xyz& xyz, const Lab& lab, const Lch& lch, const LinearSrgb& linear,
                         const LinearSrgb& encoded) {
        return std::vector<double>{xyz.x,       xyz.y,         xyz.z,        lab.l,
                                   lab.a,       lab.b,         lch.l,        lch.c,
                                   lch.h_deg,   linear.red,    linear.green, linear.blue,
                                   encoded.red, encoded.green, encoded.blue};
    };
    const auto at = [&](double x) {
        std::vector<double> moved = reflectance;
        for (std::size_t k = 0; k < moved.size(); ++k) moved[k] += x * slope[k];
        const auto& [xyz, lab, lch, rgb, error] = colorimeter(moved);
        return list(xyz, lab, lch, rgb,
                    {encode_srgb(rgb.red), encode_srgb(rgb.green), encode_srgb(rgb.blue)});
    };
    const auto& [xyz, lab, lch, linear, encoded] =
        derivative_of_colour(colorimeter, reflectance, slope);
    const std::vector<double> found = list(xyz, lab, lch, linear, encoded);
    constexpr double h = 1e-4;
    const std::vector<double> plus = at(h), minus = at(-h);
    for (std::size_t k = 0; k < found.size(); ++k) {
        const double truth = (plus[k] - minus[k]) / (2 * h);
        CAPTURE(scale, k, found[k], truth);
        CHECK(std::abs(found[k] - truth) <= 1e-5 * std::abs(truth));
    }
}

TEST_CASE("wavelengths of the same optics share their derivatives", "[derivatives]") {
    Scene scene;
    say(scene, "base", {"hg:{w=0.9},{g=0.6}"});
    const bool is_grey = GENERATE(true, false);
    // A depth at one wavelength follows the extinction of its medium: that of droplets is not grey.
    say(scene, "coat",
        {is_grey ? "isotropic:{a=0.97}@{tau=0.5}" : "water,radius=0.5@{tau=0.5}[500nm]"});
    std::size_t solved_times = 0;
    Control control;
    control.progress = [&](const std::string& stage, std::size_t, std::size_t total) {
        if (stage == "derivatives") solved_times = total;
    };
    const std::vector<double> mu_in = {0.3, 1.0};
    const auto all =
        solve(scene, {500, 600, 700}, {}, control).derivatives({"w", "tau"}).albedo(mu_in);
    CHECK(solved_times == (is_grey ? 1u : 3u));
    for (std::size_t w = 0; w < 3; ++w) {
        const double nm = 500 + 100 * double(w);
        const auto alone = solve(scene, {nm}).derivatives({"w", "tau"}).albedo(mu_in);
        for (std::size_t p = 0; p < 2; ++p) {
            CHECK(all.derivatives[p].plane_albedo[w] == alone.derivatives[p].plane_albedo[0]);
            CHECK(all.derivatives[p].spherical_albedo[w] ==
                  alone.derivatives[p].spherical_albedo[0]);
        }
    }
}

TEST_CASE("derivatives that have no bound are refused", "[derivatives][errors]") {
    Scene scene;
    say(scene, "base", {"hg:{w=1},{g=0.6}"});
    const Brdf brdf = solve(scene, {550});
    CHECK_THROWS_WITH(brdf.derivatives({"w"}).albedo({1.0}), Catch::Contains("log1m"));
    CHECK_THROWS_WITH(brdf.derivatives({"x"}), Catch::Contains("it has w, g"));
    CHECK_THROWS_WITH(brdf.derivatives({"n(TiO2)"}), Catch::Contains("no material or host"));
    // It stays white whatever its asymmetry.
    CHECK(std::abs(brdf.derivatives({"g"}).albedo({1.0}).derivatives[0].at(0, 0)) <= 1e-6);
}

TEST_CASE("a number that is 0 has a derivative, though nothing of it is in the scene",
          "[derivatives]") {
    const std::vector<double> mu_in = {0.2, 1.0};
    const Directions directions{{0.2}, {0.5}, {30.0}};
    const auto at = [](double g) { return solve(named_asymmetry(g), {550}, fixed_nodes()); };
    constexpr double h = 1e-3;
    const auto albedo = at(0).derivatives({"g"}).albedo(mu_in);
    const auto values = at(0).derivatives({"g"}).evaluate(directions);
    // The third derivative is of the order of the value.
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        const double slope =
            (at(h).albedo(mu_in).plane_albedo[0][i] - at(-h).albedo(mu_in).plane_albedo[0][i]) /
            (2 * h);
        CHECK(std::abs(albedo.derivatives[0].plane_albedo[0][i] - slope) <= h * h);
    }
    const double slope =
        (at(h).evaluate(directions).at(0, 0, 0, 0) - at(-h).evaluate(directions).at(0, 0, 0, 0)) /
        (2 * h);
    CHECK(std::abs(values.derivatives[0].at(0, 0, 0, 0) - slope) <= h * h);
}

TEST_CASE("what is not there has no derivative", "[derivatives][errors]") {
    Scene scene;
    say(scene, "base", {"hg:0.9,0.5"});
    say(scene, "coat", {"isotropic:0.8@{tau=0}"});
    CHECK_THROWS_WITH(solve(scene, {550}).derivatives({"tau"}), Catch::Contains("above 0"));
}

TEST_CASE("what is no number to vary is refused in its words", "[derivatives][errors]") {
    Scene scene;
    say(scene, "base", {"hg:{w=0.9},0.5"});
    say(scene, "roughness", {"{m=0}"});
    say(scene, "surface-index", {"1.5,0"});
    const Brdf brdf = solve(scene, {550});
    CHECK_THROWS_WITH(brdf.derivatives({"m"}), Catch::Contains("'m' at 0"));
    CHECK_THROWS_WITH(brdf.derivatives({"w", "w"}), Catch::Contains("twice"));
    CHECK_THROWS_WITH(brdf.derivatives({"n()"}), Catch::Contains("no material or host"));
}

TEST_CASE("a host's index has its derivative beside another host of nearly the same",
          "[derivatives]") {
    // Central differences by 1e-4 and 1e-5 at a tolerance of 1e-9, which agree to 2e-5.
    const auto [index, truth] = GENERATE(table<const char*, double>({{"1.49", .06150},
                                                                     {"1.499", .06271},
                                                                     {"1.4999", .06294},
                                                                     {"1.5", .06298},
                                                                     {"1.5001", .06301},
                                                                     {"1.501", .06324},
                                                                     {"1.503", .06358},
                                                                     {"1.51", .06420}}));
    const double tolerance = GENERATE(1e-2, 1e-3);
    Scene scene;
    say(scene, "substrate", {"lambert:.5"});
    say(scene, "coat",
        {"hg:.9,.5 in index:1.5@1", "hg:.9,.5 in index:{a=" + std::string(index) + "}@1"});
    say(scene, "boundary", {"smooth"});
    const Brdf brdf = solve(scene, {550}, {.tolerance = tolerance});
    CAPTURE(index, tolerance);
    CHECK(std::abs(brdf.derivatives({"a"}).albedo({0.3}).derivatives[0].at(0, 0) - truth) <=
          0.01 * truth);
}

TEST_CASE("a host's index has its derivative at that of air, upwards", "[derivatives]") {
    // Differences of values at a tolerance of 1e-9, between 1 and 1.00001, 1.00001 and 1.00003.
    const auto [index, truth] =
        GENERATE(table<const char*, double>({{"1", -2.2765}, {"1.00001", -2.2865}}));
    Scene scene;
    say(scene, "base", {"hg:.9,.5 in index:{n=" + std::string(index) + "}"});
    say(scene, "boundary", {"smooth"});
    const Brdf brdf = solve(scene, {550}, {.tolerance = 1e-2});
    CAPTURE(index);
    CHECK(std::abs(brdf.derivatives({"n"}).albedo({0.3}).derivatives[0].at(0, 0) / truth - 1) <=
          0.01);
}

TEST_CASE("a coating that is not there yet has its derivative", "[derivatives][mie]") {
    // One-sided differences of second order, by .01 nm at a tolerance of 1e-7.
    const auto [law, truth] = GENERATE(table<const char*, double>(
        {{"gamma", 1.23501e-3}, {"log-normal", 1.33114e-3}, {"power-law", 1.29769e-3}}));
    Scene scene;
    say(scene, "base",
        {"index:2.5,.01,radius=.1,variance=.1,distribution=" + std::string(law) +
         ",coating=index:1.5,0@{c=0}nm"});
    const auto all = solve(scene, {550}).derivatives({"c"}).albedo({1});
    CAPTURE(law);
    CHECK(std::abs(all.derivatives[0].at(0, 0) / truth - 1) <= 0.005);
}

TEST_CASE("BRDFs change as they do by a coating that is not there yet", "[derivatives][mie]") {
    // Differences of values at a tolerance of 1e-7 between coatings of .0001 and .02 nm. Moments of
    // so small spheres end in rounding.
    Scene scene;
    say(scene, "substrate", {"black"});
    say(scene, "coat",
        {"index:2.04,.08662,radius=.0874,variance=.1,distribution=power-law,"
         "coating=index:1.458,0@{c=0}nm@1"});
    const auto all = solve(scene, {550}, {.stokes = 1})
                         .derivatives({"c"})
                         .evaluate({{0.8}, {0.6}, {0.0, 90.0, 180.0}});
    const std::vector<double> truth = {4.061e-4, 3.931e-4, 3.908e-4};
    for (std::size_t a = 0; a < truth.size(); ++a) {
        CAPTURE(a);
        CHECK(std::abs(all.derivatives[0].at(0, 0, 0, a) / truth[a] - 1) <= 0.002);
    }
}

TEST_CASE("slopes of averages see resonances that values need not", "[derivatives][mie]") {
    // Differences of values at a tolerance of 1e-8, by .1, .3 and 1 %, agree to 1e-3.
    const auto [medium, truth] = GENERATE(table<const char*, double>(
        {{"index:{a=2.287},0.001558,radius=0.5182,variance=0.084,distribution=gamma", .02574},
         {"index:2.47,0.000643,radius=0.85,variance={a=.15},distribution=gamma", .04718}}));
    Scene scene;
    say(scene, "base", {medium});
    const auto all = solve(scene, {550}).derivatives({"a"}).albedo({0.5});
    CAPTURE(medium);
    CHECK(std::abs(all.derivatives[0].at(0, 0) / truth - 1) <= 0.01);
}

TEST_CASE("ends of a power law have the spheres that lie there", "[derivatives][mie]") {
    // Differences of values at a tolerance of 1e-7, by .2, .5 and 1 %, agree to 1e-3.
    const auto [medium, truth] = GENERATE(table<const char*, double>(
        {{"index:1.5,.05,radius=.5,variance={a=.05},distribution=power-law", .013642},
         {"index:2.7,.05,radius=.5,variance={a=.05},distribution=power-law", .21095},
         {"index:1.33,.01,radius=.5,variance={a=.05},distribution=power-law", -.072395}}));
    Scene scene;
    say(scene, "base", {medium});
    const auto all = solve(scene, {550}).derivatives({"a"}).albedo({0.5});
    CAPTURE(medium);
    CHECK(std::abs(all.derivatives[0].at(0, 0) / truth - 1) <= 2e-3);
}
