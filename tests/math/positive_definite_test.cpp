#include "rte/math/matrices.h"

#include <Eigen/Dense>
#include <cmath>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

// Graded like the matrices of a zenith grid: the diagonal falls from `highest` to 1.
Eigen::MatrixXd graded(int n, double highest) {
    Eigen::MatrixXd A(n, n);
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            A(i, j) = std::pow(highest, 1.0 - 0.5 * (i + j) / n) *
                      (std::exp(-std::abs(i - j)) + (i == j ? 1.0 : 0.0));
        }
    }
    return A;
}

}  // namespace

TEST_CASE("the inverse of a positive definite matrix is its inverse and symmetric", "[math]") {
    const int n = GENERATE(1, 2, 15, 16, 17, 32, 33, 64, 100);
    const double highest = GENERATE(1.0, 1e8);
    const Eigen::MatrixXd A = graded(n, highest);
    Eigen::MatrixXd work = A;
    Eigen::MatrixXd inverse;
    REQUIRE(math::invert_positive_definite(work, inverse));
    CAPTURE(n, highest);
    CHECK((inverse - inverse.transpose()).cwiseAbs().maxCoeff() == 0.0);
    // Scaled to a unit diagonal the condition number is below 10; n products of rounding.
    const Eigen::VectorXd scale = A.diagonal().cwiseSqrt();
    const Eigen::MatrixXd unit = scale.asDiagonal().inverse() * (A * inverse) * scale.asDiagonal();
    CHECK((unit - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff() <= 1e-15 * (10 + n));
}

TEST_CASE("a matrix that is not positive definite has no such inverse", "[math]") {
    Eigen::MatrixXd A = graded(20, 1.0);
    A(7, 7) = -1.0;
    Eigen::MatrixXd inverse;
    CHECK_FALSE(math::invert_positive_definite(A, inverse));
    A = graded(20, 1.0);
    A(3, 3) = std::nan("");
    CHECK_FALSE(math::invert_positive_definite(A, inverse));
}

TEST_CASE("scratch keeps its memory when it shrinks and grows back", "[math]") {
    Eigen::MatrixXd scratch(Eigen::MatrixXd::Constant(8, 8, 3.0));
    const double* memory = scratch.data();
    scratch.resize(2, 5);
    CHECK(scratch.cols() == 5);
    scratch = Eigen::MatrixXd::Identity(4, 4);
    CHECK((scratch - Eigen::MatrixXd::Identity(4, 4)).norm() == 0.0);
    scratch.resize(8, 8);
    CHECK(scratch.data() == memory);
    const Eigen::MatrixXd copy = scratch;
    CHECK(copy.data() != memory);
    Eigen::VectorXd vector;
    CHECK(vector.size() == 0);
    vector = Eigen::VectorXd::Ones(3);
    CHECK(vector.sum() == 3.0);
}
