#include "pipeline/solve/brdf.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/surface.h>
#include "pipeline/cache/result_cache.h"
#include "pipeline/solve/layers.h"
#include "pipeline/solve/table1.h"
#include "rte/math/quadrature.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

Request request_of(const std::string& base, std::vector<double> wavelength_nm = {550}) {
    Request request;
    request.scene.base = parse_medium(base);
    request.wavelength_nm = std::move(wavelength_nm);
    request.directions = {{0.3, 1.0}, {0.2, 0.9}, {0.0, 70.0, 180.0}};
    return request;
}

}  // namespace

namespace {

/// The rows of a reference table that belong to one scene and wavelength.
struct ReferenceRows {
    rte::Directions directions;  ///< all combinations of the table's directions
    std::vector<std::size_t> rows;

    std::size_t index_of(const support::ReferenceTable& table, std::size_t row) const {
        const auto position = [&](const std::vector<double>& values, const char* column) {
            const double value = table.number(row, column);
            return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) -
                                            values.begin());
        };
        return (position(directions.mu_in, "mu_in") * directions.mu_out.size() +
                position(directions.mu_out, "mu_out")) *
                   directions.azimuth_deg.size() +
               position(directions.azimuth_deg, "azimuth_deg");
    }
};

void insert_once(std::vector<double>& values, double value) {
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

ReferenceRows rows_of(const support::ReferenceTable& table, double depth) {
    ReferenceRows found;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.text(row, "pair") != "A" || table.number(row, "coat_tau") != depth ||
            table.number(row, "wavelength_nm") != 450) {
            continue;
        }
        found.rows.push_back(row);
        insert_once(found.directions.mu_in, table.number(row, "mu_in"));
        insert_once(found.directions.mu_out, table.number(row, "mu_out"));
        insert_once(found.directions.azimuth_deg, table.number(row, "azimuth_deg"));
    }
    return found;
}

}  // namespace

TEST_CASE("the paper's pair agrees with the reference reflection", "[pipeline][brdf]") {
    // tests/reference/pipeline: TiO2 with and without AlGaAs7, azimuthal sums with all ~2900
    // moments.
    const support::ReferenceTable table("pipeline/tio2_algaas_reflection_450nm.csv");
    const double depth = GENERATE(0.0, 0.1);
    const ReferenceRows reference = rows_of(table, depth);
    REQUIRE(!reference.rows.empty());
    Request request = request_of("TiO2", {450});
    if (depth > 0) request.scene.coats.push_back({parse_medium("AlGaAs7"), depth});
    request.directions = reference.directions;
    const BrdfResult result = compute_brdf(request);
    std::map<double, double> largest;  // the tolerance is relative to the largest at an incidence
    for (const std::size_t row : reference.rows) {
        double& value = largest[table.number(row, "mu_in")];
        value = std::max(value, table.number(row, "R"));
    }
    for (const std::size_t row : reference.rows) {
        const double mu_in = table.number(row, "mu_in"), mu_out = table.number(row, "mu_out");
        const double azimuth = table.number(row, "azimuth_deg");
        const double r =
            std::numbers::pi * result.slices[0].subsurface[reference.index_of(table, row)];
        CAPTURE(depth, mu_in, mu_out, azimuth, r, result.error_estimate);
        CHECK(std::abs(r - table.number(row, "R")) <= request.solver.tolerance * largest[mu_in]);
    }
}

TEST_CASE("any number of threads gives the same bits", "[pipeline][brdf]") {
    Request request = request_of("GaP", {450, 500, 550, 600, 650});
    request.scene.coats.push_back({parse_medium("SiO2"), 0.1});
    request.scene.particles.sizes.effective_radius_um = 2;
    request.scene.surface = rte::SurfaceOptions{};
    const BrdfResult one = compute_brdf(request, {.threads = 1});
    for (const int threads : {2, 7}) {
        const BrdfResult many = compute_brdf(request, {.threads = threads});
        for (std::size_t w = 0; w < one.slices.size(); ++w) {
            CHECK(many.slices[w].total == one.slices[w].total);
            CHECK(many.slices[w].error_estimate == one.slices[w].error_estimate);
        }
    }
}

TEST_CASE("any number of threads gives the same bits of albedos and of Table 1",
          "[pipeline][albedo][table1]") {
    Request request = request_of("GaP", {450, 500, 550, 600, 650});
    request.scene.coats.push_back({parse_medium("SiO2"), 0.1});
    request.scene.particles.sizes.effective_radius_um = 2;
    request.scene.surface = rte::SurfaceOptions{};
    const AlbedoResult one = compute_albedo(request, {.threads = 1});
    Table1Request table;
    table.conventions = rte::table1_conventions();
    const Table1Result one_table = compute_table1(table, {.threads = 1});
    for (const int threads : {2, 7}) {
        const AlbedoResult many = compute_albedo(request, {.threads = threads});
        for (std::size_t w = 0; w < one.slices.size(); ++w) {
            CHECK(many.slices[w].plane_albedo == one.slices[w].plane_albedo);
            CHECK(many.slices[w].spherical_albedo == one.slices[w].spherical_albedo);
        }
        const Table1Result many_table = compute_table1(table, {.threads = threads});
        REQUIRE(many_table.entries.size() == one_table.entries.size());
        for (std::size_t i = 0; i < one_table.entries.size(); ++i) {
            CHECK(many_table.entries[i].factor == one_table.entries[i].factor);
        }
    }
}

TEST_CASE("a damaged cache entry is computed again, to the same bits", "[pipeline][cache]") {
    const support::TemporaryFolder folder;
    const std::string file = folder / "results.sqlite";
    const Request request = request_of("hg:0.9,0.5");
    const auto run = [&] {
        ResultCache cache(file);
        RunControl control{.threads = 1};
        control.cache = &cache;
        return compute_brdf(request, control).slices[0].total;
    };
    const auto first = run();
    // The first value of the stored row, R at the first direction, as bytes; one of them flipped.
    const double stored =
        compute_layers(request, SceneMedia(request), LayerQuantity::reflection, {.threads = 1})[0]
            .values[0];
    std::string bytes = support::read_file(file);
    const std::string pattern(reinterpret_cast<const char*>(&stored), sizeof(stored));
    const auto at = bytes.find(pattern);
    REQUIRE(at != std::string::npos);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    folder.write("results.sqlite", bytes);
    CHECK(run() == first);
    CHECK(run() == first);
    CHECK(ResultCache(file).info().entries == 1);
}

TEST_CASE("a coat of no depth changes nothing, a very deep one hides the base",
          "[pipeline][brdf]") {
    const Request bare = request_of("hg:0.9,0.5");
    Request coated = bare;
    coated.scene.coats.push_back({parse_medium("hg:0.3,0.1"), 0.0});
    CHECK(compute_brdf(coated).slices[0].total == compute_brdf(bare).slices[0].total);

    // exp(-2 * 50) of the base is left: below rounding.
    coated.scene.coats[0].optical_depth = 50;
    const auto hidden = compute_brdf(coated).slices[0].total;
    const auto thick = compute_brdf(request_of("hg:0.3,0.1")).slices[0].total;
    for (std::size_t i = 0; i < thick.size(); ++i) {
        // Both are within the tolerance of the truth.
        CHECK(std::abs(hidden[i] / thick[i] - 1) <= 2 * bare.solver.tolerance);
    }
}

TEST_CASE("Mie theory and streams together stay within the tolerance", "[pipeline][brdf]") {
    Request request = request_of("index:1.7,0.02");
    request.scene.particles.sizes.effective_radius_um = 2;
    request.solver.tolerance = GENERATE(1e-2, 1e-3, 1e-4);
    const BrdfResult result = compute_brdf(request);
    CAPTURE(request.solver.tolerance);
    REQUIRE(result.converged);
    CHECK(result.slices[0].mie_error_estimate > 0);
    CHECK(result.error_estimate <= request.solver.tolerance);
}

TEST_CASE("what Mie theory leaves open is not called converged", "[pipeline][brdf]") {
    Request request = request_of("index:1.5,0");
    request.scene.particles.sizes.effective_radius_um = 5;
    request.scene.particles.tolerance = 1e-2;  // ten times the tolerance of the whole
    const BrdfResult result = compute_brdf(request);
    REQUIRE(result.slices[0].mie_error_estimate > request.solver.tolerance);
    CHECK_FALSE(result.converged);
}

TEST_CASE("complete albedo lies between the layers' own and 1", "[pipeline][albedo]") {
    Request request = request_of("TiO2");
    request.scene.particles.sizes.effective_radius_um = 2;
    request.scene.particles.k_floor = 1e-4;
    request.directions.mu_in = {0.1, 0.5, 1.0};
    const AlbedoResult layers = compute_albedo(request);
    request.scene.surface = rte::SurfaceOptions{};
    const AlbedoResult complete = compute_albedo(request);
    for (std::size_t i = 0; i < 3; ++i) {
        // rho + (1 - rho) A > A as long as A < 1.
        CHECK(complete.slices[0].plane_albedo[i] > layers.slices[0].plane_albedo[i]);
        CHECK(complete.slices[0].plane_albedo[i] < 1.0);
    }
    CHECK(complete.slices[0].spherical_albedo > layers.slices[0].spherical_albedo);
    CHECK(complete.slices[0].spherical_albedo < 1.0);
}

TEST_CASE("with the reciprocal coupling albedo is the integral of the BRDF", "[pipeline][albedo]") {
    Request request = request_of("hg:0.97,0.6");
    request.scene.surface = rte::SurfaceOptions{};
    request.scene.surface_index = {1.8, 0.01};
    request.scene.coupling = rte::SurfaceCoupling::reciprocal;
    request.solver.tolerance = 1e-6;
    request.directions.mu_in = {0.3, 0.9};
    const AlbedoSlice albedo = compute_albedo(request).slices[0];

    const math::Quadrature rule = math::gauss_legendre(24, 0.0, 1.0);
    const rte::SurfaceLobe lobe(*request.scene.surface_index, *request.scene.surface);
    request.directions.mu_out = rule.nodes;
    request.directions.azimuth_deg.clear();
    constexpr int kAzimuths = 24;  // 0.6^24 = 5e-6 of the orders alias
    for (int a = 0; a < kAzimuths; ++a) request.directions.azimuth_deg.push_back(a * 15.0);
    const SpectralSlice slice = compute_brdf(request).slices[0];
    std::size_t index = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        double layers = 0;  // the lobe is too sharp for 24 nodes: its integral is known
        for (std::size_t o = 0; o < rule.nodes.size(); ++o) {
            for (int a = 0; a < kAzimuths; ++a, ++index) {
                layers += 2 * std::numbers::pi / kAzimuths * rule.weights[o] * rule.nodes[o] *
                          (slice.total[index] - slice.surface[index]);
            }
        }
        const double rho = lobe.directional_reflectance(request.directions.mu_in[i]);
        CAPTURE(request.directions.mu_in[i], rho, layers);
        // 24 Gauss nodes for mu ln mu at grazing: 1e-5; the mean transmittance: 1e-5.
        CHECK(std::abs(albedo.plane_albedo[i] - rho - layers) <= 3e-5);
    }
    CHECK(albedo.spherical_albedo < 1);
    CHECK(albedo.spherical_albedo > albedo.plane_albedo[1]);
}

TEST_CASE("large spheres under a surface: albedos meet the tolerance at the incidences asked for",
          "[pipeline][albedo]") {
    // They once were judged at grazing nodes that only the mean over incidences used.
    Request request = request_of("index:2.6,1e-4");
    request.scene.surface = rte::SurfaceOptions{};
    request.scene.coupling =
        GENERATE(rte::SurfaceCoupling::paper, rte::SurfaceCoupling::reciprocal);
    request.directions.mu_in = {0.1, 0.5, 1};
    const AlbedoSlice albedo = compute_albedo(request).slices[0];
    CAPTURE(albedo.error_estimate);
    CHECK(albedo.converged);
    request.solver.streams = 96;
    const AlbedoSlice finer = compute_albedo(request).slices[0];
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(std::abs(albedo.plane_albedo[i] / finer.plane_albedo[i] - 1) <= 1e-3);
    }
    CHECK(std::abs(albedo.spherical_albedo / finer.spherical_albedo - 1) <= 1e-3);
}

TEST_CASE("the reciprocal coupling gains or loses no more than the surface's transmittance varies",
          "[pipeline][albedo]") {
    // docs/maths-surface.md: for layers that absorb nothing the spherical albedo is
    // 1 + <v, R v> / T, v = 1 - rho - T, and no eigenvalue of R is beyond -1 and 1.
    Request request = request_of("index:1.5,0");
    request.scene.surface = rte::SurfaceOptions{};
    request.scene.particles.sizes.effective_radius_um = 5;
    request.scene.coupling = rte::SurfaceCoupling::reciprocal;
    const AlbedoSlice albedo = compute_albedo(request).slices[0];
    const rte::SurfaceLobe lobe({1.5, 0}, *request.scene.surface);
    const math::Quadrature rule = math::gauss_legendre(32, 0.0, 1.0);
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double weight = 2 * rule.weights[i] * rule.nodes[i];
        const double let_in = 1 - lobe.directional_reflectance(rule.nodes[i]);
        mean += weight * let_in;
        square += weight * let_in * let_in;
    }
    CAPTURE(albedo.spherical_albedo, (square - mean * mean) / mean);
    // 1e-5: the mean transmittance of the coupling.
    CHECK(std::abs(albedo.spherical_albedo - 1) <= (square - mean * mean) / mean + 1e-5);
    REQUIRE(albedo.converged);
}

TEST_CASE("spherical albedo is the mean of plane albedo also where it is given at once",
          "[pipeline][albedo]") {
    Request request = request_of("hg:0.95,0.7");
    request.solver.tolerance = 1e-6;
    request.directions.mu_in.clear();
    const int n = 2000;  // midpoint rule, error ~ 1 / n^2
    for (int i = 0; i < n; ++i) request.directions.mu_in.push_back((i + 0.5) / n);
    const AlbedoResult result = compute_albedo(request);
    double mean = 0;
    for (int i = 0; i < n; ++i) {
        mean += 2 * request.directions.mu_in[i] * result.slices[0].plane_albedo[i] / n;
    }
    CHECK(std::abs(mean / result.slices[0].spherical_albedo - 1) <= 2e-6);
}

TEST_CASE("a medium without refractive index needs one for its surface",
          "[pipeline][brdf][errors]") {
    Request request = request_of("hg:0.9,0.5");
    request.scene.surface = rte::SurfaceOptions{};
    CHECK_THROWS_WITH(compute_brdf(request), Catch::Contains("--surface-index"));
    request.scene.surface_index = {1.5, 0.0};
    CHECK(compute_brdf(request).converged);
}

TEST_CASE("requests out of range are refused before any work", "[pipeline][brdf][errors]") {
    Request request = request_of("hg:0.9,0.5");
    const auto refused = [](Request r) { CHECK_THROWS_AS(compute_brdf(r), UsageError); };
    Request r = request;
    r.directions.mu_in = {std::nan("")};
    refused(r);
    r = request;
    r.directions.mu_out = {0.0};
    refused(r);
    r = request;
    r.wavelength_nm = {-1};
    refused(r);
    r = request;
    r.wavelength_nm.clear();
    refused(r);
    r = request;
    r.solver.tolerance = std::nan("");
    refused(r);
    r = request;
    r.solver.streams = 257;
    refused(r);
    r = request;
    r.scene.coats.push_back({parse_medium("hg:0.9,0.5"), std::nan("")});
    refused(r);
}
