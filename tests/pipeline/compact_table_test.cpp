// The low-rank encoding of a solved BRDF, against the BRDF that it was made of.
#include <cmath>
#include <numbers>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include "pipeline/solve/compact_table.h"
#include "pipeline/solve/low_rank.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

Scene scene_of_kind(const std::string& kind) {
    Scene scene;
    scene.base = medium("TiO2,radius=0.13,variance=0.05");
    if (kind == "base") return scene;
    if (kind == "isotropic") {
        scene.base = medium("isotropic:0.9");
        return scene;
    }
    if (kind == "droplets") {  // rainbow and glory
        scene.base = medium("index:1.33,0,radius=4,variance=0.1");
        return scene;
    }
    if (kind == "coats on a ground") {
        scene.base = {};
        scene.substrate = substrate("lambert:0.3");
        scene.layers = {layer("hg:0.99,0.7@1"), layer("Au,radius=0.03,variance=0.05@0.2")};
        return scene;
    }
    scene.layers = {layer("Au,radius=0.03,variance=0.05@0.5")};
    if (kind == "rough" || kind == "rough, reciprocal, GGX") scene.surface.emplace();
    if (kind == "rough, reciprocal, GGX") {
        scene.coupling = rte::SurfaceCoupling::reciprocal;
        scene.surface->distribution = rte::MicrofacetDistribution::ggx;
        scene.surface->shadowing = rte::Shadowing::v_cavity;
    }
    if (kind == "smooth boundary" || kind == "rough boundary") {
        scene.base = medium("TiO2,radius=0.13,variance=0.05 in index:1.5");
        scene.layers.clear();
        scene.boundary.emplace();
        if (kind == "rough boundary") scene.boundary->roughness = 0.3;
    }
    return scene;
}

/// Rows that differ by a factor of a million, columns that are sums of three functions.
Eigen::MatrixXd three_functions(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd table(rows, columns);
    for (Eigen::Index r = 0; r < rows; ++r) {
        const double x = double(r) / double(rows), size = std::pow(10.0, 6.0 * x);
        for (Eigen::Index c = 0; c < columns; ++c) {
            const double y = double(c) / double(columns);
            table(r, c) =
                size * (1.0 + 0.5 * y * std::sin(9.0 * x) + 0.01 * y * y * std::cos(40.0 * x));
        }
    }
    return table;
}

}  // namespace

TEST_CASE("a compact table is within 1e-3 of the BRDF at any directions",
          "[pipeline][compact_table]") {
    const std::string kind =
        GENERATE("base", "isotropic", "droplets", "coats on a ground", "coat", "rough",
                 "rough, reciprocal, GGX", "smooth boundary", "rough boundary");
    const Brdf brdf = solve(scene_of_kind(kind), {450.0, 550.0, 650.0}, {.tolerance = 5e-3});
    const BrdfTable solved = brdf.table();
    const CompactTable page({&solved, 1}, {.tolerance = 8e-4});
    CAPTURE(kind, page.interpolation_error(), page.pair_cosines());
    CHECK(page.interpolation_error() <= 1e-3);

    // Other directions than those that the table chose its size by.
    std::vector<double> exact(3), here(3);
    for (const double mu_in : {0.1, 0.37, 0.71, 0.97, 1.0}) {
        std::vector<double> largest(3, 0.0), error(3, 0.0);
        for (const double mu_out : {0.08, 0.23, 0.5, 0.71, 0.88, 0.995}) {
            for (const double azimuth : {0.0, 1.5, 35.0, 77.0, 140.0, 176.0, 180.0}) {
                const Direction direction{mu_in, mu_out, azimuth};
                solved.evaluate({&direction, 1}, exact);
                page.evaluate(mu_in, mu_out, std::cos(azimuth * std::numbers::pi / 180), here);
                for (std::size_t w = 0; w < 3; ++w) {
                    largest[w] = std::max(largest[w], exact[w]);
                    error[w] = std::max(error[w], std::abs(here[w] - exact[w]));
                }
            }
        }
        for (std::size_t w = 0; w < 3; ++w) {
            CAPTURE(mu_in, w, largest[w]);
            CHECK(error[w] <= 1e-3 * largest[w]);
        }
    }
}

TEST_CASE("a table of three functions has rank three, each row to its own size",
          "[pipeline][low_rank]") {
    const Eigen::MatrixXd table = three_functions(200, 31);
    const Eigen::VectorXd scale = table.cwiseAbs().rowwise().maxCoeff();
    const LowRank reduced = reduce_rank(table, scale, Eigen::VectorXd::Ones(31), 1e-6, 8e-4);
    REQUIRE(reduced.basis.cols() == 3);
    const Eigen::MatrixXd again = scale.asDiagonal() * reduced.basis * reduced.coefficients;
    const Eigen::MatrixXd error = scale.cwiseInverse().asDiagonal() * (again - table);
    // Half a step of the rounded basis for each column, and the tolerance.
    CHECK(error.cwiseAbs().maxCoeff() <= 3 * 4e-5 + 1e-6);
}

TEST_CASE("a table of zeros has no columns and stays zero", "[pipeline][low_rank]") {
    const Eigen::MatrixXd table = Eigen::MatrixXd::Zero(4, 3);
    const LowRank reduced =
        reduce_rank(table, Eigen::VectorXd::Zero(4), Eigen::VectorXd::Ones(3), 1e-6, 8e-4);
    CHECK(reduced.basis.cols() == 0);
    CHECK((reduced.basis * reduced.coefficients).isZero());
}

TEST_CASE("a compact table refuses what it cannot be made of",
          "[pipeline][compact_table][errors]") {
    const BrdfTable solved = solve(scene_of_kind("isotropic"), {550.0}).table();
    CHECK_THROWS_AS(CompactTable({}, {}), UsageError);
    CHECK_THROWS_WITH(CompactTable({&solved, 1}, {.cosines = 5}), Catch::Contains("6 to 49"));
    CHECK_THROWS_AS(CompactTable({&solved, 1}, {.cosines = 50}), UsageError);
    CHECK_THROWS_AS(CompactTable({&solved, 1}, {.orders = -1}), UsageError);
    CHECK_THROWS_AS(CompactTable({&solved, 1}, {.tolerance = std::nan("")}), UsageError);
}
