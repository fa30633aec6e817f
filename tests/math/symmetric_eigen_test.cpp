#include "rte/math/matrices.h"

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("eigenpairs of a chain of springs are sines", "[math]") {
    math::SymmetricEigen solver;
    const int n = GENERATE(1, 2, 5, 128, 200);
    Eigen::MatrixXd chain = Eigen::MatrixXd::Zero(n, n);  // lower triangle only: all that is read
    chain.diagonal().setConstant(2.0);
    chain.diagonal(-1).setConstant(-1.0);
    REQUIRE(solver.compute(chain));
    REQUIRE(solver.values().size() == n);
    REQUIRE(solver.vectors().cols() == n);
    for (int k = 0; k < n; ++k) {
        const double angle = (k + 1) * 3.14159265358979323846 / (n + 1);
        const double sine = std::sin(0.5 * angle);
        // Backward stable: a few times n roundings of the largest eigenvalue, 4.
        CHECK(std::abs(solver.values()[k] - 4.0 * sine * sine) <= 4.0 * n * 2.3e-16);
        const Eigen::VectorXd vector = solver.vectors().col(k);
        const Eigen::VectorXd image =
            chain.selfadjointView<Eigen::Lower>() * vector - solver.values()[k] * vector;
        CHECK(image.norm() <= 16.0 * n * 2.3e-16);
        CHECK(std::abs(vector.norm() - 1.0) <= n * 2.3e-16);
    }
}
