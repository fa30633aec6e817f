// What a page evaluates, against the BRDF that it was made of.
#include <cmath>

#include <miebrdf/brdf.h>
#include <miebrdf/error.h>
#include "pipeline/report/page_table.h"
#include "pipeline/report/report_data.h"
#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

Scene scene_of(const std::string& kind) {
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

}  // namespace

TEST_CASE("a page's table is within 1e-3 of the BRDF at any directions", "[report][page_table]") {
    const std::string kind =
        GENERATE("base", "isotropic", "droplets", "coats on a ground", "coat", "rough",
                 "rough, reciprocal, GGX", "smooth boundary", "rough boundary");
    const Brdf brdf = solve(scene_of(kind), {450.0, 550.0, 650.0}, {.tolerance = 5e-3});
    const BrdfTable solved = brdf.table();
    const report::PageTable page(solved, report::kPageTolerance, {});
    CAPTURE(kind, page.interpolation_error(), page.pair_cosines());
    CHECK(page.interpolation_error() <= 1e-3);

    // Other directions than those that the table chose its size by.
    std::vector<double> exact(3), here;
    for (const double mu_in : {0.1, 0.37, 0.71, 0.97, 1.0}) {
        std::vector<double> largest(3, 0.0), error(3, 0.0);
        for (const double mu_out : {0.08, 0.23, 0.5, 0.71, 0.88, 0.995}) {
            for (const double azimuth : {0.0, 1.5, 35.0, 77.0, 140.0, 176.0, 180.0}) {
                const Direction direction{mu_in, mu_out, azimuth};
                solved.evaluate({&direction, 1}, exact);
                page.evaluate(direction, here);
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

TEST_CASE("a page says how its colours are weighted, where its wavelengths allow colours",
          "[report]") {
    CHECK(report::colour_weights({450, 550, 650}).is_null());
    std::vector<double> wavelength_nm;
    for (int nm = 400; nm <= 700; nm += 10) wavelength_nm.push_back(nm);
    const auto lights = report::colour_weights(wavelength_nm);
    REQUIRE(lights.size() == 4);
    for (const auto& light : lights) {
        // A reflectance of 1 is white under each of them, and (1, 1, 1) in adapted sRGB.
        double y = 0.0, red = 0.0;
        for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
            y += light["y"][w].get<double>();
            red += light["srgb"][0].get<double>() * light["x"][w].get<double>() +
                   light["srgb"][1].get<double>() * light["y"][w].get<double>() +
                   light["srgb"][2].get<double>() * light["z"][w].get<double>();
        }
        CHECK(y == Approx(1.0).epsilon(1e-12));
        CHECK(red == Approx(1.0).epsilon(1e-6));
    }
}
