// Azimuthal orders in which little is scattered, and coats that nothing comes through.
#include "rte/fourier/eigenmodes.h"
#include "rte/layer/layer.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("modes refined from the nodes give the layer that the eigenproblem gives",
          "[rte][layer]") {
    constexpr int moments = 64;
    const auto scaled = rte::scale_optics(rte::henyey_greenstein_optics(0.95, 0.8), moments, true);
    const auto grid = rte::make_mapped_gauss_grid(32);
    rte::RequestedDirections requested;
    requested.mu = Eigen::Vector3d(0.05, 0.6, 1.0);
    requested.in = requested.out = {0, 1, 2};
    const double tolerance = GENERATE(1e-5, 1e-6, 1e-7);
    const double tau = GENERATE(0.01, 1.0, 30.0);
    bool is_refined = false;
    rte::LegendreSampling sampling;
    for (int order = 14; order < 40; ++order) {
        rte::FourierMode mode;
        rte::make_fourier_mode(order, moments, grid, requested, sampling, mode);
        const rte::FourierMedium medium{scaled.strengths().tail(moments - order),
                                        scaled.one_minus_albedo, order};
        const auto exact = rte::solve_layer(tau, medium, mode, grid, requested);
        rte::FourierWork work;
        rte::LayerOperator layer;
        rte::solve_layer(tau, medium, mode, grid, requested, rte::ReflectorParts::nodes, tolerance,
                         work, layer);
        CAPTURE(order, tolerance, tau);
        REQUIRE(layer.physical);
        const auto agrees = [&](const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
            is_refined = is_refined || one != other;
            CHECK((one - other).cwiseAbs().maxCoeff() <= tolerance);
        };
        agrees(layer.reflection, exact.reflection);
        agrees(layer.transmission, exact.transmission);
        agrees(layer.reflection_rows, exact.reflection_rows);
        agrees(layer.multiple, exact.multiple);
    }
    CHECK(is_refined);
}

TEST_CASE("a deep coat cut in two, so that no part hides the base, reflects the same",
          "[rte][layered]") {
    const double albedo = GENERATE(0.0, 0.5, 0.9, 1.0);
    const double tau = GENERATE(8.0, 12.0, 20.0);
    const auto coat = rte::henyey_greenstein_optics(albedo, 0.6);
    const rte::Optics base = rte::henyey_greenstein_optics(0.99, 0.3);
    const rte::Stack whole{.base = base, .coats = {{coat, tau}}};
    rte::Stack cut{.base = base};
    constexpr int pieces = 4;
    for (int k = 0; k < pieces; ++k) cut.coats.push_back({coat, tau / pieces});
    const rte::Directions directions{{0.1, 0.5, 1.0}, {0.05, 0.3, 0.7, 1.0}, {0.0, 60.0, 180.0}};
    for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
        const rte::SolverOptions options{.tolerance = tolerance, .streams = 24};
        const auto one = rte::reflect(whole, directions, options);
        const auto other = rte::reflect(cut, directions, options);
        CAPTURE(albedo, tau, tolerance);
        for (std::size_t k = 0; k < one.reflection.size(); ++k) {
            // Each order is solved to a hundredth of the tolerance; both end their sums at a
            // quarter of it, which both end alike.
            CHECK(std::abs(one.reflection[k] - other.reflection[k]) <= 0.05 * tolerance);
        }
    }
}

TEST_CASE("a dark coat shows its base as long as that is not darker", "[rte][layered]") {
    // Cut in pieces, no one of which could hide anything; relative to what comes out.
    const double albedo = GENERATE(0.0, 0.001, 0.2);
    const auto coat = rte::henyey_greenstein_optics(albedo, 0.8);
    const double tau = GENERATE(6.5, 8.25);
    const rte::Stack whole{.base = rte::isotropic_optics(1.0), .coats = {{coat, tau}}};
    rte::Stack cut{.base = whole.base};
    for (int k = 0; k < 8; ++k) cut.coats.push_back({coat, tau / 8});
    const rte::Directions directions{{1.0}, {1.0, 0.6}, {180.0}};
    const rte::SolverOptions options{.tolerance = 1e-3, .streams = 24};
    const auto one = rte::reflect(whole, directions, options).reflection;
    const auto other = rte::reflect(cut, directions, options).reflection;
    CAPTURE(albedo, tau, one[0], other[0]);
    for (std::size_t k = 0; k < one.size(); ++k)
        CHECK(std::abs(one[k] / other[k] - 1) <= 0.05 * options.tolerance);
}
