#include <miebrdf/brdf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <sstream>

#include "pipeline/formats/check/check.h"
#include "tests/support/catch.h"
#include "tests/support/outside/outside_file.h"
#include "tests/support/sampling.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;

TEST_CASE("radiance: the Klems matrix is reciprocal and keeps the albedo", "[formats][radiance]") {
    const support::ColouredMaterial material;
    const std::string content = support::written_file("klems", material.spectral);
    pugi::xml_document document;
    REQUIRE(document.load_string(content.c_str()));
    const auto layer = document.child("WindowElement").child("Optical").child("Layer");
    CHECK(layer.child("Material").child_value("Name") ==
          std::string("half-space of Henyey-Greenstein scatterers"));
    const auto read = read_brdf_file(content, "test");
    const FileCheck check = check_file(*read);
    CAPTURE(*check.reciprocity_rms);
    CHECK(*check.reciprocity_rms <= 0.06);
    // A patch holds the mean over its angles: compare in the middle of one (20 degrees).
    const auto expected = support::integrated_albedo(material.rgb, 0.94);
    const auto found = directional_albedo(*read, 0.94);
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(found[c] / expected[c] - 1) <= 2e-2);
}

namespace {

/// A paint of albedo 0.9 at every wavelength: bright, coloured by nothing.
class GreyPaint : public support::TestMaterial {
  public:
    GreyPaint() : TestMaterial({480, 535, 620}, 0.4) {}
    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        for (std::size_t d = 0; d < directions.size(); ++d)
            std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(3 * d), 3,
                        brdf(directions[d], 0.9));
    }
};

std::vector<double> seen(const support::OutsideFile& file, const Direction& d) {
    return file.brdf(support::to_light(d), support::to_viewer(d));
}

}  // namespace

TEST_CASE("radiance: a grey paint is grey in the colours that Radiance renders",
          "[formats][radiance]") {
    // Two mistakes: chromaticity relative to D65, where Radiance is neutral at X = Y = Z (klems
    // too); and a tree whose least value it subtracts, which then comes out red.
    const GreyPaint paint;
    const auto tree = support::tensor_tree_file(support::written_file("radiance", paint));
    const auto matrix = support::klems_file(support::written_file("klems", paint));
    for (const Direction& d : {Direction{1.0, 0.999, 0.0}, Direction{0.6, 0.7, 100.0},
                               Direction{0.2, 0.25, 10.0}, Direction{0.5, 0.5, 180.0}}) {
        for (const auto* file : {tree.get(), matrix.get()}) {
            const std::vector<double> rgb = seen(*file, d);
            CAPTURE(d.mu_in, d.mu_out, rgb);
            // Six digits of the matrices, seven of the file.
            for (const double channel : rgb) CHECK(std::abs(channel / rgb[1] - 1) <= 2e-6);
        }
        CHECK(seen(*tree, d)[1] == Approx(paint.brdf(d, 0.9)).epsilon(0.2));
    }
}

TEST_CASE("radiance: the numbers of linear sRGB are those that Radiance renders",
          "[formats][radiance]") {
    const support::ColouredMaterial material;
    const auto file = support::tensor_tree_file(
        support::written_file("radiance", material.spectral, {.resolution = 6}));
    for (const Direction& d : {Direction{0.9, 0.8, 60.0}, Direction{0.6, 0.7, 100.0}}) {
        double truth[3];
        material.rgb.evaluate({&d, 1}, truth);
        const std::vector<double> rgb = seen(*file, d);
        for (std::size_t c = 0; c < 3; ++c) CHECK(rgb[c] == Approx(truth[c]).epsilon(0.05));
        // The cell is as much off in all colours: their ratios are true.
        CHECK(rgb[0] / rgb[2] == Approx(truth[0] / truth[2]).epsilon(3e-3));
    }
}

TEST_CASE("radiance: check sees a tree that Radiance would paint red", "[formats][radiance]") {
    // The tree without its two black cells: as any program may write it.
    std::string xml = support::written_file("radiance", GreyPaint());
    const std::size_t black = xml.find("{\n0 ");
    REQUIRE(black != xml.npos);
    xml.replace(black, 4, "{\n.2 ");
    const std::size_t across = xml.find(" 0\n", black);
    REQUIRE(across < xml.find("CIE-u"));
    xml.replace(across, 3, " .2\n");
    const auto red = read_brdf_file(xml, "red");
    const Direction steep{0.2, 0.25, 10.0};
    double rgb[3];
    red->evaluate(steep, rgb);
    CHECK(rgb[0] > 1.5 * rgb[1]);
    CHECK(compare_file(*red, GreyPaint(), "wavelengths").deviation.rms[0] > 0.2);
    const auto as_radiance = seen(*support::tensor_tree_file(xml), steep);
    for (std::size_t c = 0; c < 3; ++c) CHECK(rgb[c] == Approx(as_radiance[c]).epsilon(1e-4));
}

TEST_CASE("radiance: levels out of range are refused", "[formats][radiance][errors]") {
    CHECK_THROWS_WITH(support::written_file("radiance", support::material(), {.resolution = 12}),
                      Catch::Contains("2 to 8"));
}

TEST_CASE("klems: patches of a film pass what its solution lets pass, from both sides",
          "[formats][radiance][transmission]") {
    Scene scene{.layers = {layer("hg:0.95,0.6 in index:1.3@0.7"), layer("hg:0.8,0.2@0.5")}};
    scene.substrate = substrate("none");
    const Brdf film = solve(scene, {480, 535, 620}, {.stokes = 1});
    const FilmTransmission passed(film);
    const support::TemporaryFolder folder;
    export_brdf(passed, "klems", folder / "film.xml");
    CHECK_THROWS_WITH(export_brdf(passed, "merl", folder / "film.binary"),
                      Catch::Contains("reflected alone") && Catch::Contains("klems"));
    pugi::xml_document document;
    REQUIRE(document.load_file((folder / "film.xml").c_str()));
    const auto layer = document.child("WindowElement").child("Optical").child("Layer");
    std::map<std::string, std::vector<double>> blocks;
    for (const auto data : layer.children("WavelengthData")) {
        const auto block = data.child("WavelengthDataBlock");
        if (data.child_value("Wavelength") != std::string("Visible")) continue;
        CHECK(block.child_value("ScatteringDataType") == std::string("BTDF"));
        std::string text = block.child_value("ScatteringData");
        std::replace(text.begin(), text.end(), ',', ' ');
        std::istringstream numbers(text);
        for (double value = 0; numbers >> value;)
            blocks[block.child_value("WavelengthDataDirection")].push_back(value);
    }
    REQUIRE(blocks.size() == 2);
    const std::vector<double>&down = blocks["Transmission Back"],
          &up = blocks["Transmission Front"];
    REQUIRE(down.size() == 145 * 145);
    REQUIRE(up.size() == 145 * 145);
    for (std::size_t i = 0; i < 145; i += 7) CHECK(down[i * 145 + 30] == up[30 * 145 + i]);
    // The first column is light within 5 degrees of the normal. A patch's projected solid angle:
    // pi (sin^2 upper - sin^2 lower) of its ring over their number.
    constexpr double kEdges[] = {0, 5, 15, 25, 35, 45, 55, 65, 75, 90};
    constexpr int kPatches[] = {1, 8, 16, 20, 24, 24, 24, 16, 12};
    double sum = passed.unscattered(1, 1.0);
    std::size_t row = 0;
    for (int ring = 0; ring < 9; ++ring) {
        const auto s2 = [&](int k) { return std::pow(std::sin(kEdges[k] * M_PI / 180), 2); };
        const double share = M_PI * (s2(ring + 1) - s2(ring)) / kPatches[ring];
        for (int k = 0; k < kPatches[ring]; ++k) sum += share * down[145 * row++];
    }
    // 128 points in each pair of patches: 1 %; grey media, the same at each wavelength.
    CHECK(std::abs(sum - film.albedo({1.0}).plane_transmittance[1][0]) <= 0.01 * sum);
}
