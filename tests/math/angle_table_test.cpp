#include "rte/math/chebyshev.h"

#include <cmath>
#include <numbers>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

constexpr double pi = std::numbers::pi;

// A sharp glory on a slow background, and a plain cosine.
Eigen::MatrixXd glory_and_cosine(const Eigen::VectorXd& angles) {
    Eigen::MatrixXd values(angles.size(), 2);
    for (Eigen::Index i = 0; i < angles.size(); ++i) {
        const double away = pi - angles[i];
        values(i, 0) = 20.0 * std::exp(-std::pow(away / 0.01, 2)) * std::cos(600.0 * away) +
                       std::sin(3.0 * angles[i]);
        values(i, 1) = std::cos(angles[i]);
    }
    return values;
}

}  // namespace

TEST_CASE("an angle table follows a feature that is much narrower than its first panels",
          "[math][angle_table]") {
    const double tolerance = GENERATE(1e-3, 1e-6, 1e-9);
    const math::AngleTable table(glory_and_cosine, 1e-4, {.absolute = tolerance});
    REQUIRE(table.function_count() == 2);
    Eigen::VectorXd found(2);
    double largest = 0.0;
    for (int i = 0; i <= 5000; ++i) {
        // Denser and denser towards pi, the ends included.
        const double angle = pi * (1.0 - std::pow(1.0 - i / 5000.0, 3));
        table.evaluate(angle, found);
        const Eigen::VectorXd exact =
            glory_and_cosine(Eigen::VectorXd::Constant(1, angle)).transpose();
        largest = std::max(largest, (found - exact).cwiseAbs().maxCoeff());
    }
    // What follows the last two coefficients is smaller than they.
    CHECK(largest <= 2.0 * tolerance);
}

TEST_CASE("panels stop at the narrowest width, whatever the function", "[math][angle_table]") {
    int angles_asked = 0;
    const math::AngleTable table(
        [&](const Eigen::VectorXd& angles) {
            angles_asked += int(angles.size());
            Eigen::MatrixXd steps(angles.size(), 1);
            for (Eigen::Index i = 0; i < angles.size(); ++i) steps(i, 0) = angles[i] < 1.0 ? 0 : 1;
            return steps;
        },
        0.01, {.absolute = 1e-6});
    CHECK(angles_asked <= 1000);  // 48 panels, and one of them halved three times
    Eigen::VectorXd found(1);
    table.evaluate(2.0, found);
    CHECK(std::abs(found[0] - 1.0) <= 1e-15);
}

TEST_CASE("a relative tolerance follows the height of each panel", "[math][angle_table]") {
    // Henyey-Greenstein with g = 0.99: 2e4 forward, 0.0025 backward.
    constexpr double g = 0.99;
    const auto phase = [](double angle) {
        return (1 - g * g) / std::pow(1 + g * g - 2 * g * std::cos(angle), 1.5);
    };
    const double tolerance = 1e-6;
    const math::AngleTable table(
        [&](const Eigen::VectorXd& angles) { return Eigen::MatrixXd(angles.unaryExpr(phase)); },
        1e-6, {.relative = tolerance});
    Eigen::VectorXd found(1);
    double largest = 0.0;
    for (int i = 0; i <= 5000; ++i) {
        const double angle = pi * std::pow(i / 5000.0, 3);
        table.evaluate(angle, found);
        largest = std::max(largest, std::abs(found[0] / phase(angle) - 1));
    }
    // Relative to the largest coefficient of a panel; no panel spans more than a factor of 10.
    CHECK(largest <= 20 * tolerance);
}

TEST_CASE("functions of a table do not change by those beside them", "[math][angle_table]") {
    // Seven are summed four at a time and one by one; one alone in another way.
    const auto functions = [](const Eigen::VectorXd& angles) {
        Eigen::MatrixXd values(angles.size(), 7);
        for (int f = 0; f < 7; ++f) values.col(f) = ((f + 1.0) * angles.array()).cos();
        return values;
    };
    // As narrow as the first panels: no others are made.
    const math::AngleTable together(functions, pi, {});
    Eigen::VectorXd found(7), own(1);
    for (int f = 0; f < 7; ++f) {
        const math::AngleTable alone(
            [&](const Eigen::VectorXd& angles) -> Eigen::MatrixXd {
                return functions(angles).col(f);
            },
            pi, {});
        for (int i = 0; i <= 960; ++i) {  // borders of panels among them
            const double angle = pi * i / 960;
            together.evaluate(angle, found);
            alone.evaluate(angle, own);
            CAPTURE(f, angle);
            CHECK(std::abs(found[f] - own[0]) <= 1e-15 * 8);  // rounding of eight terms below 1
        }
    }
}
