#include "pipeline/scene/labels.h"

#include "tests/support/catch.h"

using namespace miebrdf;

TEST_CASE("labels of media and depths are words for people", "[pipeline][labels]") {
    CHECK(label_of(medium("H2O_ice,radius=200")) == "H2O ice, radius 200 \u00b5m");
    CHECK(label_of(medium("TiO2,radius=130nm,volume=15% in PMMA")) ==
          "TiO2, radius 0.13 \u00b5m, 15 % of the volume in PMMA");
    CHECK(label_of(medium("hg:0.9,0.5")) == "Henyey-Greenstein, albedo 0.9, g 0.5");
    CHECK(label_of(depth("0.1")) == "\u03c4 = 0.1");
    CHECK(label_of(depth("0.1[450nm]")) == "\u03c4 = 0.1 at 450 nm");
    CHECK(label_of(depth("2mm")) == "2 mm");
    CHECK(label_of(depth("30g/m2")) == "0.03 kg/m\u00b2");
    CHECK(label_of(depth("inf")) == "opaque");
    CHECK(label_of(substrate("lambert:0.8")) == "ground of albedo 0.8");
}

TEST_CASE("labels of several scenes say what tells them apart", "[pipeline][labels]") {
    Scene thin;
    thin.base = medium("TiO2");
    thin.layers = {layer("Au@0.1")};
    Scene thick = thin, bare = thin, rough = thin;
    thick.layers = {layer("Au@1")};
    bare.layers.clear();
    rough.surface.emplace();
    CHECK(labels_of({thin, thick}) == std::vector<std::string>{"\u03c4 = 0.1", "\u03c4 = 1"});
    CHECK(labels_of({thin, rough}) == std::vector<std::string>{"no surface", "roughness 0.3"});
    CHECK(labels_of({thin, bare}) == std::vector<std::string>{"Au (\u03c4 = 0.1) on TiO2", "TiO2"});
    CHECK(labels_of({thin}) == std::vector<std::string>{""});
    const auto paint = [](const std::string& pigment) {
        Scene scene;
        scene.substrate = substrate("lambert:0.9");
        scene.layers = {layer(pigment + ",volume=5% in index:1.5@40um")};
        return scene;
    };
    CHECK(labels_of({paint("Fe2O3,radius=0.1"), paint("TiO2,radius=0.2")}) ==
          std::vector<std::string>{"Fe2O3, radius 0.1 \u00b5m", "TiO2, radius 0.2 \u00b5m"});
    CHECK(labels_of({paint("TiO2,radius=0.1"), paint("TiO2,radius=0.2")}) ==
          std::vector<std::string>{"radius 0.1 \u00b5m", "radius 0.2 \u00b5m"});
}
