#include "mie/phase_table.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "mie/ensemble.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using std::numbers::pi;

namespace {

// A table of a known function on given panels.
mie::PhaseTable table_of(const std::function<double(double)>& phase,
                         const std::vector<double>& edges) {
    Eigen::MatrixXd values(mie::PhaseTable::panel_nodes,
                           static_cast<Eigen::Index>(edges.size()) - 1);
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
        const auto nodes = mie::PhaseTable::nodes_of(edges[p], edges[p + 1]);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(p)) =
                phase(std::cos(nodes[i]));
        }
    }
    return {edges, values, 0, 0};
}

}  // namespace

TEST_CASE("a table of Henyey-Greenstein gives it back, and its moments g^l", "[mie][phase_table]") {
    const double g = GENERATE(-0.5, 0.0, 0.7);
    const auto phase = [g](double mu) {
        return (1 - g * g) / std::pow(1 + g * g - 2 * g * mu, 1.5);
    };
    std::vector<double> edges;
    for (int i = 0; i <= 120; ++i) edges.push_back(pi * i / 120);
    const auto table = table_of(phase, edges);
    CAPTURE(g);
    // Panels of 1.5 degrees, 8 nodes: (width / 4)^8 times the eighth derivative.
    CHECK(std::abs(table.mean() - 1) <= 1e-9);
    for (int i = 0; i <= 1000; ++i) {
        const double mu = -1 + 0.002 * i;
        CHECK(std::abs(table(mu) / phase(mu) - 1) <= 1e-8);
    }
    const auto chi = table.moments(300);
    for (int l = 0; l <= 300; ++l) CHECK(std::abs(chi[l] - std::pow(g, l)) <= 1e-9);
}

TEST_CASE("the phase table agrees with P at listed angles and with the moments",
          "[mie][phase_table]") {
    mie::EnsembleRequest request;
    request.refractive_index =
        GENERATE(std::complex<double>(1.5, 0.1), std::complex<double>(1.33, 0));
    request.sizes.effective_radius_um = GENERATE(0.05, 1.0, 4.0);
    request.tolerance = 1e-5;
    request.phase_tolerance = 1e-3;
    request.highest_moment = 40;
    request.with_phase_table = true;
    request.angles_deg = {0, 0.3, 2, 17, 90, 130, 138, 165, 178.2, 179.7, 180};
    const auto optics = mie::average_over_sizes(request);
    REQUIRE(optics.phase_table);
    const auto& table = *optics.phase_table;
    CAPTURE(request.refractive_index, request.sizes.effective_radius_um, table.angle_count());
    CHECK(table.interpolation_error() <= 1e-2);
    for (std::size_t i = 0; i < request.angles_deg.size(); ++i) {
        CAPTURE(request.angles_deg[i]);
        const double mu = std::cos(request.angles_deg[i] * pi / 180);
        const double bound =
            3 * (table.size_error() + table.interpolation_error() + optics.phase_error_estimate) +
            1e-5;
        CHECK(std::abs(table(mu) / optics.phase[i] - 1) <= bound);
    }
    // Moments of the table and of the covariance: two ways, with size nodes of their own (the
    // table's are fewer where only P is asked for: 4e-4 measured).
    const auto chi = table.moments(40);
    for (int l = 0; l <= 40; ++l) CHECK(std::abs(chi[l] - optics.chi[l]) <= 1e-3);
}

TEST_CASE("many moments come from the table when that is cheaper", "[mie][phase_table]") {
    mie::EnsembleRequest request;
    request.refractive_index = {1.5, 0.02};
    request.sizes.effective_radius_um = 8;
    request.highest_moment = 500;
    request.tolerance = 1e-4;
    const auto quick = mie::average_over_sizes(request);
    request.tolerance = 9e-6;  // asks for more than the table gives: the band
    const auto exact = mie::average_over_sizes(request);
    REQUIRE(quick.chi.size() == 501);
    REQUIRE(exact.chi.size() == 501);
    for (int l = 0; l <= 500; ++l) {
        CAPTURE(l);
        CHECK(std::abs(quick.chi[l] - exact.chi[l]) <= 1e-4);
    }
    // Beyond 2 x_max + O(x^(1/3)) there is nothing.
    CHECK(std::abs(quick.chi[500]) <= 1e-6);
    CHECK(!quick.phase_table);
}
