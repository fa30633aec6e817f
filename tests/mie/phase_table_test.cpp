#include "mie/ensemble/phase_table.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "tests/support/catch.h"

using namespace miebrdf;
using std::numbers::pi;

namespace {

// A table of a known function on given panels.
mie::PhaseTable table_of(const std::function<double(double)>& phase,
                         const std::vector<double>& edges) {
    Eigen::MatrixXd values(mie::PhaseTable::kPanelNodes,
                           static_cast<Eigen::Index>(edges.size()) - 1);
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
        const auto nodes = mie::panel_nodes(edges[p], edges[p + 1]);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(p)) =
                phase(std::cos(nodes[i]));
        }
    }
    return mie::make_phase_table({.edges = edges, .coefficients = {}, .noise = {}}, values, 0.0);
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
    // Claims this small (1.1e-3 and 8.4e-3 seen) keep the bounds below from being empty.
    CHECK(table.interpolation_error() <= 3e-3);
    CHECK(table.size_error() <= 1.5e-2);
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

TEST_CASE("neighbouring panels of a phase table meet", "[mie][phase_table]") {
    // Each has sizes of its own; the glory of 10 um jumped by 3.4 % before edges were shared.
    mie::EnsembleRequest request;
    request.refractive_index = 1.5;
    request.sizes.effective_radius_um = 10;
    request.tolerance = 1e-3;
    request.with_phase_table = true;
    const auto optics = mie::average_over_sizes(request);
    const auto& parts = optics.phase_table->parts();
    const Eigen::Map<const Eigen::MatrixXd> coefficients(
        parts.coefficients.data(), mie::PhaseTable::kPanelNodes,
        static_cast<Eigen::Index>(parts.edges.size()) - 1);
    for (Eigen::Index p = 1; p < coefficients.cols(); ++p) {
        // T_k(1) = 1 and T_k(-1) = (-1)^k.
        const double above = coefficients.col(p)(Eigen::seqN(0, 4, 2)).sum() -
                             coefficients.col(p)(Eigen::seqN(1, 4, 2)).sum();
        CHECK(std::abs(coefficients.col(p - 1).sum() / above - 1) <= 1e-13);
    }
}

TEST_CASE("many moments come from the table when that is cheaper", "[mie][phase_table]") {
    mie::EnsembleRequest request;
    request.refractive_index = {1.5, 0.02};
    request.sizes.effective_radius_um = GENERATE(8.0, 0.1);  // many, and a few that are not zero
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

namespace {

// P at an angle from sphere after sphere, midpoints in ln r of the power law (or one size).
double summed_phase(const std::vector<mie::Coefficients>& waves, const std::vector<double>& x,
                    double angle_deg) {
    double intensity = 0, scattered = 0;
    for (std::size_t i = 0; i < waves.size(); ++i) {
        const std::vector<double> angle = {angle_deg};
        const auto s = mie::scattering_amplitudes(waves[i], angle);
        const double weight = 1 / (x[i] * x[i]);  // n r^2 dr = dr / r, uniform in ln r
        intensity += weight * (std::norm(s.s1[0]) + std::norm(s.s2[0]));
        double sum = 0;
        for (std::size_t n = 0; n < waves[i].a.size(); ++n) {
            sum += (2.0 * double(n) + 3) * (std::norm(waves[i].a[n]) + std::norm(waves[i].b[n]));
        }
        scattered += weight * sum;
    }
    return intensity / scattered;
}

}  // namespace

TEST_CASE("noise of a table at wide angles does not brighten its forward peak",
          "[mie][phase_table][rays]") {
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = 14.763;
    request.sizes.effective_variance = 0.058;
    request.refractive_index = {2.7398, 0};
    request.wavelength_nm = 550;
    request.highest_moment = 128;
    mie::EnsembleRequest exact = request;
    exact.tolerance = 5e-6;
    const mie::EnsembleOptics spheres = mie::average_over_sizes(exact);
    const std::vector<double>& truth = spheres.chi;

    // A BRDF at 3e-3 asks for this. Half of the light is in the peak, whose moments are alike.
    request.tolerance = 6e-4;
    request.with_phase_table = true;
    request.phase_tolerance = 3e-2;
    request.table_tolerance = 1.5e-2;
    request.phase_floor = 0.5;
    request.highest_moment = mie::highest_moment_of(request);
    const mie::EnsembleOptics optics = mie::average_over_sizes(request);
    REQUIRE(optics.phase_table->parts().gave_moments);
    // P itself misses that much of the light, or has it twice.
    CHECK(std::abs(optics.phase_table->mean() - 1) >= 1e-4);
    double largest = 0, sum = 0;
    int count = 0;
    for (int l = 66; l <= 128; ++l, ++count) {
        const double error = optics.chi[l] - truth[l];
        largest = std::max(largest, std::abs(error));
        sum += error;
    }
    CAPTURE(largest, sum / count, optics.error_estimate);
    // Noise of single nodes, 1e-2 of P, in the one, and none of it in the other.
    CHECK(largest <= 6e-5);
    CHECK(std::abs(sum / count) <= 1.5e-5 + spheres.error_estimate);
    CHECK(largest <= optics.error_estimate);
}

TEST_CASE("the phase table errs no more than it says at random angles", "[mie][phase_table]") {
    // Truth: spheres summed one by one, over sizes of its own. Forward peak and glory included.
    struct Case {
        double radius_um, variance;
        std::complex<double> index;
    };
    const Case c = GENERATE(Case{4.0, 0.2, {1.5, 0.1}}, Case{4.0, 0.2, {2.9, 0.0}},
                            Case{4.0, 0.2, {1.33, 0.001}}, Case{4.0, 1e-4, {1.5, 0.0}},
                            Case{0.3, 0.05, {2.0, 0.0}}, Case{4.0, 0.0, {1.5, 0.0}});
    mie::EnsembleRequest request;
    request.sizes.effective_radius_um = c.radius_um;
    if (c.variance > 0) request.sizes.effective_variance = c.variance;
    if (c.variance == 0) request.sizes.kind = mie::SizeDistributionKind::mono;
    request.refractive_index = c.index;
    request.tolerance = 1e-3;
    request.phase_tolerance = GENERATE(1e-2, 2e-3);
    request.with_phase_table = true;
    const auto optics = mie::average_over_sizes(request);
    const auto& table = *optics.phase_table;

    const auto range = mie::radius_range(request.sizes);
    const int count = c.variance == 0 ? 1 : 6000;
    std::vector<mie::Coefficients> waves;
    std::vector<double> x;
    for (int i = 0; i < count; ++i) {
        const double share = (i + 0.5) / count;
        const double radius =
            range.smallest_um * std::pow(range.largest_um / range.smallest_um, share);
        x.push_back(2 * pi * radius / 0.55);
        waves.push_back(mie::mie_coefficients(c.index, x.back()));
    }
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<double> angles = {0, 180};
    for (int i = 0; i < 10; ++i) angles.push_back(180 * uniform(generator));
    for (int i = 0; i < 4; ++i) angles.push_back(5 * uniform(generator));
    for (int i = 0; i < 4; ++i) angles.push_back(180 - 5 * uniform(generator));
    for (const double angle : angles) {
        const double truth = summed_phase(waves, x, angle);
        // Errors are relative to the largest P of a panel, 12 degrees wide at most.
        double nearby = 0;
        const double reach = std::min(12.0, 0.5 + 0.5 * std::min(angle, 180 - angle));
        for (int i = -48; i <= 48; ++i) {
            nearby = std::max(nearby, table(std::cos((angle + reach * i / 48) * pi / 180)));
        }
        const double value = table(std::cos(angle * pi / 180));
        CAPTURE(c.radius_um, c.variance, c.index, request.phase_tolerance, angle, value, truth,
                nearby, table.size_error(), table.interpolation_error(), table.angle_count());
        // Twice the estimate at the worst node; single precision 1e-5.
        CHECK(std::abs(value - truth) <=
              (2 * table.size_error() + 2 * table.interpolation_error() + 1e-4) * nearby);
    }
    // Ripple may stop at the finest level, and says so.
    // The tolerance is for the rms over eight nodes, the error for the worst of them.
    if (c.index.imag() == 0.1) CHECK(table.size_error() <= std::sqrt(8) * request.phase_tolerance);
}

TEST_CASE("a phase table states the noise of panels whose families agree by chance",
          "[mie][honesty]") {
    // Three of its panels erred by eight times what their own families differed.
    mie::EnsembleRequest request;
    request.sizes.kind = mie::SizeDistributionKind::gamma;
    request.sizes.effective_radius_um = 1.035;
    request.sizes.effective_variance = 0.15;
    request.refractive_index = {2.0181, 0.06552};
    request.with_phase_table = true;
    request.tolerance = 2e-3;
    request.phase_tolerance = 3e-2;
    request.phase_floor = 0.5;
    const auto table = *mie::average_over_sizes(request).phase_table;
    request.tolerance = 1e-5;
    request.phase_tolerance = 2e-4;
    request.phase_floor = 0.0;
    const auto truth = *mie::average_over_sizes(request).phase_table;
    const auto& edges = table.parts().edges;
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
        double squares = 0, noise = 0;
        constexpr int count = 16;
        for (int i = 0; i < count; ++i) {
            const double theta = edges[p] + (edges[p + 1] - edges[p]) * (i + 0.5) / count;
            squares += std::pow(table(std::cos(theta)) - truth(std::cos(theta)), 2) / count;
            noise = std::max(noise, table.noise(std::cos(theta)));
        }
        CAPTURE(p, edges[p] * 180 / pi, noise);
        // Three standard deviations, and what the interpolation and the finer table leave.
        CHECK(std::sqrt(squares) <= 3 * noise + 1e-3 * table(std::cos(edges[p])));
    }
}
