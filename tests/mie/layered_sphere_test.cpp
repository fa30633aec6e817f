// Spheres of layers, alone and averaged over sizes.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using Layers = std::vector<mie::SphereLayer>;

namespace {

double apart(double value, double truth) {
    return truth == 0 ? std::abs(value) : std::abs(value / truth - 1);
}

}  // namespace

TEST_CASE("a coated sphere agrees with the 60-digit table on every row", "[mie][layers]") {
    const support::ReferenceTable table("mie/coated_spheres.csv");
    REQUIRE(table.size() == 40);
    for (std::size_t row = 0; row < table.size(); ++row) {
        const auto at = [&](const char* column) { return table.number(row, column); };
        const Layers layers = {{{at("core_n"), at("core_k")}, at("core_x")},
                               {{at("shell_n"), at("shell_k")}, at("outer_x")}};
        const auto sphere = mie::scatter_by_sphere(layers);
        CAPTURE(row, at("core_x"), at("outer_x"));
        // 15 digits are printed; g and q_back are differences.
        CHECK(apart(sphere.q_ext, at("q_ext")) <= 1e-12);
        CHECK(apart(sphere.q_sca, at("q_sca")) <= 1e-12);
        CHECK(std::abs(sphere.asymmetry - at("asymmetry")) <= 1e-12);
        CHECK(apart(sphere.q_back, at("q_back")) <= 1e-11);
        CHECK(sphere.reached);
    }
}

TEST_CASE("two to five layers agree with 60 digits, in shells of 1e-6 of the radius and at x = 1e4",
          "[mie][layers]") {
    // mpmath, 130 digits and more: psi and chi in each layer, matched at each surface without
    // logarithmic derivatives of waves or ratios. Random n 1 to 2.8, k 0 to 1, x 0.1 to 250; thin
    // shells; absorbing, hollow and clear spheres of x = 1e4.
    const support::ReferenceTable table("mie/layered_spheres.csv");
    REQUIRE(table.size() == 20);
    for (std::size_t row = 0; row < table.size(); ++row) {
        Layers layers;
        for (int i = 1; i <= int(table.number(row, "layers")); ++i) {
            const auto at = [&](const char* column) {
                return table.number(row, column + std::to_string(i));
            };
            layers.push_back({{at("n"), at("k")}, at("x")});
        }
        const auto sphere = mie::scatter_by_sphere(layers);
        const double x = layers.back().size_parameter;
        CAPTURE(row, layers.size(), x);
        // Sums over x orders round; q_back is the small difference of many of them.
        const double rounding = 1e-12 + 2e-16 * x;
        CHECK(apart(sphere.q_ext, table.number(row, "q_ext")) <= rounding);
        CHECK(apart(sphere.q_sca, table.number(row, "q_sca")) <= rounding);
        CHECK(std::abs(sphere.asymmetry - table.number(row, "asymmetry")) <= rounding);
        CHECK(apart(sphere.q_back, table.number(row, "q_back")) <= 1e-11 + 3e-14 * x);
    }
}

TEST_CASE("layers of one index are the plain sphere, however thin", "[mie][layers]") {
    const std::complex<double> m = GENERATE(std::complex<double>(1.5, 0), std::complex(2.6, 0.0),
                                            std::complex(1.33, 0.1), std::complex(0.2, 3.4));
    const double x = GENERATE(1e-3, 0.3, 10.0, 1e3, 1e4);
    const double core = GENERATE(0.05, 0.7, 1 - 1e-6, 1.0);
    const auto plain = mie::scatter_by_sphere(m, x);
    // An index that differs by rounding takes the path of layers.
    const std::complex<double> same(m.real() * (1 + 4e-16), m.imag());
    const auto layered = mie::scatter_by_sphere(Layers{{m, core * x}, {same, x}});
    CAPTURE(m, x, core);
    CHECK(apart(layered.q_ext, plain.q_ext) <= 1e-12);
    CHECK(apart(layered.q_sca, plain.q_sca) <= 1e-12);
    CHECK(apart(layered.q_abs, plain.q_abs) <= 1e-12);
    CHECK(std::abs(layered.asymmetry - plain.asymmetry) <= 1e-12);
}

TEST_CASE("a coating of the host's index is not seen", "[mie][layers]") {
    const std::complex<double> m =
        GENERATE(std::complex<double>(1.5, 0), std::complex(2.6, 1e-3), std::complex(0.2, 3.4));
    const double x = GENERATE(1e-3, 1.0, 50.0, 3000.0);
    const auto core = mie::scatter_by_sphere(m, x);
    const double y = 1.3 * x;
    const auto coated = mie::scatter_by_sphere(Layers{{m, x}, {1.0, y}});
    CAPTURE(m, x);
    CHECK(apart(coated.q_ext * y * y, core.q_ext * x * x) <= 1e-12);
    CHECK(apart(coated.q_sca * y * y, core.q_sca * x * x) <= 1e-12);
    CHECK(std::abs(coated.asymmetry - core.asymmetry) <= 1e-12);
}

TEST_CASE("a core behind an opaque coating is not seen, and transparent layers absorb nothing",
          "[mie][layers]") {
    const std::complex<double> metal(1.5, 3.0);
    // exp(-2 k (y - x)) = exp(-60) of the light comes back from the core.
    const auto coated = mie::scatter_by_sphere(Layers{{2.6, 40.0}, {metal, 50.0}});
    const auto solid = mie::scatter_by_sphere(metal, 50);
    CHECK(apart(coated.q_ext, solid.q_ext) <= 1e-12);
    CHECK(apart(coated.q_abs, solid.q_abs) <= 1e-12);
    // Thick absorbing layers leave the range of numbers: exp(2 * 3 * 900).
    const auto thick = mie::scatter_by_sphere(Layers{{2.6, 100.0}, {metal, 1000.0}});
    CHECK(apart(thick.q_ext, mie::scatter_by_sphere(metal, 1000).q_ext) <= 1e-12);
    const auto clear = mie::scatter_by_sphere(Layers{{1.0, 20.0}, {1.5, 24.0}, {2.1, 25.0}});
    CHECK(clear.q_abs == 0);
    CHECK(clear.q_sca > 0);
}

TEST_CASE("the optical theorem holds for layers", "[mie][layers]") {
    const double x = GENERATE(0.5, 8.0, 300.0);
    const Layers layers = {{{1.0, 0.0}, 0.6 * x}, {{1.59, 0.01}, 0.9 * x}, {{1.33, 0.0}, x}};
    const double forward = 0;
    const auto s = mie::scattering_amplitudes(layers, {&forward, 1});
    CHECK(apart(4 * s.s1[0].real() / x / x, mie::scatter_by_sphere(layers).q_ext) <= 1e-12);
}

TEST_CASE("averages of coated spheres are those of the plain ones that they amount to",
          "[mie][layers][ensemble]") {
    // A coating of nearly the core's index, a quarter of its radius: spheres 1.25 times as large.
    mie::EnsembleRequest plain;
    plain.sizes = {mie::SizeDistributionKind::gamma, 1.25 * 0.2, 0.1};
    plain.refractive_index = {1.6, 0.02};
    plain.host_index = 1.33;
    plain.highest_moment = 12;
    plain.tolerance = 1e-6;
    plain.angles_deg = {0, 40, 110, 180};
    plain.phase_tolerance = 1e-3;
    mie::EnsembleRequest coated = plain;
    coated.sizes.effective_radius_um = 0.2;
    coated.coatings = {{{1.6 + 1e-13, 0.02}, 0.0, 0.25}};
    const auto a = mie::average_over_sizes(plain), b = mie::average_over_sizes(coated);
    REQUIRE(b.converged);
    CHECK(apart(b.q_ext, 1.25 * 1.25 * a.q_ext) <= 3e-6);
    CHECK(apart(b.one_minus_albedo, a.one_minus_albedo) <= 3e-6);
    for (std::size_t l = 0; l < a.chi.size(); ++l) CHECK(std::abs(b.chi[l] - a.chi[l]) <= 3e-6);
    for (std::size_t i = 0; i < a.phase.size(); ++i)
        CHECK(std::abs(b.phase[i] - a.phase[i]) <= a.phase_error[i] + b.phase_error[i]);
    const auto matrix = mie::average_matrix(coated);
    CHECK(std::abs(matrix.optics.asymmetry - a.asymmetry) <= 3e-6);
}

TEST_CASE("averages of coated spheres are sums over single ones", "[mie][layers][ensemble]") {
    // A film of water as thick on every grain: what a sum over spheres of layers gives.
    mie::EnsembleRequest request;
    request.sizes = {mie::SizeDistributionKind::power_law, 0.4, 0.1};
    request.refractive_index = {1.53, 0.05};
    request.coatings = {{1.33, 0.06, 0.0}};
    request.tolerance = 1e-5;
    request.with_phase_table = true;
    const auto optics = mie::average_over_sizes(request);
    const auto range = mie::radius_range(request.sizes);
    const double k = 2 * std::numbers::pi / 0.55;
    double area = 0, extinction = 0, scattering = 0, asymmetry = 0;
    constexpr int count = 4000;
    for (int i = 0; i < count; ++i) {
        // n(r) ~ r^-3, in equal ratios: n r^2 dr ~ const.
        const double r =
            range.smallest_um * std::pow(range.largest_um / range.smallest_um, (i + 0.5) / count);
        const double x = k * r, y = k * (r + 0.06);
        const auto sphere =
            mie::scatter_by_sphere(Layers{{request.refractive_index, x}, {1.33, y}});
        area += 1;
        extinction += sphere.q_ext * y * y / (x * x);
        scattering += sphere.q_sca * y * y / (x * x);
        asymmetry += sphere.asymmetry * sphere.q_sca * y * y / (x * x);
    }
    CAPTURE(optics.error_estimate, optics.size_nodes);
    CHECK(apart(optics.q_ext, extinction / area) <= 3e-5);
    CHECK(apart(optics.single_scattering_albedo, scattering / extinction) <= 3e-5);
    CHECK(std::abs(optics.asymmetry - asymmetry / scattering) <= 3e-5);
    REQUIRE(optics.phase_table);
    CHECK(std::abs(optics.phase_table->mean() - 1) <= 1e-2);
}

TEST_CASE("layers out of order are refused with the size", "[mie][layers][errors]") {
    CHECK_THROWS_WITH(mie::scatter_by_sphere(Layers{{1.5, 2.0}, {1.3, 1.5}}),
                      Catch::Contains("1.5") && Catch::Contains("2 or more"));
    CHECK_THROWS_WITH(mie::scatter_by_sphere(Layers{}), Catch::Contains("layers"));
    CHECK_THROWS_WITH(mie::scatter_by_sphere(Layers{{1.5, 2.0}, {{1.3, -1}, 3.0}}),
                      Catch::Contains("-1"));
}
