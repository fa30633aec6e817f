// miebrdf swatches, albedo --gloss and tint strength as a user types them.
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;
using support::check_refused;
using support::csv_of;
using support::kUsage;

namespace {

const std::string kVisible = " --wavelengths 400:700:20";

std::string text_in(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

}  // namespace

TEST_CASE("a sheet has a row for each named scene and ground, with the colours of albedo",
          "[program][swatches]") {
    const support::TemporaryFolder folder;
    const std::string film = "index:2.6,1e-4,radius=0.13,volume=15% in index:1.5@6um";
    const std::string file = folder.write(
        "paints.toml",
        "boundary = \"smooth\"\n[scene.zinc]\ncoat = [\"" + film +
            "\"]\n[scene.grey]\nsubstrate = \"lambert:0.3\"\ncoat = [\"isotropic:0@1e-9\"]\n");
    const auto sheet = csv_of("swatches " + file + kVisible);
    REQUIRE(sheet.size() == 3);
    CHECK(sheet.text(0, "name") == "zinc");
    CHECK(sheet.text(0, "over") == "black");
    CHECK(sheet.text(1, "over") == "lambert:0.8");
    CHECK(sheet.text(2, "name") == "grey");
    CHECK(sheet.text(2, "over").empty());
    CHECK(sheet.text(2, "contrast_ratio").empty());
    const auto albedo = csv_of(
        "albedo --over black,white --boundary smooth --theta-in 8 --colour "
        "d65 --coat '" +
        film + "'" + kVisible);
    for (std::size_t ground = 0; ground < 2; ++ground) {
        const std::size_t row = 2 * ground;  // plane, then spherical
        CHECK(std::abs(sheet.number(ground, "L") - albedo.number(row, "lab_l")) <= 1e-6);
        CHECK(std::abs(sheet.number(ground, "srgb_g") - albedo.number(row, "srgb_green")) <= 1e-6);
        CHECK(std::abs(sheet.number(ground, "contrast_ratio") -
                       albedo.number(row, "contrast_ratio")) <= 1e-6);
    }
    // A grey is the same number in every linear space.
    const double grey = sheet.number(2, "Y");
    CHECK(std::abs(grey - 0.3) <= 0.05);  // below a boundary of index 1: none
    for (const char* column : {"linear_r", "linear_b", "acescg_r", "acescg_g", "acescg_b"})
        CHECK(std::abs(sheet.number(2, column) - grey) <= 1e-6);
}

TEST_CASE("sheets are drawn as SVG, PNG and a page", "[program][swatches]") {
    const support::TemporaryFolder folder;
    const std::string words = "swatches --base isotropic:0.9 --compare isotropic:0.5" + kVisible;
    const auto sheet = csv_of(words);
    REQUIRE(sheet.size() == 2);
    for (const char* name : {"sheet.svg", "sheet.html"}) {
        const auto path = folder.path() / name;
        support::run_ok(words + " --title 'a <b>' -o " + path.string());
        const std::string text = text_in(path);
        CHECK_THAT(text, Catch::Contains(sheet.text(0, "hex")) &&
                             Catch::Contains(sheet.text(1, "hex")) &&
                             Catch::Contains("a &lt;b&gt;") && !Catch::Contains("a <b>"));
    }
    CHECK_THAT(text_in(folder.path() / "sheet.html"), Catch::Contains("<th>acescg_r</th>"));
    const std::string doubtful = (folder.path() / "doubtful.svg").string();
    support::run_ok("swatches --base Fe3O4,radius=0.1 -o " + doubtful + kVisible);
    CHECK_THAT(text_in(doubtful), Catch::Contains("#b00020"));
    CHECK_THAT(text_in(folder.path() / "sheet.svg"), !Catch::Contains("#b00020"));
}

TEST_CASE("sheets refuse what has no colour", "[program][swatches][errors]") {
    check_refused(kUsage, {{"swatches", {"need a scene"}}});
    check_refused(kUsage,
                  {{"swatches --base isotropic:0.9 --wavelengths 550", {"eight wavelengths"}}});
    check_refused(kUsage, {{"swatches --base isotropic:0.9 --theta-in 0,8", {"one light"}}});
    check_refused(kUsage, {{"swatches --coat isotropic:0.9@1 --over white", {"grounds"}}});
}

TEST_CASE("albedo --gloss has the three angles of ISO 2813", "[program][gloss]") {
    const auto gloss =
        csv_of("albedo --gloss --substrate black --boundary smooth --host-index 1.567");
    REQUIRE(gloss.size() == 3);
    for (std::size_t row = 0; row < 3; ++row)
        CHECK(std::abs(gloss.number(row, "gloss_units") - 100) <= 1e-9);
    CHECK(gloss.number(1, "angle_deg") == 60);
    check_refused(kUsage,
                  {{"albedo --gloss --substrate black --mu-in 0.5", {"--gloss has the angles"}}});
}

TEST_CASE("tint strength is the ratio of K/S where the reference is darkest", "[program][colour]") {
    const support::TemporaryFolder folder;
    std::string spectrum = "wavelength_nm,reflectance\n";
    for (int nm = 400; nm <= 700; nm += 20)
        spectrum += std::to_string(nm) + (nm == 560 ? ",0.2\n" : ",0.6\n");
    const std::string reference = folder.write("reference.csv", spectrum);
    const auto tint = csv_of(
        "albedo --substrate lambert:0.3 --coat isotropic:0@1e-9 --mu-in 1 "
        "--colour d65 --reference " +
        reference + kVisible);
    // (1 - .3)^2 / .6 over (1 - .2)^2 / .4
    CHECK(std::abs(tint.number(0, "tint_strength") - 100 * (0.49 / 0.6) / (0.64 / 0.4)) <= 1e-4);
}

TEST_CASE("who types pvc is told what to type", "[program][errors]") {
    check_refused(kUsage,
                  {{"layers --substrate black --coat 'TiO2,radius=0.13,pvc=40% in PMMA@20um'",
                    {"volume=40% in PMMA"}}});
}
