// Numbers with names in the words of a scene.
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <string>
#include <vector>

#include "tests/support/catch.h"

using namespace miebrdf;

namespace {

Scene painted() {
    Scene scene;
    say(scene, "substrate", {"lambert:{ground=0.5}"});
    say(scene, "coat",
        {"TiO2,radius={r=130}nm,volume={c=10}% in index:1.5@{d=40}um", "hg:{w=0.9},{g=0.6}@1"});
    return scene;
}

}  // namespace

TEST_CASE("words with named numbers say what they say without names", "[scene][names]") {
    const Scene scene = painted();
    CHECK(scene.layers[0].medium == medium("TiO2,radius=130nm,volume=10% in index:1.5"));
    CHECK(scene.layers[0].depth == Depth(Depth::Kind::thickness_um, 40.0));
    CHECK(scene.layers[1].medium == medium("hg:0.9,0.6"));
    CHECK(*scene.substrate == substrate("lambert:0.5"));
    std::vector<std::string> names;
    for (const NamedNumber& number : named_numbers(scene)) names.push_back(number.name);
    CHECK(names == std::vector<std::string>{"ground", "r", "c", "d", "w", "g"});
}

TEST_CASE("other values of named numbers are read by the same words", "[scene][names]") {
    const Scene scene = with_values(painted(), {{"r", 200.0}, {"g", -0.25}});
    CHECK(scene.layers[0].medium == medium("TiO2,radius=200nm,volume=10% in index:1.5"));
    CHECK(scene.layers[1].medium == medium("hg:0.9,-0.25"));
    CHECK(named_numbers(scene)[1].value == 200.0);
    // Digits survive.
    const Scene again = with_values(scene, {{"g", 0.1 + 1e-15}});
    CHECK(again.layers[1].medium.species[0].parameters[1] == 0.1 + 1e-15);
    CHECK(with_values("hg:{w},{g=0.5}", {{"w", 0.25}}) == "hg:{w=0.25},{g=0.5}");
}

TEST_CASE("one name is one number", "[scene][names]") {
    Scene scene;
    say(scene, "base", {"hg:{w=0.9},0.5"});
    say(scene, "coat", {"hg:{w},0.8@1"});
    CHECK(named_numbers(scene).size() == 1);
    const Scene other = with_values(scene, {{"w", 0.5}});
    CHECK(other.base == medium("hg:0.5,0.5"));
    CHECK(other.layers[0].medium == medium("hg:0.5,0.8"));
    CHECK_THROWS_WITH(say(scene, "coat", {"hg:{w=0.8},0.8@1"}), Catch::Contains("two values"));
}

TEST_CASE("a word said again forgets its names", "[scene][names]") {
    Scene scene = painted();
    say(scene, "coat", {"hg:0.9,0.6@1"});
    CHECK(named_numbers(scene).size() == 1);
}

TEST_CASE("names are refused where they have no meaning", "[scene][names][errors]") {
    Scene scene = painted();
    CHECK_THROWS_WITH(say(scene, "base", {"hg:{x},0.5"}), Catch::Contains("{x=0.13}"));
    CHECK_THROWS_WITH(say(scene, "wavelengths", {"{nm=550}"}),
                      Catch::Contains("cannot have names"));
    CHECK_THROWS_WITH(with_values(scene, {{"q", 1.0}}), Catch::Contains("ground, r, c, d, w, g"));
    CHECK_THROWS_AS(with_values(scene, {{"g", 1.5}}), UsageError);
    CHECK_THROWS_WITH(with_values(Scene(), {{"q", 1.0}}), Catch::Contains("{q=0.13}"));
}
