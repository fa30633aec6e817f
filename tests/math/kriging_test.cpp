// Kriging of scattered points.
#include "rte/math/kriging.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace miebrdf::math;

namespace {

const Eigen::ArrayXd kLength = Eigen::ArrayXd::Ones(1);

/// Points of a lattice that is shifted in each row, with a function that is symmetric in its two
/// coordinates.
double symmetric(double x, double y) { return std::sin(2.0 * x * y) + x + y; }

ScatteredPoints lattice(int n) {
    ScatteredPoints points{Eigen::MatrixXd(n * n, 2), Eigen::MatrixXd(n * n, 2),
                           Eigen::MatrixXd(n * n, 2)};
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            const double x = (i + 0.5 * (k % 2)) / n, y = double(k) / n;
            const Eigen::Index row = i * n + k;
            points.at.row(row) << x, y;
            points.trend.row(row) << 1.0, x + y;
            points.values.row(row) << symmetric(x, y), 2.0 + 3.0 * (x + y);
        }
    }
    return points;
}

Eigen::RowVectorXd at(const Kriging& kriging, double x, double y) {
    return kriging.evaluate(Eigen::RowVector2d(x, y), Eigen::RowVector2d(1.0, x + y));
}

}  // namespace

TEST_CASE("kriging finds a smooth function between its points, and its trend beyond",
          "[math][kriging]") {
    const ScatteredPoints points = lattice(9);
    const Kriging kriging(points, {kLength * 0.7, 1e-9});
    // A cell of the lattice is 1/9; the interpolation is of third order in it and more. The nugget
    // makes covariances of condition 1e11: rounding leaves 1e-5 of what the trend has exactly.
    for (const auto& [x, y] : {std::pair(0.31, 0.47), {0.72, 0.18}, {0.55, 0.55}}) {
        CHECK(std::abs(at(kriging, x, y)[0] - symmetric(x, y)) <= 2e-4);
        CHECK(std::abs(at(kriging, x, y)[1] - (2.0 + 3.0 * (x + y))) <= 1e-4);
        CHECK(std::abs(at(kriging, x, y)[0] - at(kriging, y, x)[0]) <= 1e-12);  // symmetric
    }
    CHECK(std::abs(at(kriging, 20.0, 30.0)[1] - 152.0) <= 1e-3);
    CHECK(kriging.residuals().cwiseAbs().maxCoeff() <= 1e-6);
}

TEST_CASE("leaving a value out in closed form is the same as leaving it out", "[math][kriging]") {
    const ScatteredPoints points = lattice(5);
    const KrigingKernel kernel{kLength * 0.6, 1e-2};
    const Kriging all(points, kernel);
    for (const Eigen::Index left_out : {0, 7, 24}) {
        std::vector<Eigen::Index> kept;
        for (Eigen::Index i = 0; i < points.at.rows(); ++i)
            if (i != left_out) kept.push_back(i);
        const Kriging others({points.at(kept, Eigen::all), points.trend(kept, Eigen::all),
                              points.values(kept, Eigen::all)},
                             kernel);
        const Eigen::RowVectorXd found =
            others.evaluate(points.at.row(left_out), points.trend.row(left_out));
        for (Eigen::Index c = 0; c < 2; ++c) {
            CHECK(all.leave_one_out()(left_out, c) ==
                  Approx(points.values(left_out, c) - found[c]).margin(1e-10));
        }
    }
}

TEST_CASE("the fitted kernel tells noise from what varies", "[math][kriging]") {
    ScatteredPoints points = lattice(10);
    double state = 0.5;
    for (Eigen::Index i = 0; i < points.values.rows(); ++i) {
        state = std::fmod(state * 997.0 + 0.123, 1.0);  // uniform in [0, 1): sigma .029
        points.values(i, 0) += 0.1 * (state - 0.5);
    }
    points.values = points.values.leftCols(1).eval();
    const Kriging kriging(points, fitted_kernel(points));
    const double left_out =
        std::sqrt(kriging.leave_one_out().squaredNorm() / double(points.values.rows()));
    // Neither less than the noise, nor much more: 100 points determine a few numbers.
    CHECK(left_out >= 0.024);
    CHECK(left_out <= 0.036);
    CHECK(std::abs(at(kriging, 0.4, 0.3)[0] - symmetric(0.4, 0.3)) <= 0.03);
}

TEST_CASE("lists that do not fit are refused by kriging", "[math][kriging][errors]") {
    ScatteredPoints points = lattice(3);
    CHECK_THROWS_AS(Kriging(points, {Eigen::Array2d::Ones(), 1e-3}), std::invalid_argument);
    points.trend = Eigen::MatrixXd::Ones(9, 9);
    CHECK_THROWS_AS(Kriging(points, {kLength, 1e-3}), std::invalid_argument);
}
