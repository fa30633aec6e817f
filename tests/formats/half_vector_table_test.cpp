#include "pipeline/formats/rgl/half_vector_table.h"

#include <numbers>

#include "tests/support/catch.h"

using namespace miebrdf::exports;

namespace {

constexpr double kPi = std::numbers::pi;

/// Integral over the lit part of the square (x, y) of the interpolated table, per solid angle of
/// outgoing directions, by midpoints in each cell.
double light(const Eigen::Vector3d& in, const std::vector<double>& values, std::size_t n) {
    constexpr std::size_t kPoints = 8;
    const std::size_t side = (n - 1) * kPoints;
    double sum = 0.0;
    for (std::size_t i = 0; i < side; ++i) {
        for (std::size_t j = 0; j < side; ++j) {
            const double y = (double(i) + 0.5) / kPoints, x = (double(j) + 0.5) / kPoints;
            const std::size_t r = i / kPoints, c = j / kPoints;
            const double t = y - double(r), s = x - double(c);
            const double u = x / double(n - 1), theta = u * u * kPi / 2;
            const Eigen::Vector3d half = spherical(theta, (2 * y / double(n - 1) - 1) * kPi);
            if (!(mirrored(in, half).z() > 0)) continue;
            const double value =
                (1 - t) * ((1 - s) * values[r * n + c] + s * values[r * n + c + 1]) +
                t * ((1 - s) * values[(r + 1) * n + c] + s * values[(r + 1) * n + c + 1]);
            sum += value * 2 * kPi * kPi * u * std::sin(theta) * 4 * in.dot(half);
        }
    }
    return sum / double(side * side);
}

}  // namespace

TEST_CASE("a white Lambertian surface keeps its albedo on a half-vector table of any fineness",
          "[exports][half_vector_table]") {
    const double mu_in = GENERATE(0.05, 0.2, 0.6, 1.0);
    const auto [n, bound] =
        GENERATE(std::pair<std::size_t, double>{16, 0.03}, std::pair<std::size_t, double>{32, 3e-3},
                 std::pair<std::size_t, double>{64, 1e-3});
    const Eigen::Vector3d in = spherical(std::acos(mu_in), 0.0);
    const HalfVectorTable table(n, in);
    std::vector<double> values(table.size(), 0.0);
    for (std::size_t node = 0; node < table.size(); ++node)
        values[node] = table.outgoing(node).z() / kPi;
    table.fit(values);
    CAPTURE(mu_in, n);
    // Nodes alone, with zeros below the horizon: up to 4e-2, 1e-2 and 3e-3.
    CHECK(std::abs(light(in, values, n) - 1.0) <= bound);
    CHECK(std::all_of(values.begin(), values.end(), [](double v) { return v >= 0.0; }));
}

TEST_CASE("half vectors whose outgoing direction is below the horizon hold nothing",
          "[exports][half_vector_table]") {
    const HalfVectorTable table(24, spherical(1.2, 0.0));
    std::vector<double> values(table.size(), 0.0);
    for (const std::size_t node : table.needed()) values[node] = table.outgoing(node).z();
    table.fit(values);
    for (std::size_t node = 0; node < table.size(); ++node) {
        CAPTURE(node, table.outgoing(node).z());
        CHECK((values[node] > 0.0) == (table.outgoing(node).z() > 0.0));
    }
}
