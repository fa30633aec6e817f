// The textbook solvers against reference tables: they are the yardstick of the coat suite.
#include "tools/bench/discrete_problem.h"

#include <cmath>
#include <limits>

#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;

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
        const auto R = bench::sum_orders(stack, 16, {0.35}, {0.8}, {120}, solver(doubling));
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
