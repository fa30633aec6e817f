// The methods that the solver is compared with, against closed forms and published tables.
#include <cmath>
#include <limits>

#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tools/bench/approximations.h"
#include "tools/bench/discrete_problem.h"

using namespace miebrdf;

using bench::SimpleLayer;
using bench::SimpleStack;

TEST_CASE("without absorption every short cut returns all light", "[bench][approximations]") {
    const SimpleStack white{{1.0, 0.7, 0}, SimpleLayer{1.0, 0.3, 2.0}};
    const SimpleStack bare{{1.0, 0.7, 0}, {}};
    CHECK(std::abs(*bench::kubelka_munk_reflectance(white) - 1) <= 1e-7);
    CHECK(std::abs(*bench::diffusion_reflectance(bare) - 1) <= 1e-15);
    for (const double mu : {0.1, 0.5, 1.0}) {
        // k ~ 1e-6 stands for no absorption (approximations.cpp).
        CHECK(std::abs(bench::two_stream_plane_albedo(white, mu) - 1) <= 2e-5);
        CHECK(std::abs(bench::two_stream_plane_albedo(bare, mu) - 1) <= 2e-5);
    }
}

TEST_CASE("a coat of the base's own material changes nothing", "[bench][approximations]") {
    // Exact for each method: its layers obey the semigroup property.
    for (const double depth : {1e-3, 0.5, 40.0}) {
        const SimpleLayer medium{0.95, 0.6, depth};
        const SimpleStack coated{{0.95, 0.6, 0}, medium}, bare{{0.95, 0.6, 0}, {}};
        CAPTURE(depth);
        CHECK(std::abs(*bench::kubelka_munk_reflectance(coated) -
                       *bench::kubelka_munk_reflectance(bare)) <= 1e-12);
        for (const double mu : {0.1, 0.4, 1.0}) {
            CHECK(std::abs(bench::two_stream_plane_albedo(coated, mu) -
                           bench::two_stream_plane_albedo(bare, mu)) <= 1e-9);
            CHECK(std::abs(bench::single_scattering_reflection(coated, mu, 0.3, 0.8, 0.8) -
                           bench::single_scattering_reflection(bare, mu, 0.3, 0.0, 0.8)) <= 1e-15);
        }
    }
}

TEST_CASE("Kubelka-Munk has no answer where its scattering coefficient is not positive",
          "[bench][approximations]") {
    CHECK_FALSE(bench::kubelka_munk_reflectance({{0.1, 0.5, 0}, {}}));
    CHECK_FALSE(bench::diffusion_reflectance({{0.9, 0.5, 0}, SimpleLayer{}}));
}

TEST_CASE("the two-stream plane albedo of an isotropic half-space is Eddington's",
          "[bench][approximations]") {
    // g = 0: gamma1 = (7 - 4w)/4, gamma2 = (4w - 1)/4, k = sqrt(3 (1 - w)), so that
    // A = w (1/2 + mu0 ... ) of Meador & Weaver 1980; here from the flux equations at w = 0.75:
    // k = sqrt(3)/2, gamma1 = 1, gamma2 = 1/2, gamma3 = gamma4 = 1/2, alpha2 = 3/4.
    const double k = std::sqrt(3.0) / 2;
    for (const double mu : {0.2, 1.0}) {
        const double expected = 0.75 * (0.75 + k / 2) / ((1 + k * mu) * (1 + k));
        CHECK(std::abs(bench::two_stream_plane_albedo({{0.75, 0, 0}, {}}, mu) - expected) <= 1e-15);
    }
}

namespace {

bench::MomentLayer henyey_greenstein(double albedo, double g, double depth) {
    bench::MomentLayer layer{albedo, {}, {}, depth};
    for (int l = 0; l < 600; ++l) layer.chi.push_back(l == 0 ? 1.0 : std::pow(g, l));
    layer.phase = [g](double x) { return (1 - g * g) / std::pow(1 + g * g - 2 * g * x, 1.5); };
    return layer;
}

constexpr double kEndless = std::numeric_limits<double>::infinity();

bench::OrderSolver solver(bool doubling) {
    if (doubling) return [](const bench::Order& o) { return bench::adding_doubling(o); };
    return [](const bench::Order& o) { return bench::discrete_ordinates(o); };
}

}  // namespace

TEST_CASE("textbook solvers reproduce coated half-spaces", "[bench][discrete]") {
    const bool doubling = GENERATE(true, false);
    const support::ReferenceTable table("rte/R_coated_halfspace.csv");
    int compared = 0;
    std::string coat_done;
    for (std::size_t row = 0; row < table.size(); ++row) {
        const double tau = table.number(row, "tau");
        if (table.number(row, "mu_o") != 0.8 || table.number(row, "mu_i") != 0.35) continue;
        if (table.number(row, "phi_deg") != 120 || tau > 1 || compared > 8) continue;
        bench::MomentStack stack;
        if (tau > 0) {
            stack.push_back(henyey_greenstein(table.number(row, "coat_alpha"),
                                              table.number(row, "coat_g"), tau));
        }
        stack.push_back(henyey_greenstein(0.95, 0.7, kEndless));
        const auto R = bench::sum_orders(stack, 16, {{0.35}, {0.8}, {120}}, solver(doubling));
        const double truth = table.number(row, "R");
        CAPTURE(doubling, row, tau, R[0], truth);
        // 16 Gauss nodes and 32 moments of g = 0.7: 0.7^32 = 1e-5 is what delta-M removed.
        CHECK(std::abs(R[0] / truth - 1) <= 2e-5);
        ++compared;
    }
    CHECK(compared >= 4);
}

TEST_CASE("textbook plane albedos agree with the table of half-spaces", "[bench][discrete]") {
    const bool doubling = GENERATE(true, false);
    const support::ReferenceTable table("rte/albedo_halfspace_HG.csv");
    int compared = 0;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.number(row, "g") != 0.5 || table.text(row, "quantity") != "plane_albedo")
            continue;
        const double mu = table.number(row, "mu_i"), albedo = table.number(row, "alpha");
        if (mu != 0.2 && mu != 0.9) continue;
        const auto A = bench::plane_albedo({henyey_greenstein(albedo, 0.5, kEndless)}, 16, {mu},
                                           solver(doubling));
        const double truth = table.number(row, "value");
        CAPTURE(doubling, albedo, mu, A[0], truth);
        // Gauss nodes resolve the mu ln mu at grazing to ~3e-7 (16 nodes). At albedo 1 the
        // ordinates have 1e-10 of absorption instead: 1 - A ~ 4/sqrt(3) sqrt(1e-10 / (1 - g)) ~
        // 6e-5. Doubling starts from single scattering by an optical depth of 1e-8 and so loses
        // about 1e-8 of the light per unit depth, which counts where absorption is as small.
        const double lost = doubling && albedo < 1 ? 1e-9 / (1 - albedo) : 0;
        CHECK(std::abs(A[0] - truth) <= (albedo == 1 ? 7e-5 : 1e-6 + lost));
        ++compared;
    }
    CHECK(compared >= 6);
}
