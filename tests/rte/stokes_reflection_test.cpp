
#include <cmath>

#include "rte/math/quadrature.h"
#include "rte/stack/layered_reflection.h"
#include "tests/rte/stokes_media.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::difference;
using support::element;
using support::many_directions;
using support::siewert_optics;

namespace {

// Equations to rounding: what is compared are two ways to the same numbers.
const rte::SolverOptions exact{.tolerance = 1e-12, .streams = 16};

}  // namespace

TEST_CASE("a Rayleigh half-space has the reflection matrix of the reference table",
          "[rte][stokes]") {
    const support::ReferenceTable table("rte/stokes_rayleigh_half_space.csv");
    const struct {
        const char* name;
        int row, column;
    } columns[] = {{"r11", 0, 0}, {"r21", 1, 0}, {"r31", 2, 0},
                   {"r22", 1, 1}, {"r33", 2, 2}, {"r44", 3, 3}};
    double worst = 0.0;
    for (std::size_t k = 0; k < table.size(); ++k) {
        const rte::Stack stack{.base = rte::rayleigh_optics(table.number(k, "albedo"))};
        const rte::Directions one{{table.number(k, "mu_in")},
                                  {table.number(k, "mu_out")},
                                  {table.number(k, "azimuth_deg")}};
        const auto result =
            rte::reflect_polarised(stack, one, 4, {.tolerance = 1e-6, .streams = 16});
        for (const auto& [name, row, column] : columns) {
            const double error =
                std::abs(element(result, one, 0, 0, 0, row, column) - table.number(k, name));
            if (!(error <= worst)) worst = error;
        }
    }
    // 16 nodes err by 2.8e-8.
    CHECK(worst <= 1e-7);
}

TEST_CASE("a Rayleigh layer reflects what Natraj, Li & Yung recomputed of Coulson's tables",
          "[rte][stokes]") {
    const support::ReferenceTable table("rte/stokes_rayleigh_slab.csv");
    rte::Stack stack{.coats = {{rte::rayleigh_optics(1.0), 0.5}}};
    stack.base_kind = rte::BaseKind::none;
    for (std::size_t k = 0; k < table.size(); ++k) {
        const rte::Directions one{
            {0.2}, {table.number(k, "mu_out")}, {table.number(k, "azimuth_deg")}};
        const auto R =
            rte::reflect_polarised(stack, one, 3, {.tolerance = 1e-8, .streams = 24}).reflection;
        CAPTURE(k);
        // 24 nodes err by 6e-9; the table's last digit is 5e-9.
        CHECK(std::abs(0.2 * R[0] - table.number(k, "I")) <= 1e-7);
        CHECK(std::abs(-0.2 * R[3] - table.number(k, "Q")) <= 1e-7);
        CHECK(std::abs(0.2 * R[6] - table.number(k, "U")) <= 1e-7);
    }
}

TEST_CASE("a layer with b2 reflects what Siewert's table says", "[rte][stokes]") {
    rte::Stack stack{.coats = {{siewert_optics(true), 1.0}}};
    stack.base_kind = rte::BaseKind::none;
    const rte::Directions one{{0.6}, {0.5}, {90.0}};
    const rte::SolverOptions options{.tolerance = 1e-7, .streams = 16};
    const auto R = rte::reflect_polarised(stack, one, 4, options).reflection;
    // Siewert 2000, tables 4 to 6, flux pi: six digits each; his U has the opposite sign.
    CHECK(std::abs(0.6 * R[0] - 0.124626) <= 1e-6);
    CHECK(std::abs(0.6 * R[4] - 0.00512123) <= 1e-6);
    CHECK(std::abs(0.6 * R[8] - 0.00804140) <= 1e-6);
    // Three components leave out what V gives back: 3e-6 here.
    const auto without = rte::reflect_polarised(stack, one, 3, options).reflection;
    CHECK(std::abs(without[0] - R[0]) <= 1e-7);
    CHECK(std::abs(without[3] - R[4]) > 1e-6);
    CHECK(std::abs(without[3] - R[4]) <= 1e-5);
}

TEST_CASE("light from deep inside a Rayleigh half-space is polarised as in Milne's problem",
          "[rte][stokes]") {
    // Chandrasekhar 1960, table XXIV. What a weakly absorbing medium emits, 1 - A and -A_Q, is
    // proportional to Milne's solution but for terms of the order of (1 - albedo)^(1/2).
    rte::Optics medium = rte::rayleigh_optics(1.0);
    medium.single_scattering_albedo = 1.0 - 1e-13;
    medium.one_minus_albedo = 1e-13;
    const struct {
        double mu, polarisation;
    } table[] = {{1e-7, 0.11713}, {0.1, 0.07448}, {0.2, 0.05410}, {0.5, 0.02252}, {0.8, 0.00682}};
    std::vector<double> mu;
    for (const auto& row : table) mu.push_back(row.mu);
    const auto albedo =
        rte::polarised_albedo({.base = medium}, mu, {.tolerance = 1e-9, .streams = 32});
    for (std::size_t k = 0; k < mu.size(); ++k) {
        CAPTURE(mu[k]);
        const double polarisation =
            albedo.polarised_plane_albedo[k] / (1.0 - albedo.plane_albedo[k]);
        CHECK(std::abs(std::abs(polarisation) - table[k].polarisation) <= 1.5e-5);
    }
}

TEST_CASE("a conservative Rayleigh half-space has the geometric albedo .79767", "[rte][stokes]") {
    const rte::Stack stack{.base = rte::rayleigh_optics(1.0)};
    const auto rule = math::gauss_legendre(24, 0.0, 1.0);
    double geometric = 0.0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double mu = rule.nodes[k];
        const auto R =
            rte::reflect_polarised(stack, {{mu}, {mu}, {180.0}}, 3, {.streams = 12}).reflection;
        geometric += 2.0 * rule.weights[k] * mu * mu * R[0];
    }
    CHECK(std::abs(geometric - 0.79767) <= 1e-5);
}

TEST_CASE("what does not absorb returns all light, polarised or not", "[rte][stokes]") {
    const int streams = GENERATE(8, 24);
    rte::Stack stack{.base = rte::rayleigh_optics(1.0),
                     .coats = {{rte::rayleigh_optics(1.0, 0.0279), 0.3}}};
    const bool on_ground = GENERATE(false, true);
    if (on_ground) stack.base_kind = rte::BaseKind::lambertian, stack.ground_albedo = 1.0;
    const auto albedo = rte::polarised_albedo(stack, {1e-3, 0.4, 1.0}, {.streams = streams});
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(std::abs(albedo.plane_albedo[k] - 1.0) <= 1e-12);
        CHECK(std::abs(albedo.polarised_plane_albedo[k]) <= 1e-12);
    }
    CHECK(std::abs(albedo.spherical_albedo - 1.0) <= 1e-12);
}

TEST_CASE("vector reflection is reciprocal to rounding", "[rte][stokes]") {
    const bool with_b2 = GENERATE(false, true);
    const rte::Stack stack{
        .base = rte::rayleigh_optics(0.99),
        .coats = {{siewert_optics(with_b2), 0.3}, {rte::rayleigh_optics(0.8, 0.03), 0.1}}};
    const rte::Directions directions = many_directions();
    const auto table = rte::reflect_polarised(stack, directions, 4, {.streams = 10});
    CHECK(support::reciprocity_error(table, directions) <= 1e-13);
}

TEST_CASE("media that do not polarise give the scalar reflection", "[rte][stokes]") {
    const rte::Stack stack{.base = rte::henyey_greenstein_optics(0.99, 0.7),
                           .coats = {{rte::henyey_greenstein_optics(0.6, 0.2), 0.3}}};
    const rte::Directions directions = many_directions();
    const auto table = rte::reflect_polarised(stack, directions, 3, exact);
    const auto scalar = rte::reflect(stack, directions, exact);
    double worst = 0.0, others = 0.0;
    for (std::size_t k = 0; k < scalar.reflection.size(); ++k) {
        const double error = std::abs(table.reflection[9 * k] / scalar.reflection[k] - 1.0);
        if (!(error <= worst)) worst = error;
        for (std::size_t e = 1; e < 9; ++e)
            others = std::max(others, std::abs(table.reflection[9 * k + e]));
    }
    CHECK(worst <= 1e-13);  // two eigenproblems, of n and 3 n rows
    CHECK(others == 0.0);
    for (std::size_t i = 0; i < directions.mu_in.size(); ++i)
        CHECK(std::abs(table.plane_albedo[i] - scalar.plane_albedo[i]) <= 1e-13);
}

TEST_CASE("delta-M of the whole matrix lets few nodes see a forward peak", "[rte][stokes]") {
    const rte::Stack stack{.base = support::polarised_peak_optics(0.95, 0.8)};
    const rte::Directions directions{{0.1, 0.6}, {0.2, 0.9}, {0.0, 75.0, 180.0}};
    const auto coarse = rte::reflect_polarised(stack, directions, 3, {.streams = 12});
    const auto fine = rte::reflect_polarised(stack, directions, 3, {.streams = 40});
    const auto sharp =
        rte::reflect_polarised(stack, directions, 3, {.streams = 12, .delta_m = false});
    const double error = difference(fine, coarse);
    // 48 moments of 0.8^l; projected on the nodes they need no delta-M, which must not spoil them.
    CHECK(error <= 1e-4);
    CHECK(difference(fine, sharp) <= 1e-4);
    CHECK(fine.report.converged);
}

TEST_CASE("a layer on a half-space of its own medium is that half-space", "[rte][stokes]") {
    const bool with_b2 = GENERATE(false, true);
    const double depth = GENERATE(1e-6, 0.3, 30.0);
    rte::Stack alone{.base = siewert_optics(with_b2)};
    if (depth == 0.3) {  // without absorption too
        alone.base.single_scattering_albedo = 1.0;
        alone.base.one_minus_albedo = 0.0;
    }
    const rte::Stack coated{.base = alone.base, .coats = {{alone.base, depth}}};
    const rte::Directions directions = many_directions();
    const rte::SolverOptions options{.tolerance = 1e-12, .streams = 10};
    const double apart = difference(rte::reflect_polarised(alone, directions, 4, options),
                                    rte::reflect_polarised(coated, directions, 4, options));
    CAPTURE(with_b2, depth);
    CHECK(apart <= 2e-12);  // 2e-13 at mu = 1e-3, 4e-13 by complex eigenmodes
}

TEST_CASE("two layers of one medium are one layer", "[rte][stokes]") {
    const bool with_b2 = GENERATE(false, true);
    const rte::Optics medium = siewert_optics(with_b2);
    rte::Stack one{.coats = {{medium, 1.0}}};
    one.base_kind = rte::BaseKind::lambertian;
    one.ground_albedo = 0.3;
    rte::Stack two = one;
    two.coats = {{medium, 0.4}, {medium, 0.6}};
    const rte::Directions directions = many_directions();
    const rte::SolverOptions options{.tolerance = 1e-12, .streams = 10};
    CHECK(difference(rte::reflect_polarised(one, directions, 4, options),
                     rte::reflect_polarised(two, directions, 4, options)) <= 2e-12);
}

TEST_CASE("integrating the first row over the hemisphere gives the plane albedos",
          "[rte][stokes]") {
    const rte::Stack stack{.base = siewert_optics(false)};
    const auto rule = math::gauss_legendre(40, 0.0, 1.0);
    std::vector<double> azimuths;
    const int count = 32;  // the rectangle rule is exact for orders below 32
    for (int a = 0; a < count; ++a) azimuths.push_back(360.0 * a / count);
    const rte::Directions directions{{0.3}, rule.nodes, azimuths};
    const auto table = rte::reflect_polarised(stack, directions, 3, {.streams = 24});
    double flux = 0.0, of_Q = 0.0;
    for (std::size_t o = 0; o < rule.nodes.size(); ++o) {
        for (std::size_t a = 0; a < azimuths.size(); ++a) {
            const double weight = 2.0 * rule.weights[o] * rule.nodes[o] / count;
            flux += weight * element(table, directions, 0, o, a, 0, 0);
            of_Q += weight * element(table, directions, 0, o, a, 0, 1);
        }
    }
    CHECK(std::abs(flux - table.plane_albedo[0]) <= 1e-6);  // 40 nodes on R's x ln x at grazing
    CHECK(std::abs(of_Q - table.polarised_plane_albedo[0]) <= 1e-6);
}

TEST_CASE("the Stokes solver says when it has converged and refuses what it cannot do",
          "[rte][stokes][errors]") {
    const rte::Stack stack{.base = rte::rayleigh_optics(0.9)};
    const rte::Directions one{{0.5}, {0.4}, {30.0}};
    const auto result = rte::reflect_polarised(stack, one, 3, {.tolerance = 1e-5});
    CHECK(result.report.converged);
    CHECK(result.report.error_estimate <= 1e-5);
    CHECK(result.report.fourier_orders == 3);
    CHECK_THROWS_WITH(rte::reflect_polarised(stack, one, 2), Catch::Contains("3 (I, Q, U)"));
    CHECK_THROWS_WITH(rte::reflect_polarised(stack, {{0.0}, {0.4}, {0.0}}, 3),
                      Catch::Contains("mu_in"));
    CHECK_THROWS_WITH(rte::reflect_polarised(stack, one, 3,
                                             {.half_space_method = rte::HalfSpaceMethod::doubling}),
                      Catch::Contains("automatic"));
}
