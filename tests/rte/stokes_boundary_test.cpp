// Polarised light under smooth boundaries and over mirrors: against photons that carry their field,
// closed forms and what must be so.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "rte/boundary/fresnel_matrix.h"
#include "rte/first_order/meridian_planes.h"
#include "rte/grid/refraction_grid.h"
#include "rte/phase/polarisation.h"
#include "rte/stack/layered_reflection.h"
#include "tests/rte/jones_photons.h"
#include "tests/rte/stokes_media.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::difference;
using support::element;
using support::many_directions;
using support::siewert_optics;

namespace {

const std::complex<double> kGold{0.35, 2.45};  // turns much of U into V

rte::Stack glazed(const rte::Optics& optics, double index) {
    rte::Stack stack{.base = optics};
    stack.base_index = index;
    stack.boundary = rte::Boundary{};
    return stack;
}

rte::Stack glazed_film(const rte::Optics& optics, double depth, double index) {
    rte::Stack stack;
    stack.base_kind = rte::BaseKind::none;
    stack.base_index = index;
    stack.coats = {{optics, depth, index}};
    stack.boundary = rte::Boundary{};
    return stack;
}

rte::Stack on_mirror(rte::Stack stack, std::complex<double> index) {
    stack.base_kind = rte::BaseKind::mirror;
    stack.mirror_index = index;
    return stack;
}

// Three hosts, the densest in the middle, on a half-space of a fourth.
rte::Stack several_hosts() {
    rte::Stack stack = glazed(rte::rayleigh_optics(0.97), 1.33);
    stack.coats = {{siewert_optics(false), 0.4, 1.7}, {rte::rayleigh_optics(0.9, 0.03), 0.3, 1.5}};
    return stack;
}

}  // namespace

TEST_CASE("photons that carry their field see the same Mueller matrices", "[rte][stokes]") {
    const struct {
        const char* name;
        support::PhotonScene scene;
        int components;
    } scenes[] = {
        {"half-space", {.index = 1.5, .albedo = 0.95}, 4},
        {"film on a Lambertian ground",
         {.index = 1.33, .albedo = 0.98, .depth = 1.0, .ground_albedo = 0.7},
         3},
        {"film on gold", {.index = 1.5, .albedo = 0.98, .depth = 0.5, .mirror = kGold}, 4},
    };
    for (const auto& [name, scene, components] : scenes) {
        rte::Stack stack = glazed(rte::rayleigh_optics(scene.albedo), scene.index);
        if (std::isfinite(scene.depth))
            stack = glazed_film(rte::rayleigh_optics(scene.albedo), scene.depth, scene.index);
        if (scene.ground_albedo > 0.0) stack.base_kind = rte::BaseKind::lambertian;
        stack.ground_albedo = scene.ground_albedo;
        if (scene.mirror != 0.0) stack = on_mirror(stack, scene.mirror);
        const rte::Directions one{{0.6}, {0.35}, {70.0}};
        const auto table =
            rte::reflect_polarised(stack, one, components, {.tolerance = 1e-6, .streams = 24});
        support::JonesPhotons photons(scene, 20240917);
        const auto traced = photons.reflect(0.6, 0.35, 70.0, 12000);
        CAPTURE(name);
        double chi2 = 0.0;
        for (int row = 0; row < components; ++row) {
            for (int column = 0; column < components; ++column) {
                CAPTURE(row, column, traced.mean(row, column), traced.error(row, column));
                const double value = element(table, one, 0, 0, 0, row, column);
                CAPTURE(value);
                const double z = (value - traced.mean(row, column)) / traced.error(row, column);
                chi2 += z * z / (components * components);
                CHECK(std::abs(z) <= 4.5);
            }
        }
        CHECK(chi2 <= 9.0);  // one photon counts in all elements: no 16 independent ones
        CHECK(traced.error(0, 0) <= 0.02 * traced.mean(0, 0));
    }
}

TEST_CASE("a boundary without contrast is none for polarised light", "[rte][stokes]") {
    const rte::Directions directions = many_directions();
    const rte::SolverOptions options{.tolerance = 1e-8, .streams = 16};
    rte::Stack open{.base = rte::rayleigh_optics(0.95), .coats = {{siewert_optics(false), 0.5}}};
    rte::Stack glass = open;
    glass.boundary = rte::Boundary{};
    const auto expected = rte::reflect_polarised(open, directions, 3, options);
    const auto same = rte::reflect_polarised(glass, directions, 3, options);
    CHECK(difference(expected, same) <= 1e-14);
    CHECK(same.mirror_reflectance.empty());
    // A weak one changes what leaves in proportion to n - 1, but for grazing directions.
    rte::Directions steep = directions;
    steep.mu_in = steep.mu_out = {0.37, 0.8, 1.0};
    const auto behind = [&](double index) {
        glass.base_index = glass.coats[0].index = index;
        return rte::reflect_polarised(glass, steep, 3, options);
    };
    rte::ReflectionTable extrapolated = behind(1.002);
    const auto twice = behind(1.004);
    for (std::size_t k = 0; k < twice.reflection.size(); ++k)
        extrapolated.reflection[k] += extrapolated.reflection[k] - twice.reflection[k];
    const auto without = rte::reflect_polarised(open, steep, 3, options);
    const double change = difference(without, twice);
    CHECK(change > 0.01);
    CHECK(difference(without, extrapolated) <= change * change);  // the second order
}

TEST_CASE("one boundary does not change the intensity that unpolarising media scatter",
          "[rte][stokes]") {
    // What it polarises is forgotten when it is scattered, and the ground's light is unpolarised.
    const rte::Optics hg = rte::henyey_greenstein_optics(0.95, 0.6);
    rte::Stack white = glazed_film(hg, 1.0, 1.33);
    white.base_kind = rte::BaseKind::lambertian;
    white.ground_albedo = 0.7;
    const rte::Directions directions = many_directions();
    const rte::SolverOptions options{.tolerance = 1e-12, .streams = 16};
    for (const rte::Stack& stack : {glazed(hg, 1.5), white}) {
        const auto table = rte::reflect_polarised(stack, directions, 3, options);
        const auto scalar = rte::reflect(stack, directions, options);
        double worst = 0.0, polarised = 0.0;
        for (std::size_t k = 0; k < scalar.reflection.size(); ++k) {
            const double error = std::abs(table.reflection[9 * k] / scalar.reflection[k] - 1.0);
            if (!(error <= worst)) worst = error;
            polarised = std::max(polarised, std::abs(table.reflection[9 * k + 3]));
        }
        CHECK(worst <= 1e-11);    // two eigenproblems, of n and 3 n rows, at mu = 1e-3
        CHECK(polarised > 0.01);  // but what leaves is polarised
    }
}

TEST_CASE("boundaries and mirrors keep the energy of polarised light", "[rte][stokes]") {
    const std::vector<double> mu{1e-3, 0.3, 1.0};
    const double index = GENERATE(1.05, 1.33, 1.5, 2.6);
    const int streams = GENERATE(16, 32);
    // Nodes conserve energy in layers on any grid, in half-spaces to the accuracy of the panels;
    // requested cosines know the light inside to the grid's accuracy, as without polarisation.
    const double by_grid = streams == 32 && index > 1.1 ? 1e-8 : 1e-4;
    const double by_panels = streams == 32 ? 1e-12 : 1e-6;
    const auto check = [&](const rte::Stack& stack) {
        const auto table = rte::polarised_albedo(stack, mu, {.streams = streams});
        const bool transmits = !table.transmittance.empty();
        for (std::size_t k = 0; k < mu.size(); ++k) {
            const double passed = transmits ? table.transmittance[k] : 0.0;
            CHECK(std::abs(table.plane_albedo[k] + passed - 1.0) <= by_grid);
        }
        const double passed = transmits ? table.transmittance.back() : 0.0;
        CHECK(std::abs(table.spherical_albedo + passed - 1.0) <=
              (stack.coats.empty() ? by_panels : 1e-12));
    };
    CAPTURE(index, streams);
    check(glazed(rte::rayleigh_optics(1.0), index));
    const rte::Stack film = glazed_film(rte::rayleigh_optics(1.0), 0.7, index);
    rte::Stack white = film;
    white.base_kind = rte::BaseKind::lambertian;
    white.ground_albedo = 1.0;
    rte::Stack hosts = white;
    hosts.coats.push_back({rte::rayleigh_optics(1.0, 0.03), 0.4, 1.4});
    for (const rte::Stack& stack : {film, white, on_mirror(film, 1.0), hosts}) check(stack);
}

TEST_CASE("vector reflection under boundaries is reciprocal", "[rte][stokes]") {
    const rte::Directions directions = many_directions();
    const rte::SolverOptions options{.tolerance = 1e-12, .streams = 12};
    const int components = GENERATE(3, 4);
    const bool with_b2 = components == 4;
    const rte::Stack scenes[] = {glazed(rte::rayleigh_optics(0.99), 1.5), several_hosts(),
                                 on_mirror(glazed_film(siewert_optics(with_b2), 0.6, 1.5), kGold),
                                 on_mirror({.coats = {{siewert_optics(with_b2), 0.6}}}, kGold)};
    for (const rte::Stack& stack : scenes) {
        const auto table = rte::reflect_polarised(stack, directions, components, options);
        // Transmission along a mirrored beam is extrapolated in the incident cosine alone.
        const bool has_mirror = stack.base_kind == rte::BaseKind::mirror;
        CHECK(support::reciprocity_error(table, directions) <= (has_mirror ? 1e-6 : 1e-12));
    }
}

TEST_CASE("two layers of one medium on a mirror are one layer", "[rte][stokes]") {
    const int components = GENERATE(3, 4);
    const rte::Optics medium = siewert_optics(components == 4);
    const rte::Stack one = on_mirror(glazed_film(medium, 1.0, 1.5), kGold);
    rte::Stack two = one;
    two.coats = {{medium, 0.4, 1.5}, {medium, 0.6, 1.5}};
    const rte::Directions directions{{1e-3, 0.37, 1.0}, {0.1, 0.37, 0.8}, {0.0, 120.0, 250.0}};
    const rte::SolverOptions options{.tolerance = 1e-12, .streams = 16};
    // Transmission along a mirrored beam is extrapolated to 1e-9.
    CHECK(difference(rte::reflect_polarised(one, directions, components, options),
                     rte::reflect_polarised(two, directions, components, options)) <= 1e-8);
}

TEST_CASE("a thin layer scatters light once between Fresnel's matrices", "[rte][stokes]") {
    const double depth = 1e-9, index = 1.5;
    const int components = GENERATE(3, 4);
    const rte::Optics medium = siewert_optics(components == 4);
    const bool has_mirror = GENERATE(false, true);
    rte::Stack stack = glazed_film(medium, depth, index);
    if (has_mirror) stack = on_mirror(stack, kGold);
    const rte::Directions d{{0.4, 0.9}, {0.2, 0.9}, {30.0, 180.0, 300.0}};
    const auto table =
        rte::reflect_polarised(stack, d, components, {.tolerance = 1e-10, .streams = 24});
    const Eigen::Matrix4d D = Eigen::Vector4d(1.0, 1.0, -1.0, -1.0).asDiagonal();
    const Eigen::Matrix4d one = Eigen::Matrix4d::Identity();
    double worst = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t o = 0; o < 2; ++o) {
            for (std::size_t a = 0; a < 3; ++a) {
                const double in = rte::refracted_cosine(index, d.mu_in[i]);
                const double out = rte::refracted_cosine(index, d.mu_out[o]);
                const auto top = [&](double mu) {
                    return mueller_of(rte::fresnel_reflection(index, 1.0, mu));
                };
                const auto enters = [&](double mu) {
                    return mueller_of(passing(rte::fresnel_reflection(index, 1.0, mu)));
                };
                const auto bottom = [&](double mu) -> Eigen::Matrix4d {
                    if (!has_mirror) return Eigen::Matrix4d::Zero();
                    return mueller_of(rte::fresnel_reflection(index, kGold, mu));
                };
                const double cosine = std::cos(d.azimuth_deg[a] * std::acos(-1.0) / 180.0);
                const double sines = std::sqrt((1 - in * in) * (1 - out * out));
                const auto F = [&](double c) { return rte::exact_matrix(medium, c); };
                const Eigen::Matrix4d back = rte::turned_to_meridians(F(-in * out + sines * cosine),
                                                                      in, out, d.azimuth_deg[a]);
                const Eigen::Matrix4d on =
                    rte::turned_forward(F(in * out + sines * cosine), in, out, d.azimuth_deg[a]);
                const Eigen::Matrix4d down = (one - top(in) * bottom(in)).inverse() * enters(in);
                const Eigen::Matrix4d up = enters(out) * (one - bottom(out) * top(out)).inverse();
                const Eigen::Matrix4d turned = up * bottom(out);
                const Eigen::Matrix4d R =
                    (up * back * down + turned * (D * back * D) * bottom(in) * down +
                     turned * on * down + up * (D * on * D) * bottom(in) * down) *
                    (medium.single_scattering_albedo * depth / (4.0 * index * index * in * out));
                for (int row = 0; row < components; ++row) {
                    for (int column = 0; column < components; ++column) {
                        const double error =
                            std::abs(element(table, d, i, o, a, row, column) - R(row, column)) /
                            R(0, 0);
                        if (!(error <= worst)) worst = error;
                    }
                }
            }
        }
    }
    // Scattered twice: depth times its logarithm. Between mirror and total reflection light at the
    // cosine mu comes back 1/mu times and meets depth/mu^2: the share of mu < sqrt(depth).
    CHECK(worst <= (has_mirror ? 3.0 * std::sqrt(depth) : 2e-6));
}

TEST_CASE("the mirror of a boundary over black is Fresnel's matrix", "[rte][stokes]") {
    rte::Optics black = rte::isotropic_optics(0.0);
    const double mu = 0.4, index = 1.5, depth = 0.3;
    const auto through_film =
        rte::reflect_polarised(on_mirror(glazed_film(black, depth, index), kGold),
                               {{mu}, {0.5}, {0.0}}, 3, {.streams = 8})
            .mirror_reflectance;
    const double inside = rte::refracted_cosine(index, mu);
    const auto r = rte::fresnel_reflection(1.0, index, mu);
    const auto s = rte::fresnel_reflection(index, kGold, inside) * std::exp(-2.0 * depth / inside);
    const auto whole = rte::FresnelMatrix::identity();
    const Eigen::Matrix4d M = mueller_of(r + passing(r) * passing(r) * s / (whole - r * s));
    REQUIRE(through_film.size() == 9);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            CHECK(std::abs(through_film[std::size_t(3 * row + column)] - M(row, column)) <= 1e-15);
    const auto open = rte::polarised_albedo(glazed(black, index), {mu}, {.streams = 16});
    const Eigen::Matrix4d outside = mueller_of(r);
    CHECK(std::abs(open.plane_albedo[0] - outside(0, 0)) <= 1e-14);
    CHECK(std::abs(open.polarised_plane_albedo[0] - outside(0, 1)) <= 1e-14);
    REQUIRE(open.mirror_reflectance.size() == 1);
    CHECK(std::abs(open.mirror_reflectance[0] - outside(0, 0)) <= 1e-15);
}

TEST_CASE("rough boundaries are refused to polarised light", "[rte][stokes][errors]") {
    rte::Stack rough = glazed(rte::rayleigh_optics(0.9), 1.5);
    rough.boundary->roughness = 0.2;
    CHECK_THROWS_WITH(rte::reflect_polarised(rough, {{0.5}, {0.4}, {30.0}}, 3),
                      Catch::Contains("rough boundaries"));
}

TEST_CASE("V changes the rest little under boundaries", "[rte][stokes]") {
    // Total reflection and gold turn U into V and back: left out with three components.
    const rte::Directions directions{{0.2, 0.7}, {0.4, 0.9}, {20.0, 100.0}};
    const rte::SolverOptions options{.tolerance = 1e-8, .streams = 16};
    const rte::Stack half_space = glazed(rte::rayleigh_optics(0.95), 1.5);
    const rte::Stack film = on_mirror(glazed_film(rte::rayleigh_optics(0.98), 0.5, 1.5), kGold);
    for (const rte::Stack& stack : {half_space, film}) {
        const auto three = rte::reflect_polarised(stack, directions, 3, options);
        const auto four = rte::reflect_polarised(stack, directions, 4, options);
        double of_R11 = 0.0, of_others = 0.0;
        for (std::size_t k = 0; k < three.reflection.size() / 9; ++k) {
            for (std::size_t e = 0; e < 9; ++e) {
                const double change = std::abs(three.reflection[9 * k + e] -
                                               four.reflection[16 * k + e / 3 * 4 + e % 3]) /
                                      three.reflection[9 * k];
                double& largest = e == 0 ? of_R11 : of_others;
                if (!(change <= largest)) largest = change;
            }
        }
        CAPTURE(of_R11, of_others);
        CHECK(of_R11 <= 5e-3);  // 0.8e-3 to 1.7e-3 in scenes like these
        CHECK(of_others <= 1e-2);
        CHECK(of_others > 0.0);
    }
}
