// OpenPBR surfaces: evaluated, fitted, written as MaterialX and read back.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <pugixml.hpp>

#include <miebrdf/brdf.h>
#include <miebrdf/formats.h>
#include "pipeline/formats/mtlx/openpbr.h"
#include "tests/support/catch.h"
#include "tests/support/reference_table.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_material.h"
#include "tests/support/written_file.h"

using namespace miebrdf;

namespace {

/// The surfaces of tests/reference/interface/openpbr_brdf.csv.
OpenPbr surface_of(const std::string& name) {
    OpenPbr s;
    s.base_color = {0.8, 0.5, 0.2};
    if (name == "lambert" || name == "eon" || name == "coat") s.specular_weight = 0.0;
    if (name == "eon") s.base_diffuse_roughness = 0.8;
    if (name == "gloss") s.specular_roughness = 0.4;
    if (name == "rough") {
        s.specular_roughness = 0.8;
        s.base_diffuse_roughness = 0.3;
        s.base_weight = 0.9;
    }
    if (name == "dense") {
        s.specular_roughness = 0.5;
        s.specular_ior = 2.2;
    }
    if (name == "coat") {
        s.coat_weight = 0.7;
        s.coat_roughness = 0.4;
        s.coat_ior = 1.5;
        s.coat_color = {0.9, 0.7, 0.5};
    }
    return s;
}

/// An OpenPBR surface as the BRDF to be fitted, at the wavelengths of the colours.
class KnownSurface : public support::TestMaterial {
  public:
    explicit KnownSurface(OpenPbr surface)
        : TestMaterial({480, 535, 620}, 0.0), surface_(surface) {}

    void evaluate(std::span<const Direction> directions, std::span<double> values) const override {
        const auto rgb = openpbr_brdf(surface_, directions);
        for (std::size_t d = 0; d < directions.size(); ++d) {
            for (std::size_t c = 0; c < 3; ++c) values[3 * d + c] = rgb[d][2 - c];
        }
    }

  private:
    OpenPbr surface_;
};

/// Integral of BRDF times cosine over one direction, by midpoints; the other one has `mu`.
double furnace(const OpenPbr& surface, double mu, bool over_in) {
    constexpr int kCosines = 60, kAzimuths = 60;
    std::vector<Direction> directions;
    std::vector<double> weights;
    for (int i = 0; i < kCosines; ++i) {
        const double t = (i + 0.5) / kCosines, other = t * t;
        for (int a = 0; a < kAzimuths; ++a) {
            const double azimuth = 180.0 * (a + 0.5) / kAzimuths;
            directions.push_back(over_in ? Direction{other, mu, azimuth}
                                         : Direction{mu, other, azimuth});
            weights.push_back(other * 2.0 * t / kCosines * 2.0 * std::numbers::pi / kAzimuths);
        }
    }
    const auto rgb = openpbr_brdf(surface, directions);
    double sum = 0.0;
    for (std::size_t d = 0; d < rgb.size(); ++d) sum += rgb[d][0] * weights[d];
    return sum;
}

}  // namespace

TEST_CASE("OpenPBR surfaces have the values of Adobe's evaluator where facets shadow as there",
          "[formats][mtlx]") {
    // The specification leaves the masking-shadowing function to renderers ("usually Smith"): G1 G1
    // there, by heights of both rays together in MaterialX and in openpbr_brdf.
    const support::ReferenceTable table("interface/openpbr_brdf.csv");
    std::map<std::string, OpenPbrSurface> surfaces;
    for (std::size_t row = 0; row < table.size(); ++row) {
        const std::string name = table.text(row, "surface");
        const Direction d{table.number(row, "mu_in"), table.number(row, "mu_out"),
                          table.number(row, "azimuth_deg")};
        const OpenPbrSurface& surface =
            surfaces.try_emplace(name, surface_of(name), nullptr, rte::Shadowing::smith_separable)
                .first->second;
        const auto rgb = surface.evaluate(d);
        // Interpolation in the evaluator's tables.
        const double bound = name == "lambert" ? 1e-5 : 0.01;
        CAPTURE(name, d.mu_in, d.mu_out, d.azimuth_deg);
        for (std::size_t c = 0; c < 3; ++c) {
            const double expected = table.number(row, c == 0 ? "red" : c == 1 ? "green" : "blue");
            CHECK(std::abs(rgb[c] / expected - 1.0) <= bound);
        }
    }
}

TEST_CASE("a white OpenPBR surface returns all light", "[formats][mtlx]") {
    // The furnace test that the specification demands of base_color 1.
    OpenPbr white;
    white.base_color = {1.0, 1.0, 1.0};
    white.specular_roughness = GENERATE(0.5, 0.9);
    white.base_diffuse_roughness = GENERATE(0.0, 0.7);
    white.specular_ior = GENERATE(1.3, 1.8);
    for (const double mu : {0.2, 0.5, 1.0}) {
        CAPTURE(white.specular_roughness, white.base_diffuse_roughness, white.specular_ior, mu);
        // EON below a boundary is weighted by its transmission: not exactly white for sigma > 0.
        const double bound = white.base_diffuse_roughness > 0.0 ? 0.02 : 0.003;
        CHECK(std::abs(furnace(white, mu, false) - 1.0) <= bound);
        CHECK(std::abs(furnace(white, mu, true) - 1.0) <= bound);
    }
}

TEST_CASE("fitting an OpenPBR surface finds it again", "[formats][mtlx]") {
    const std::string name = GENERATE("lambert", "gloss", "rough", "dense");
    const OpenPbr known = surface_of(name);
    const OpenPbrFit fit = fit_openpbr(KnownSurface(known));
    CAPTURE(name, fit.surface.specular_roughness, fit.surface.specular_ior,
            fit.surface.base_diffuse_roughness);
    for (const RegionDeviation& region : fit.deviation.regions) {
        CAPTURE(region.name);
        CHECK(region.rms <= 0.01);
    }
    CHECK(fit.surface.base_color[1] * fit.surface.base_weight ==
          Approx(known.base_color[1] * known.base_weight).epsilon(0.02));
    if (name != "lambert") {
        CHECK(fit.surface.specular_roughness == Approx(known.specular_roughness).epsilon(0.02));
        CHECK(fit.surface.specular_ior == Approx(known.specular_ior).epsilon(0.02));
    }
}

TEST_CASE("mtlx has the node and the inputs of the specification, with its types",
          "[formats][mtlx]") {
    const support::ReferenceTable inputs("interface/openpbr_inputs.csv");
    pugi::xml_document document;
    REQUIRE(document.load_string(support::written_file("mtlx", support::material()).c_str()));
    const auto root = document.child("materialx");
    CHECK(std::string(root.attribute("version").value()) == "1.39");
    CHECK(std::string(root.attribute("colorspace").value()) == "lin_rec709");
    const auto node = root.child("open_pbr_surface");
    CHECK(std::string(node.attribute("type").value()) == "surfaceshader");
    const auto material = root.child("surfacematerial");
    CHECK(std::string(material.attribute("type").value()) == "material");
    CHECK(std::string(material.child("input").attribute("nodename").value()) ==
          node.attribute("name").value());
    std::size_t found = 0;
    for (std::size_t row = 0; row < inputs.size(); ++row) {
        const auto input = node.find_child_by_attribute("name", inputs.text(row, "name").c_str());
        if (!input) continue;
        ++found;
        CHECK(input.attribute("type").value() == inputs.text(row, "type"));
    }
    std::size_t written = 0;
    for (const auto input : node.children("input")) written += input ? 1 : 0;
    CHECK(found == written);
    CHECK(written == openpbr_parameters().size());
}

TEST_CASE("a smooth boundary is the mirror of the OpenPBR surface", "[formats][mtlx]") {
    Scene scene{.base = medium("hg:0.9,0.4 in index:1.5")};
    scene.boundary = rte::Boundary{};
    const BrdfTable table = solve(scene, {480, 535, 620}).table();
    CHECK(table.provenance().mirror_index == 1.5);
    const OpenPbrFit fit = fit_openpbr(table);
    CHECK(fit.surface.specular_ior == 1.5);
    CHECK(fit.surface.specular_roughness == 0.0);
    CHECK(fit.surface.specular_weight == 1.0);
    // What is left is that light scattered by this medium is not Lambertian: a tenth of it, as the
    // relative rms between the BRDF without boundary and its mean.
    CHECK(fit.deviation.regions[0].rms <= 0.1);
}

TEST_CASE("every format says which mirror reflections it is without", "[formats][mtlx]") {
    const Format& format = GENERATE(from_range(all_formats().begin(), all_formats().end()));
    if (format.files.empty()) return;  // spectra
    CAPTURE(format.name);
    Scene scene{.base = medium("hg:0.9,0.4 in index:1.5")};
    scene.boundary = rte::Boundary{};
    const support::TemporaryFolder folder;
    const auto text_of = [&](const Scene& one) {
        const BrdfTable table = solve(one, {535}).table({.whole_matrix = format.whole_matrix});
        const ExportOptions options{.resolution = format.resolution.lowest, .accept_error = true};
        export_brdf(table, format, folder.path() / "file", options);
        std::string all;
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
            std::ifstream in(entry.path(), std::ios::binary);
            all.append(std::istreambuf_iterator<char>(in), {});
        }
        return all;
    };
    const std::string smooth = text_of(scene);
    if (format.holds_mirror) {
        CHECK_THAT(smooth, Catch::Contains("the smooth boundary of specular_ior") &&
                               !Catch::Contains("left_out"));
    } else {
        CHECK_THAT(smooth, Catch::Contains("left_out") && Catch::Contains("index 1.5, 4 %"));
    }
    // What a mirror below returns without scattering is in no file, the top's not in mtlx either.
    scene.substrate = substrate("mirror:index:0.05,3");
    scene.layers = {layer("hg:0.9,0.4 in index:1.5 @ 0.3")};
    CHECK_THAT(text_of(scene), Catch::Contains("left_out") && Catch::Contains("the mirror below"));
}

TEST_CASE("colours in ACEScg are the same surface to a few per mille", "[formats][mtlx]") {
    ExportOptions acescg;
    acescg.extra["acescg"] = 1;
    const auto written = support::written_file("mtlx", support::material(), acescg);
    CHECK_THAT(written, Catch::Contains("colorspace=\"acescg\""));
    const auto file = read_brdf_file(written, "test");
    const auto plain = read_brdf_file(support::written_file("mtlx", support::material()), "test");
    std::array<double, 3> a{}, b{};
    file->evaluate({0.7, 0.6, 60}, a);
    plain->evaluate({0.7, 0.6, 60}, b);
    for (std::size_t c = 0; c < 3; ++c) CHECK(a[c] == Approx(b[c]).epsilon(0.01));
}

TEST_CASE("subsurface scattering has the mean free paths of the medium", "[formats][mtlx]") {
    ExportOptions options;
    options.extra["subsurface"] = 1;
    CHECK_THROWS_WITH(fit_openpbr(support::material(), options), Catch::Contains("mean free path"));
    options.subsurface = SubsurfaceMedium{std::vector<double>(7, 250.0), 0.6};
    const OpenPbr surface = fit_openpbr(support::material(), options).surface;
    CHECK(surface.subsurface_weight == 1.0);
    CHECK(surface.subsurface_radius == Approx(0.25));
    CHECK(surface.subsurface_radius_scale[2] == Approx(1.0));
    CHECK(surface.subsurface_scatter_anisotropy == 0.6);
}

TEST_CASE("what is no OpenPBR surface is refused with the reason", "[formats][mtlx][errors]") {
    const auto with = [](const std::string& input, const std::string& space = "acescg") {
        return "<materialx version=\"1.39\" colorspace=\"" + space +
               "\"><open_pbr_surface name=\"a\" type=\"surfaceshader\">" + input +
               "</open_pbr_surface></materialx>";
    };
    CHECK(read_brdf_file(with(""), "ok")->format() == "mtlx");
    CHECK_THROWS_WITH(
        read_brdf_file(with("<input name=\"base_metalness\" type=\"float\" value=\"1\"/>"), "m"),
        Catch::Contains("base_metalness"));
    CHECK_THROWS_WITH(
        read_brdf_file(with("<input name=\"base_weight\" type=\"float\" value=\"2\"/>"), "m"),
        Catch::Contains("2") && Catch::Contains("0 to 1"));
    CHECK_THROWS_WITH(
        read_brdf_file(with("<input name=\"base_weight\" type=\"float\" nodename=\"x\"/>"), "m"),
        Catch::Contains("connected"));
    CHECK_THROWS_WITH(read_brdf_file(with("", "srgb_texture"), "m"),
                      Catch::Contains("srgb_texture"));
}
