#include "rte/half_space/half_space.h"

#include <cmath>

#include "tests/rte/fourier_problem.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"

using namespace miebrdf;
using rte::HalfSpaceMethod;
using support::FourierProblem;
using support::make_problem;

namespace {

rte::Reflector solve(HalfSpaceMethod method, const FourierProblem& problem,
                     double tolerance = 1e-13) {
    return rte::solve_half_space(method, problem.medium, problem.mode, problem.grid,
                                 problem.requested, tolerance);
}

// (mu + mu') R at the nodes: bounded, so that a difference means the same everywhere.
double largest_bounded_difference(const FourierProblem& problem, const Eigen::MatrixXd& X,
                                  const Eigen::MatrixXd& other) {
    const Eigen::VectorXd D = rte::flux_weights(problem.grid);
    double largest = 0.0;
    for (Eigen::Index p = 0; p < X.rows(); ++p) {
        for (Eigen::Index q = 0; q < X.cols(); ++q) {
            largest = std::max(largest, std::abs(X(p, q) - other(p, q)) / (2.0 * D[p] * D[q]) *
                                            (problem.grid.mu[p] + problem.grid.mu[q]));
        }
    }
    return largest;
}

}  // namespace

TEST_CASE("isotropic half-space is alpha H H' / (4 (mu + mu')) with Chandrasekhar's H",
          "[rte][half_space]") {
    const support::ReferenceTable table("rte/chandrasekhar_H_isotropic.csv");
    for (std::size_t row = 0; row < table.size(); ++row) {
        const double alpha = table.number(row, "albedo");
        const double mu = table.number(row, "mu");
        const double H = table.number(row, "H");
        const auto problem =
            make_problem(rte::isotropic_optics(alpha), 0, rte::make_mapped_gauss_grid(32), 1, {mu});
        const auto half_space = solve(HalfSpaceMethod::automatic, problem);
        CAPTURE(alpha, mu);
        // H^2 - 1 is what lies beyond single scattering; 32 mapped nodes are converged to rounding.
        const double expected = alpha * (H * H - 1.0) / (8.0 * mu);
        CHECK(std::abs(half_space.multiple(0, 0) - expected) <= 1e-12 * alpha * H * H / (8.0 * mu));
    }
}

TEST_CASE("closed form, fixed point and doubling find the same reflection", "[rte][half_space]") {
    const double alpha = GENERATE(0.0, 0.3, 0.9, 0.99);
    const double g = GENERATE(-0.6, 0.0, 0.75);
    const int order = GENERATE(0, 1, 5);
    const auto grid = GENERATE(0, 1, 2);
    const auto problem = make_problem(rte::henyey_greenstein_optics(alpha, g), order,
                                      grid == 0   ? rte::make_gauss_grid(12)
                                      : grid == 1 ? rte::make_mapped_gauss_grid(12)
                                                  : rte::make_paper_grid(12),
                                      16, {0.01, 0.3, 1.0});
    const auto closed = solve(HalfSpaceMethod::automatic, problem);
    const auto iterated = solve(HalfSpaceMethod::fixed_point, problem);
    const auto doubled = solve(HalfSpaceMethod::doubling, problem);
    CAPTURE(alpha, g, order, grid, iterated.iterations, doubled.iterations);
    REQUIRE(closed.physical);
    REQUIRE(iterated.converged);
    REQUIRE(doubled.converged);
    // Iterations stop at 1e-13; the doubled layer has lost about 1e-11 to bouncing near albedo 1.
    CHECK(largest_bounded_difference(problem, closed.nodes, iterated.nodes) <= 2e-12);
    CHECK(largest_bounded_difference(problem, closed.nodes, doubled.nodes) <= 1e-10);
    // Requested cosines come from eigenmodes in one method and from linear systems in the others.
    CHECK((closed.rows - iterated.rows).cwiseAbs().maxCoeff() <= 2e-12);
    CHECK((closed.multiple - doubled.multiple).cwiseAbs().maxCoeff() <= 1e-9);
}

TEST_CASE("requested cosines that happen to be nodes get the nodes' reflection",
          "[rte][half_space]") {
    // Five moments: 16 mapped nodes integrate the product of any two degrees exactly, so that what
    // a node sees of them is the value there.
    const auto grid = rte::make_mapped_gauss_grid(16);
    const std::vector<double> mu(grid.mu.data(), grid.mu.data() + grid.size());
    const int order = GENERATE(0, 3);
    const auto problem = make_problem(rte::henyey_greenstein_optics(0.97, 0.7), order, grid, 5, mu);
    const auto half_space = solve(HalfSpaceMethod::automatic, problem);
    const Eigen::VectorXd D = rte::flux_weights(grid);
    // Two different formulas for one number; rounding only.
    CHECK((D.asDiagonal() * half_space.rows - half_space.nodes).cwiseAbs().maxCoeff() <= 1e-13);
}

TEST_CASE("a conservative half-space returns all light, with any grid and number of nodes",
          "[rte][half_space]") {
    const int n = GENERATE(2, 3, 8, 33, 64, 128, 256);
    const auto kind =
        GENERATE(rte::GridKind::gauss, rte::GridKind::mapped_gauss, rte::GridKind::paper);
    const double g = GENERATE(0.0, 0.8);
    const auto problem =
        make_problem(rte::henyey_greenstein_optics(1.0, g), 0, rte::make_zenith_grid(kind, n),
                     g == 0 ? 1 : n, {1e-4, 0.5, 1.0});
    const auto half_space = solve(HalfSpaceMethod::automatic, problem);
    CAPTURE(n, g, int(kind));
    REQUIRE(half_space.physical);
    const Eigen::VectorXd D = rte::flux_weights(problem.grid);
    const Eigen::VectorXd at_nodes = (half_space.nodes * D).cwiseQuotient(D);
    const Eigen::VectorXd at_requested = half_space.rows * D;
    // Sums of n rounded terms. At the nodes themselves the division by D magnifies rounding: the
    // smallest weight of 256 mapped nodes is 1e-9.
    // Nodes that see projected functions add one more sum.
    const double node_bound = n <= 48 || kind == rte::GridKind::gauss ? 1e-12 : 3e-8;
    const double requested_bound = n <= 128 ? 1e-12 : 3e-12;
    CHECK((at_nodes.array() - 1.0).abs().maxCoeff() <= node_bound);
    CHECK((at_requested.array() - 1.0).abs().maxCoeff() <= requested_bound);
    CHECK((half_space.nodes - half_space.nodes.transpose()).cwiseAbs().maxCoeff() == 0.0);
}

TEST_CASE("absorption of 1e-15 to 1e-3 darkens as the square root (van de Hulst)",
          "[rte][half_space]") {
    const double absorption = GENERATE(1e-15, 1e-12, 1e-9, 1e-6, 1e-4);
    rte::Optics optics = rte::isotropic_optics(1.0);
    optics.single_scattering_albedo = 1.0 - absorption;
    optics.one_minus_albedo = absorption;
    const auto problem = make_problem(optics, 0, rte::make_mapped_gauss_grid(32), 1, {1.0});
    const auto half_space = solve(HalfSpaceMethod::automatic, problem);
    const Eigen::VectorXd D = rte::flux_weights(problem.grid);
    const double dark = 1.0 - D.dot(half_space.nodes * D) / D.squaredNorm();
    // 1 - A = 4/sqrt(3) s + O(s^2), s = sqrt(1 - alpha); a rounding of 1 - A itself is 1e-15.
    const double leading = 4.0 / std::sqrt(3.0) * std::sqrt(absorption);
    CHECK(std::abs(dark - leading) <= 4.0 * absorption + 4e-15);
}

namespace {

// Without delta-M.
FourierProblem sharp_peak(const rte::ZenithGrid& grid, int moments) {
    const auto optics = rte::henyey_greenstein_optics(1.0, 0.99);
    FourierProblem problem = make_problem(optics, 0, grid, moments, {0.5});
    const auto raw = rte::scale_optics(optics, moments, false);
    problem.medium = {raw.strengths(), raw.one_minus_albedo};
    return problem;
}

}  // namespace

TEST_CASE("8 nodes carry any number of moments of a peak that they cannot resolve",
          "[rte][half_space]") {
    const int moments = GENERATE(8, 16, 64, 400);
    const auto kind =
        GENERATE(rte::GridKind::gauss, rte::GridKind::mapped_gauss, rte::GridKind::paper);
    const auto problem = sharp_peak(rte::make_zenith_grid(kind, 8), moments);
    const auto half_space = solve(HalfSpaceMethod::automatic, problem);
    CAPTURE(moments, int(kind));
    REQUIRE(half_space.physical);
    const Eigen::VectorXd D = rte::flux_weights(problem.grid);
    CHECK(std::abs((half_space.rows * D)[0] - 1.0) <= 1e-12);
}

TEST_CASE("moments that the grid cannot carry are refused, not answered", "[rte][half_space]") {
    // Point values at 8 nodes of 16 moments: no physical solution exists.
    rte::ZenithGrid points = rte::make_gauss_grid(8);
    points.panels.clear();
    CHECK_FALSE(solve(HalfSpaceMethod::automatic, sharp_peak(points, 16)).physical);
}
