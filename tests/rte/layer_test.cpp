#include "rte/layer/layer.h"

#include <Eigen/LU>
#include <cmath>

#include "rte/half_space/half_space.h"
#include "rte/math/decay_integrals.h"
#include "rte/math/quadrature.h"
#include "tests/rte/fourier_problem.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using support::FourierProblem;

namespace {

/// All problems share a grid.
FourierProblem make_layer_problem(const rte::Optics& optics, int order, int moments,
                                  std::vector<double> mu) {
    return support::make_problem(optics, order, rte::make_mapped_gauss_grid(20), moments,
                                 std::move(mu));
}

rte::LayerOperator solve(const FourierProblem& problem, double tau) {
    return rte::solve_layer(tau, problem.medium, problem.mode, problem.grid, problem.requested);
}

}  // namespace

TEST_CASE("decay integrals agree with quadrature in every regime, equal rates included",
          "[rte][math]") {
    const double x = GENERATE(1e-9, 0.03, 0.7, 1.0, 1.9, 14.0, 300.0);
    const double y = GENERATE(0.0, 1e-9, 0.2, 0.5, 0.7, 1.0, 1.9, 14.0, 299.0);
    const auto integrals = math::decay_integrals(x, y);
    double near = 0.0;
    double far = 0.0;
    for (int panel = 0; panel < 400; ++panel) {  // composite rule: exponents below 1 per panel
        const auto rule = math::gauss_legendre(12, panel / 400.0, (panel + 1) / 400.0);
        for (int k = 0; k < 12; ++k) {
            const double u = rule.nodes[k];
            const auto ratio = [y](double v) {  // sinh(y v) / sinh(y)
                return y < 1e-6
                           ? v
                           : std::exp(-y * (1 - v)) * std::expm1(-2 * y * v) / std::expm1(-2 * y);
            };
            near += rule.weights[k] * x * std::exp(-x * u) * ratio(1 - u);
            far += rule.weights[k] * x * std::exp(-x * u) * ratio(u);
        }
    }
    CAPTURE(x, y);
    // 4800 terms of one sign, and the worst cancellation left in the closed forms (about 10).
    CHECK(std::abs(integrals.near / near - 1.0) <= 1e-13);
    CHECK(std::abs(integrals.far / far - 1.0) <= 1e-12);
    math::DecayIntegrator integrator;
    integrator.set(x, Eigen::VectorXd::Ones(2));
    Eigen::VectorXd nears(2);
    Eigen::VectorXd fars(2);
    integrator.integrate(y, nears, fars);
    CHECK((nears.array() / near - 1.0).abs().maxCoeff() <= 1e-13);
    CHECK((fars.array() / far - 1.0).abs().maxCoeff() <= 1e-12);
}

TEST_CASE("a conservative layer loses nothing: R + T = 1 at any optical depth", "[rte][layer]") {
    const double g = GENERATE(-0.5, 0.0, 0.8);
    const double tau = GENERATE(1e-12, 1e-6, 0.01, 1.0, 37.0, 1e4, 1e8, 1e12);
    const auto problem =
        make_layer_problem(rte::henyey_greenstein_optics(1.0, g), 0, 16, {1e-4, 0.1, 0.7, 1.0});
    const auto layer = solve(problem, tau);
    CAPTURE(g, tau);
    REQUIRE(layer.physical);
    const Eigen::VectorXd D = rte::flux_weights(problem.grid);
    const Eigen::VectorXd total = (layer.reflection + layer.transmission) * D;
    CHECK((total.cwiseQuotient(D).array() - 1.0).abs().maxCoeff() <= 1e-12);
    const Eigen::VectorXd at_requested =
        (layer.reflection_rows + layer.transmission_rows) * D + layer.direct;
    CHECK((at_requested.array() - 1.0).abs().maxCoeff() <= 1e-12);
}

TEST_CASE("two halves doubled are the whole layer", "[rte][layer]") {
    const double alpha = GENERATE(0.0, 0.4, 0.95, 1.0);
    const double tau = GENERATE(1e-8, 0.3, 5.0, 200.0);
    const int order = GENERATE(0, 2);
    const auto problem =
        make_layer_problem(rte::henyey_greenstein_optics(alpha, 0.6), order, 16, {0.02, 0.5, 1.0});
    const auto half = solve(problem, 0.5 * tau);
    const auto whole = solve(problem, tau);
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(20, 20);
    const Eigen::MatrixXd bounces = (identity - half.reflection * half.reflection).inverse();
    const Eigen::MatrixXd R =
        half.reflection + half.transmission * half.reflection * bounces * half.transmission;
    const Eigen::MatrixXd T = half.transmission * bounces * half.transmission;
    CAPTURE(alpha, tau, order);
    // The inverse of 1 - R^2 amplifies rounding by up to tau in a conservative layer.
    CHECK((whole.reflection - R).cwiseAbs().maxCoeff() <= 1e-12);
    CHECK((whole.transmission - T).cwiseAbs().maxCoeff() <= 1e-12);
}

TEST_CASE("an absorbing layer without scattering transmits exp(-tau/mu) and reflects nothing",
          "[rte][layer]") {
    const auto problem = make_layer_problem(rte::isotropic_optics(0.0), 0, 1, {0.05, 1.0});
    const double tau = GENERATE(1e-10, 0.1, 3.0, 1e3);
    const auto layer = solve(problem, tau);
    const Eigen::VectorXd direct = (-tau / problem.grid.mu.array()).exp();
    // Products of matrices whose entries cancel to a diagonal: rounding of numbers of order one.
    CHECK(layer.reflection.cwiseAbs().maxCoeff() <= 1e-14);
    CHECK((layer.transmission - Eigen::MatrixXd(direct.asDiagonal())).cwiseAbs().maxCoeff() <=
          1e-14);
    CHECK(layer.reflection_rows.cwiseAbs().maxCoeff() == 0.0);
    CHECK(layer.multiple.cwiseAbs().maxCoeff() == 0.0);
}

TEST_CASE("a layer that nothing comes through is the half-space", "[rte][layer]") {
    const double alpha = GENERATE(0.2, 0.9, 0.999);
    const int order = GENERATE(0, 4);
    const auto problem =
        make_layer_problem(rte::henyey_greenstein_optics(alpha, 0.7), order, 16, {0.001, 0.4, 1.0});
    const auto layer = solve(problem, 5000.0);
    const auto half_space = rte::solve_half_space(rte::HalfSpaceMethod::automatic, problem.medium,
                                                  problem.mode, problem.grid, problem.requested);
    // exp(-2 k tau) with k >= 0.03 is below 1e-100: rounding only, and the half-space's last sweep.
    CHECK((layer.reflection - half_space.nodes).cwiseAbs().maxCoeff() <= 1e-13);
    CHECK((layer.reflection_rows - half_space.rows).cwiseAbs().maxCoeff() <= 1e-12);
    CHECK((layer.multiple - half_space.multiple).cwiseAbs().maxCoeff() <=
          1e-12 * half_space.multiple.cwiseAbs().maxCoeff());
}
