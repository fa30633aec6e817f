// The tensor file and the half-vector tables that it is made of.
#include <algorithm>
#include <cstring>
#include <numbers>

#include "pipeline/formats/common/tensor_reader.h"
#include "pipeline/formats/rgl/half_vector_table.h"
#include "pipeline/formats/rgl/tables.h"
#include "tests/support/catch.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;
using support::material;
using support::written_file;

namespace {

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
            const double u = x / double(n - 1), theta = u * u * std::numbers::pi / 2;
            const Eigen::Vector3d half =
                spherical(theta, (2 * y / double(n - 1) - 1) * std::numbers::pi);
            if (!(mirrored(in, half).z() > 0)) continue;
            const double value =
                (1 - t) * ((1 - s) * values[r * n + c] + s * values[r * n + c + 1]) +
                t * ((1 - s) * values[(r + 1) * n + c] + s * values[(r + 1) * n + c + 1]);
            sum += value * 2 * std::numbers::pi * std::numbers::pi * u * std::sin(theta) * 4 *
                   in.dot(half);
        }
    }
    return sum / double(side * side);
}

}  // namespace

TEST_CASE("a white Lambertian surface keeps its albedo on a half-vector table of any fineness",
          "[formats][half_vector_table]") {
    const double mu_in = GENERATE(0.05, 0.2, 0.6, 1.0);
    const auto [n, bound] =
        GENERATE(std::pair<std::size_t, double>{16, 0.03}, std::pair<std::size_t, double>{32, 3e-3},
                 std::pair<std::size_t, double>{64, 1e-3});
    const Eigen::Vector3d in = spherical(std::acos(mu_in), 0.0);
    const HalfVectorTable table(n, in);
    std::vector<double> values(table.size(), 0.0);
    for (std::size_t node = 0; node < table.size(); ++node)
        values[node] = table.outgoing(node).z() / std::numbers::pi;
    table.fit(values);
    CAPTURE(mu_in, n);
    // Nodes alone, with zeros below the horizon: up to 4e-2, 1e-2 and 3e-3.
    CHECK(std::abs(light(in, values, n) - 1.0) <= bound);
    CHECK(std::all_of(values.begin(), values.end(), [](double v) { return v >= 0.0; }));
}

TEST_CASE("half vectors whose outgoing direction is below the horizon hold nothing",
          "[formats][half_vector_table]") {
    const HalfVectorTable table(24, spherical(1.2, 0.0));
    std::vector<double> values(table.size(), 0.0);
    for (const std::size_t node : table.needed()) values[node] = table.outgoing(node).z();
    table.fit(values);
    for (std::size_t node = 0; node < table.size(); ++node) {
        CAPTURE(node, table.outgoing(node).z());
        CHECK((values[node] > 0.0) == (table.outgoing(node).z() > 0.0));
    }
}

namespace {

std::string spectral_file(int resolution) {
    return written_file("rgl", material(), {.resolution = resolution});
}

}  // namespace

TEST_CASE("rgl: the container is laid out as RGL's readers expect", "[formats][rgl]") {
    const std::string content = spectral_file(8);
    CHECK(content.substr(0, 12) == std::string("tensor_file\0", 12));
    CHECK(content[12] == 1);
    CHECK(content[13] == 0);
    // First field: name length, name, dimensions, type u8, offset, shape.
    std::uint16_t name_length = 0, dimensions = 0;
    std::uint64_t offset = 0, extent = 0;
    std::memcpy(&name_length, content.data() + 18, 2);
    REQUIRE(name_length == 11);
    CHECK(content.substr(20, 11) == "description");
    std::memcpy(&dimensions, content.data() + 31, 2);
    CHECK(dimensions == 1);
    CHECK(content[33] == 1);
    std::memcpy(&offset, content.data() + 34, 8);
    std::memcpy(&extent, content.data() + 42, 8);
    CHECK(offset % 8 == 0);
    CHECK(content[offset] == '{');
    CHECK(content[offset + extent - 1] == '}');
    for (const char* name : {"phi_i", "theta_i", "ndf", "sigma", "vndf", "luminance", "jacobian",
                             "wavelengths", "spectra"}) {
        CHECK_THAT(content, Catch::Contains(name));
    }
}

TEST_CASE("rgl: nothing stored is negative, even beside a lobe that the grid does not resolve",
          "[formats][rgl]") {
    // pbrt-v4 counts negative values as an error and Mitsuba 3 renders with them.
    const double alpha = GENERATE(0.3, 0.05, 0.01);
    const support::SharpMaterial sharp(support::seven_wavelengths(), alpha);
    const std::string content =
        written_file("rgl", sharp, {.resolution = 24, .extra = {{"incident_angles", 8}}});
    const auto fields = read_tensor_file(content);
    const auto least = [&](const char* name) {
        const auto values = tensor_floats(fields, name);
        float lowest = values[0];
        for (std::size_t i = 1; i < values.size(); ++i) lowest = std::min(lowest, values[i]);
        return lowest;
    };
    CAPTURE(alpha);
    CHECK(least("spectra") >= 0.0f);
    CHECK(least("luminance") > 0.0f);
}

TEST_CASE("rgl: near the horizon the lobe of a surface stays where it is", "[formats][rgl]") {
    // Mirrored at the horizon, half vectors far outside the lobe may get into it: what the table
    // continues below the horizon is not to reach what is stored above it.
    const support::SharpMaterial sharp(support::seven_wavelengths(), 0.1);
    const auto file = read_brdf_file(written_file("rgl", sharp), "lobe");
    const double mu_in = GENERATE(0.0857, 0.1, 0.15);
    std::vector<double> found(7), expected(7);
    double largest = 0.0, light = 0.0, truth = 0.0;
    constexpr int kCosines = 200, kAzimuths = 720;
    for (int i = 0; i < kCosines; ++i) {
        const double x = (i + 0.5) / kCosines, mu_out = x * x;  // dense at the horizon
        for (int j = 0; j < kAzimuths; ++j) {
            const Direction direction{mu_in, mu_out, (j + 0.5) * 180.0 / kAzimuths};
            file->evaluate(direction, found);
            sharp.evaluate({&direction, 1}, expected);
            light += found[3] * mu_out * x;
            truth += expected[3] * mu_out * x;
            if (mu_out > 0.02) largest = std::max(largest, found[3] / expected[3]);
        }
    }
    CAPTURE(mu_in, light / truth);
    CHECK(std::abs(light / truth - 1.0) <= 0.004);
    CHECK(largest <= 2.0);  // 3.8 to 7 with the lobe continued
}

TEST_CASE("rgl: the RGB file names its channels", "[formats][rgl]") {
    const auto read = read_brdf_file(written_file("rgl", material(), {.resolution = 8}, 1), "test");
    CHECK(read->channels() == std::vector<std::string>{"R", "G", "B"});
}

TEST_CASE("rgl: options out of range are refused", "[formats][rgl][errors]") {
    CHECK_THROWS_WITH(spectral_file(2), Catch::Contains("4 to 1024"));
    CHECK_THROWS_WITH(written_file("rgl", material(), {.extra = {{"incident_angles", 1}}}),
                      Catch::Contains("incident_angles") && Catch::Contains("2 to 512"));
    CHECK_THROWS_AS(written_file("rgl", support::ColouredMaterial().rgb), UsageError);
    const support::TestMaterial falling({650, 450}, 0.4);
    CHECK_THROWS_WITH(export_brdf(falling, "rgl", "x"), Catch::Contains("450 nm follows 650 nm"));
}
