// Sums of Legendre polynomials.
#include "rte/math/legendre.h"

#include <cmath>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("sums of several functions of many arguments are series one by one", "[math]") {
    const int functions = GENERATE(1, 4, 5, 12, 13, 30);
    const int degrees = GENERATE(0, 1, 2, 400);
    const int arguments = GENERATE(1, 16, 37);
    Eigen::MatrixXd weights(functions, degrees);
    for (int j = 0; j < functions; ++j)
        for (int l = 0; l < degrees; ++l) weights(j, l) = std::cos(1.7 * j + 0.3 * l) / (1.0 + l);
    // Some have few degrees, one none.
    if (degrees == 400) {
        for (int j = 7; j < functions; j += j % 3 + 1) weights.row(j).tail(j % 2 ? 360 : 120) *= 0;
        if (functions > 8) weights.row(8) *= 0;
    }
    Eigen::VectorXd x(arguments);
    for (int i = 0; i < arguments; ++i) x[i] = std::cos(3.1415 * i / arguments);
    const Eigen::MatrixXd sums = math::legendre_sums(weights, x);
    REQUIRE(sums.rows() == arguments);
    REQUIRE(sums.cols() == functions);
    double largest = 0.0;
    for (int j = 0; j < functions; ++j) {
        std::vector<double> chi;
        for (int l = 0; l < degrees; ++l) chi.push_back(weights(j, l) / (2.0 * l + 1.0));
        for (int i = 0; i < arguments; ++i)
            largest = std::max(largest, std::abs(sums(i, j) - math::legendre_series(chi, x[i])));
    }
    CHECK(largest <= 1e-12);  // rounding; near x = 1 both recurrences lose some digits
}

TEST_CASE("a sum of Legendre polynomials is the generating function", "[math]") {
    const double r = 0.7;
    Eigen::MatrixXd weights(1, 200);  // 0.7^200 = 1e-31
    for (int l = 0; l < 200; ++l) weights(0, l) = std::pow(r, l);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(21, -1.0, 1.0);
    const Eigen::MatrixXd sums = math::legendre_sums(weights, x);
    for (Eigen::Index i = 0; i < x.size(); ++i)
        CHECK(sums(i, 0) == Approx(1.0 / std::sqrt(1.0 - 2.0 * r * x[i] + r * r)).epsilon(1e-13));
}
