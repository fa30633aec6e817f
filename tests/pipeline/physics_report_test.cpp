#include "pipeline/solve/physics_report.h"

#include <cmath>

#include "pipeline/solve/brdf.h"
#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("the physics of a table: defect among pairs that are there both ways, least value",
          "[pipeline][physics]") {
    // mu_in {0.2, 0.5} x mu_out {0.5, 0.2, 0.9}: pairs (0.2, 0.5) and (0.5, 0.2) swap.
    const rte::Directions directions{{0.2, 0.5}, {0.5, 0.2, 0.9}, {0}};
    const PhysicsReport report = physics_of({4, 1, 7, 2, 3, -5}, directions);
    REQUIRE(report.reciprocity_defect);
    CHECK(std::abs(*report.reciprocity_defect - 1.0 / 7) <= 1e-15);  // |4 - 3| / 7
    CHECK(report.least_value == -5);
    CHECK_FALSE(physics_of({1, 2}, {{0.2}, {0.5, 0.9}, {0}}).reciprocity_defect);
}

TEST_CASE(
    "layers are reciprocal to rounding and keep energy; the paper's coupling is not reciprocal",
    "[pipeline][physics]") {
    Request request;
    request.scene.base = parse_medium("index:1.7,0.01");
    request.scene.coats = {parse_coat("hg:0.8,0.6@0.5")};
    request.scene.particles.sizes.effective_radius_um = 2;
    request.scene.surface = rte::SurfaceOptions{};
    request.scene.surface_index = {1.7, 0.01};
    request.wavelength_nm = {550};
    request.directions = {{0.2, 0.6, 1.0}, {0.2, 0.6, 1.0}, {0, 60, 180}};
    const SpectralSlice slice = compute_brdf(request).slices[0];
    // Sums of a few dozen orders with condition numbers of the matrices below 1e4.
    CHECK(*slice.layers_physics.reciprocity_defect <= 1e-10);
    CHECK(*slice.physics.reciprocity_defect > 1e-6);
    CHECK(*slice.layers_physics.largest_albedo > 0);
    CHECK(*slice.physics.largest_albedo > *slice.layers_physics.largest_albedo);
    CHECK(*slice.physics.largest_albedo <= 1);
    CHECK(slice.physics.least_value > 0);

    request.scene.coupling = rte::SurfaceCoupling::reciprocal;
    const SpectralSlice reciprocal = compute_brdf(request).slices[0];
    CHECK(*reciprocal.physics.reciprocity_defect <= 1e-10);
}

TEST_CASE("the albedo in a physics report is the one that albedo computes", "[pipeline][physics]") {
    Request request;
    request.scene.base = parse_medium("hg:0.95,0.7");
    request.wavelength_nm = {550};
    request.directions = {{0.3, 1.0}, {0.5}, {0}};
    const SpectralSlice slice = compute_brdf(request).slices[0];
    const AlbedoSlice albedo = compute_albedo(request).slices[0];
    const double largest = std::max(albedo.plane_albedo[0], albedo.plane_albedo[1]);
    // Different numbers of nodes, both within the tolerance.
    CHECK(std::abs(*slice.physics.largest_albedo / largest - 1) <= 2 * request.solver.tolerance);
}
