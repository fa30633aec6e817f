#include "pipeline/solve/solved_source.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/formats/check/check.h"
#include "pipeline/solve/brdf.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using namespace miebrdf::exports;

namespace {

Request half_space_request() {
    Request request;
    request.scene.base = HenyeyGreensteinMedium{0.9, 0.4};
    request.wavelength_nm = {500, 600};
    request.solver.tolerance = 1e-5;
    return request;
}

/// Largest difference from compute_brdf, which solves at each direction itself, relative to the
/// largest BRDF at that incidence, as the tolerance is defined.
double largest_difference(const Request& request, const SolvedSource& source, std::size_t count) {
    double largest = 0.0;
    Request asked = request;
    for (const Direction& d : random_directions(count, 3)) {
        asked.directions = {{d.mu_in}, {d.mu_out, 0.05, 1.0}, {d.azimuth_deg, 0.0, 180.0}};
        const BrdfResult expected = compute_brdf(asked);
        std::vector<double> found(source.channels().size());
        source.evaluate({&d, 1}, found);
        for (std::size_t w = 0; w < found.size(); ++w) {
            const std::vector<double>& total = expected.slices[w].total;
            const double scale = *std::max_element(total.begin(), total.end());
            largest = std::max(largest, std::abs(found[w] - total[0]) / scale);
        }
    }
    return largest;
}

}  // namespace

TEST_CASE("solved once, evaluated anywhere: the same as solving at each direction",
          "[exports][solved_source]") {
    Request request = half_space_request();
    SECTION("half-space") {}
    SECTION("coat") { request.scene.coats = {{HenyeyGreensteinMedium{0.6, 0.2}, 0.1}}; }
    SECTION("rough surface, reciprocal coupling") {
        request.scene.surface = rte::SurfaceOptions{};
        request.scene.surface_index = {1.5, 0.0};
        request.scene.coupling = rte::SurfaceCoupling::reciprocal;
    }
    const SolvedSource source(request, Component::total, "test", {});
    CHECK(source.accuracy().converged);
    // Both solve to 1e-5; interpolation between the cosines must not add to that by an order.
    CHECK(largest_difference(request, source, 12) <= 1e-4);
}

TEST_CASE("at the horizon itself the BRDF of large spheres is that just above it",
          "[exports][solved_source]") {
    // Fourier files have a row there. The table of glories ends at mu = 0.001: asked for 1e-9 it
    // gave 1e7 per steradian.
    Request request;
    request.scene.base = IndexMedium{{2.6, 0.0}};
    request.scene.particles.sizes.effective_radius_um = 5;
    request.wavelength_nm = {550};
    const SolvedSource source(request, Component::total, "", {});
    for (const double azimuth : {0.0, 90.0, 165.0, 180.0}) {
        const Direction directions[] = {{0.2, 1e-9, azimuth}, {0.2, 2e-3, azimuth}};
        double values[2];
        source.evaluate(directions, values);
        CAPTURE(azimuth, values[0], values[1]);
        CHECK(std::abs(values[0] / values[1] - 1) <= 0.2);
    }
}

TEST_CASE("the number of threads changes no bit of a solved source", "[exports][solved_source]") {
    Request request = half_space_request();
    request.scene.coats = {{HenyeyGreensteinMedium{0.6, 0.2}, 0.1}};
    for (int w = 0; w < 18; ++w) request.wavelength_nm.push_back(610 + 10 * w);  // two tables
    const std::vector<Direction> directions = random_directions(50, 4);
    std::vector<std::vector<double>> values;
    for (const int threads : {1, 2, 7}) {
        const RunControl control{.threads = threads};
        const SolvedSource source(request, Component::total, "", control);
        values.push_back(evaluate_all(source, directions, "test", control));
    }
    CHECK(values[0] == values[1]);
    CHECK(values[0] == values[2]);
}

TEST_CASE("components add up: total is the surface and what it lets through",
          "[exports][solved_source]") {
    Request request = half_space_request();
    request.scene.surface = rte::SurfaceOptions{};
    request.scene.surface_index = {2.0, 0.0};
    const SolvedSource total(request, Component::total, "", {});
    const SolvedSource surface(request, Component::surface, "", {});
    const SolvedSource subsurface(request, Component::subsurface, "", {});
    const Direction direction{0.6, 0.6, 0.0};
    double values[3][2];
    total.evaluate({&direction, 1}, values[0]);
    surface.evaluate({&direction, 1}, values[1]);
    subsurface.evaluate({&direction, 1}, values[2]);
    const double share = (values[0][0] - values[1][0]) / values[2][0];
    CHECK(share > 0.8);  // 1 - rho of n = 2 is near 0.89
    CHECK(share < 0.95);
}

TEST_CASE("what is not converged says where and how widely, and so does the file",
          "[exports][solved_source]") {
    Request request;
    request.scene.base = HenyeyGreensteinMedium{0.9, 0.95};
    request.wavelength_nm = {500, 600};
    request.solver.streams = 4;  // too few for a phase function this narrow
    const SolvedSource source(request, Component::total, "", {});
    const SolverAccuracy& accuracy = source.accuracy();
    CHECK_FALSE(accuracy.converged);
    CHECK(accuracy.error_estimate > 1e-3);
    CHECK(accuracy.share_within_tolerance > 0.0);
    CHECK(accuracy.share_within_tolerance < 1.0);
    // Forward scattering along the horizon is what four streams see least of.
    CHECK(accuracy.direction.mu_in == 0.05);
    CHECK(accuracy.direction.azimuth_deg == 0.0);
    CHECK_THAT(describe(accuracy), Catch::Contains("mu_in 0.05") && Catch::Contains("azimuth 0 ") &&
                                       Catch::Contains("% of the directions"));
    CHECK(source.provenance().accuracy == describe(accuracy));
}

TEST_CASE("layers that do not show are not computed for an export either",
          "[exports][solved_source]") {
    Request request;
    request.wavelength_nm = {500, 600};
    request.scene.base = IndexMedium{{1.5, 0.0}};
    request.scene.particles.sizes.effective_radius_um = 1;
    std::map<std::string, std::size_t> jobs;
    RunControl control{.threads = 1};
    control.progress = [&](const std::string& stage, std::size_t, std::size_t total) {
        jobs[stage] = total;
    };
    SECTION("under a deep coat") {
        request.scene.coats = {{HenyeyGreensteinMedium{0.3, 0.1}, 60.0}};
        const SolvedSource source(request, Component::total, "", control);
        CHECK(jobs["single scattering"] == 2);  // the coat at two wavelengths, no base
        // What lies below light that is lost after 60 optical depths cannot matter.
        request.scene.base = IsotropicMedium{0.0};
        const SolvedSource black(request, Component::total, "", {});
        CHECK(source.provenance().sources.size() == 2);  // the scene is still what was asked for
        for (const Direction& d : random_directions(30, 9)) {
            double values[2][2];
            source.evaluate({&d, 1}, values[0]);
            black.evaluate({&d, 1}, values[1]);
            CHECK(std::abs(values[0][0] / values[1][0] - 1) <= 2e-3);
        }
    }
    SECTION("under the surface alone") {
        request.scene.surface = rte::SurfaceOptions{};
        const SolvedSource source(request, Component::surface, "", control);
        CHECK(jobs.count("single scattering") == 0);
    }
    SECTION("but what shows is") {
        request.scene.coats = {{HenyeyGreensteinMedium{0.3, 0.1}, 0.5}};
        const SolvedSource source(request, Component::total, "", control);
        CHECK(jobs["single scattering"] == 4);
    }
}

TEST_CASE("a surface that is not there cannot be exported", "[exports][solved_source][errors]") {
    CHECK_THROWS_WITH(SolvedSource(half_space_request(), Component::surface, "", {}),
                      Catch::Contains("--roughness"));
    CHECK_THROWS_WITH(parse_component("glitter"),
                      Catch::Contains("glitter") && Catch::Contains("subsurface"));
}
