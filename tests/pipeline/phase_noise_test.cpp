#include "pipeline/solve/phase_noise.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <miebrdf/ensemble.h>
#include "pipeline/solve/brdf.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

// P = 1 everywhere, in two panels whose noise differs.
rte::Optics noisy_isotropic(double albedo, double forward, double backward) {
    rte::Optics optics = rte::isotropic_optics(albedo);
    constexpr double pi = std::numbers::pi;
    const std::vector<double> one = {1, 0, 0, 0, 0, 0, 0, 0};  // the Chebyshev polynomial T_0
    std::vector<double> both = one;
    both.insert(both.end(), one.begin(), one.end());
    optics.phase = mie::PhaseTable(mie::PhaseTable::Parts{
        .edges = {0, pi / 2, pi}, .coefficients = both, .noise = {forward, backward}});
    return optics;
}

Request request_of(double index, double radius_um) {
    Request request;
    request.scene.base = parse_medium(fmt::format("index:{},0", index));
    request.scene.particles.sizes.effective_radius_um = radius_um;
    request.wavelength_nm = {550};
    request.directions = {{0.3, 0.7, 1.0}, {0.2, 0.5, 0.9}, {0, 45, 90, 135, 180}};
    request.solver.streams = 16;
    return request;
}

}  // namespace

TEST_CASE("noise of P comes through single scattering", "[pipeline][noise]") {
    const double albedo = 0.8, mu_in = 0.5, mu_out = 0.25;
    const rte::Directions towards_source{{mu_in}, {mu_out}, {180}};
    const rte::Stack base{.base = noisy_isotropic(albedo, 0.5, 0.01)};
    const double R = 0.3;
    const double direct = albedo * 0.01 / (4 * (mu_in + mu_out)) / R;
    const PhaseNoise noise = largest_phase_noise(base, towards_source, {R}, 32);
    CHECK(std::abs(noise.largest / direct - 1) <= 1e-12);
    CHECK(noise.mu_in == mu_in);
    CHECK(noise.mu_out == mu_out);
    CHECK(noise.azimuth_deg == 180);
    // Of a coat only what its depth scatters.
    const double depth = 0.1;
    const rte::Stack coat{.coats = {{noisy_isotropic(albedo, 0.5, 0.01), depth}},
                          .base_kind = rte::BaseKind::none};
    const double share = 1 - std::exp(-depth * (1 / mu_in + 1 / mu_out));
    const PhaseNoise of_coat = largest_phase_noise(coat, towards_source, {R}, 32);
    CHECK(std::abs(of_coat.largest / (direct * share) - 1) <= 1e-12);
    // Formulas have none.
    const rte::Stack formula{.base = rte::henyey_greenstein_optics(0.9, 0.5)};
    CHECK(largest_phase_noise(formula, towards_source, {R}, 32).largest == 0);
}

TEST_CASE("the noise that a result states covers its change with more sizes", "[pipeline][noise]") {
    const auto [index, radius_um] =
        GENERATE(table<double, double>({{1.5, 5}, {2.6, 5}, {1.33, 10}}));
    CAPTURE(index, radius_um);
    Request request = request_of(index, radius_um);
    const SpectralSlice slice = compute_brdf(request).slices[0];
    request.scene.particles.tolerance = 1e-5;  // P to 5e-4
    const SpectralSlice finer = compute_brdf(request).slices[0];
    REQUIRE(slice.phase_noise.largest > 0);
    CHECK(finer.phase_noise.largest <= 0.5 * slice.phase_noise.largest);
    const std::size_t per_incidence = slice.total.size() / request.directions.mu_in.size();
    double largest = 0;
    for (std::size_t first = 0; first < slice.total.size(); first += per_incidence) {
        double brightest = 0, change = 0;
        for (std::size_t i = first; i < first + per_incidence; ++i) {
            brightest = std::max(brightest, finer.total[i]);
            change = std::max(change, std::abs(slice.total[i] - finer.total[i]));
        }
        largest = std::max(largest, change / brightest);
    }
    // Three times an rms, and what the moments may change.
    CHECK(largest <= 3 * slice.phase_noise.largest + 2 * slice.mie_error_estimate);
}
