#include "rte/math/angle_table.h"

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
    const math::AngleTable table(glory_and_cosine, 1e-4, tolerance);
    REQUIRE(table.function_count() == 2);
    const Eigen::Vector2d weights(1.0, -2.0);
    double largest = 0.0;
    for (int i = 0; i <= 5000; ++i) {
        // Denser and denser towards pi, the ends included.
        const double angle = pi * (1.0 - std::pow(1.0 - i / 5000.0, 3));
        const double exact = (glory_and_cosine(Eigen::VectorXd::Constant(1, angle)) * weights)(0);
        largest = std::max(largest, std::abs(table.combined(angle, weights) - exact));
    }
    // Two functions, weights 1 and 2; what follows the last two coefficients is smaller than they.
    CHECK(largest <= 3.0 * tolerance);
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
        0.01, 1e-6);
    CHECK(angles_asked <= 1000);  // 48 panels, and one of them halved three times
    CHECK(std::abs(table.combined(2.0, Eigen::VectorXd::Ones(1)) - 1.0) <= 1e-15);
}
