// miebrdf export and miebrdf check as their users meet them.
#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;
using support::check_one_line;

namespace {

const std::string kScene = " --base hg:0.9,0.4 --wavelengths 450,550,650 ";

}  // namespace

TEST_CASE("what export writes passes check, alone and against its scene", "[program][export]") {
    const std::string format = GENERATE("csv", "json", "npz", "exr", "pbrt", "rgl", "merl", "ssdd",
                                        "astm", "radiance", "klems");
    const support::TemporaryFolder folder;
    const auto exported =
        support::run_ok("export --format " + format + kScene + "-o " + (folder / "paint.file"));
    CAPTURE(format);
    CHECK_THAT(exported.err, Catch::Contains("paint"));
    const std::string file = format == "rgl" ? folder / "paint_spec.file" : folder / "paint.file";
    const auto checked = support::run_program("check " + file);
    CAPTURE(checked.out, checked.err);
    CHECK(checked.exit_code == 0);
    CHECK_THAT(checked.out,
               Catch::Contains("# format: " + (format == "klems" ? "radiance" : format)) &&
                   Catch::Contains("largest_directional_albedo"));
    const auto compared = support::run_program("check " + file + kScene);
    CAPTURE(compared.out, compared.err);
    CHECK(compared.exit_code == 0);
    CHECK_THAT(compared.out, Catch::Contains("deviation_rms (mu > 0.2)"));
    // The command in the file's metadata says the same scene: not a number differs.
    const auto own = support::run_program("check " + file + " --own-scene");
    CAPTURE(own.out, own.err);
    CHECK(own.exit_code == 0);
    const auto rows = [](const std::string& text) { return text.substr(text.find("quantity,")); };
    CHECK(rows(own.out) == rows(compared.out));
}

TEST_CASE("a file's own scene is read from its command: quoted words, surface, component",
          "[program][export]") {
    const support::TemporaryFolder folder;
    const std::string format = GENERATE("pbrt", "radiance", "merl", "csv");
    const std::string scene =
        " --base hg:0.9,0.4 --coat 'isotropic:0.5@0.1[450nm]' --roughness 0.4 --surface-index 1.5 "
        "--component subsurface --wavelengths 450,550,650 ";
    const std::string file = folder / "it is.file";
    const std::string list = format == "csv" ? "--mu-in 0.3,1 --mu-out 0.5,1 --azimuth 0,90 " : "";
    const auto exported =
        support::run_ok("export --format " + format + scene + list + "-o '" + file + "'");
    CAPTURE(format);
    const auto own = support::run_program("check '" + file + "' --own-scene");
    CAPTURE(own.out, own.err);
    CHECK(own.exit_code == 0);
    CHECK_THAT(own.out, Catch::Contains("deviation_rms (mu > 0.2)"));
    CHECK_THAT(own.err, Catch::Contains("isotropic:0.5@0.1[450nm]"));
}

TEST_CASE("check says of a file alone that lost peaks do not show, and finds them in its scene",
          "[program][export]") {
    const support::TemporaryFolder folder;
    // The glory of 50 um spheres is narrower than any cell of the format.
    REQUIRE(
        support::run_program("export --format rgl --base TiO2 --wavelengths 620 --resolution 24 "
                             "--incident-angles 8 --accept-error -o " +
                             (folder / "a.bsdf"))
            .exit_code != support::kUsage);
    const std::string file = folder / "a_rgb.bsdf";
    const auto alone = support::run_program("check " + file);
    CAPTURE(alone.out, alone.err);
    CHECK_THAT(alone.out, Catch::Contains("cannot be seen from the file alone: peaks narrower") &&
                              Catch::Contains("--own-scene") &&
                              Catch::Contains("not judged without a scene"));
    const auto own = support::run_program("check " + file + " --own-scene");
    CAPTURE(own.out, own.err);
    CHECK_THAT(own.out, Catch::Contains("# worst at retro-reflection: -"));
    CHECK_THAT(own.err, Catch::Contains("retro-reflection: a peak narrower than the file's cells"));
    CHECK_THAT(own.out, !Catch::Contains("not judged without a scene"));
}

TEST_CASE("the option --own-scene refuses a scene beside it, and files that do not say theirs",
          "[program][export]") {
    const support::TemporaryFolder folder;
    support::run_ok("export --format csv" + kScene + "-o " + (folder / "a.csv"));
    check_one_line(support::run_program("check " + (folder / "a.csv") + " --own-scene" + kScene),
                   support::kUsage, {"--own-scene", "--base"});
    std::string text = support::read_file(folder / "a.csv");
    const std::size_t at = text.find("# command: ");
    REQUIRE(at != text.npos);
    const std::size_t end = text.find('\n', at);
    folder.write("b.csv", text.substr(0, at) + text.substr(end + 1));
    check_one_line(support::run_program("check " + (folder / "b.csv") + " --own-scene"),
                   support::kBadInput, {"b.csv", "does not say", "--base"});
    folder.write("c.csv", text.replace(at, end - at, "# command: miebrdf run paint.toml"));
    check_one_line(support::run_program("check " + (folder / "c.csv") + " --own-scene"),
                   support::kBadInput, {"miebrdf run paint.toml", "--base"});
}

TEST_CASE("tables of glories and rainbows pass check, brighter than possible they do not",
          "[program][export]") {
    // 50 um spheres on 16 cosines and 19 azimuths: interpolated, the table would reflect 1.018.
    const std::string scene = " --base TiO2 --coat AlGaAs7@0.1 --wavelengths 620 ";
    const support::TemporaryFolder folder;
    const auto exported =
        support::run_program("export --format json" + scene + "-o " + (folder / "a.json"));
    CAPTURE(exported.err);
    REQUIRE((exported.exit_code == 0 || exported.exit_code == 4));
    const auto checked = support::run_program("check " + (folder / "a.json"));
    CAPTURE(checked.out, checked.err);
    CHECK(checked.exit_code == 0);
    CHECK(support::run_program("check " + (folder / "a.json") + scene).exit_code == 0);
    auto table = nlohmann::json::parse(support::read_file(folder / "a.json"));
    for (auto& row : table["brdf"][0])
        for (auto& line : row)
            for (auto& value : line) value = 1.05 * value.get<double>();
    folder.write("bright.json", table.dump());
    const auto bright = support::run_program("check " + (folder / "bright.json"));
    CAPTURE(bright.out);
    CHECK(bright.exit_code == 1);
    CHECK(support::run_program("check " + (folder / "bright.json") + scene).exit_code == 1);
}

TEST_CASE("tables may go to a device, what is read back may not", "[program][export]") {
    const std::string table = GENERATE("csv", "json", "npz");
    const auto written = support::run_program("export --format " + table + kScene + "-o /dev/null");
    CAPTURE(written.err);
    CHECK(written.exit_code == 0);
    const auto refused = support::run_program("export --format merl" + kScene + "-o /dev/null");
    CHECK(refused.exit_code == 2);
    CHECK_THAT(refused.err, Catch::Contains("/dev/null") && Catch::Contains("csv"));
}

TEST_CASE("check fails with 1 on a bound and with 3 on a damaged file", "[program][export]") {
    const support::TemporaryFolder folder;
    support::run_ok("export --format pbrt" + kScene + "-o " + (folder / "a.bsdf"));
    const auto dark = support::run_program("check " + (folder / "a.bsdf") + " --max-albedo 0.1");
    CHECK(dark.exit_code == 1);
    CHECK_THAT(dark.out, Catch::Contains(",no"));
    // Another scene does not fit the file.
    CHECK(support::run_program("check " + (folder / "a.bsdf") + " --base hg:0.5,0.4").exit_code ==
          1);
    const std::string content = support::read_file(folder / "a.bsdf");
    folder.write("b.bsdf", content.substr(0, content.size() / 2));
    const auto damaged = support::run_program("check " + (folder / "b.bsdf"));
    CHECK(damaged.exit_code == 3);
    CHECK_THAT(damaged.err, Catch::Contains("b.bsdf"));
}

TEST_CASE("export refuses what it cannot write, with the allowed choices", "[program][export]") {
    const support::TemporaryFolder folder;
    const auto unknown =
        support::run_program("export --format vrml" + kScene + "-o " + (folder / "x"));
    CHECK(unknown.exit_code == 2);
    CHECK_THAT(unknown.err, Catch::Contains("vrml") && Catch::Contains("merl"));
    const auto nowhere = support::run_program("export --format csv" + kScene);
    CHECK(nowhere.exit_code == 2);
    CHECK_THAT(nowhere.err, Catch::Contains("-o FILE"));
    const auto component = support::run_program("export --format csv --component surface" + kScene +
                                                "-o " + (folder / "x"));
    CHECK(component.exit_code == 2);
    CHECK(folder.count() == 0);
}

TEST_CASE("options that a format has no use for are refused with those that it takes",
          "[program][export]") {
    const support::TemporaryFolder folder;
    const std::vector<support::Refusal> refusals = {
        {"merl --resolution 8", {"merl", "--resolution", "--bin-centres, --rgb, --max-error"}},
        {"pbrt --mu-in 1", {"pbrt", "--mu-in", "--resolution"}},
        {"csv --max-error 0.1", {"csv", "--max-error", "--azimuth"}},
        {"csv --rgb cie", {"csv", "--rgb"}},
        {"astm --incident-angles 9", {"--incident-angles"}},
        {"csv --resolution 8 --mu-in 1 --mu-out 1 --azimuth 0", {"--resolution"}},
        {"spd --component subsurface", {"spd", "--component"}},
        {"scattering --roughness 0.3", {"scattering", "--roughness"}},
    };
    for (const auto& [arguments, words] : refusals) {
        support::check_refused(
            support::kUsage,
            {{"export --format " + arguments + kScene + "-o " + (folder / "x"), words}});
    }
    CHECK(folder.count() == 0);
}

TEST_CASE("export with --json tells which files it wrote, and how well", "[program][export]") {
    const support::TemporaryFolder folder;
    const std::string format = GENERATE("npz", "pbrt", "rgl", "spd");
    const auto run =
        support::run_ok("export --format " + format + " --base hg:0.9,0.4 --wavelengths rgb -o " +
                        (folder / "x.bsdf") + " --json");
    CAPTURE(format, run.out);
    const auto told = nlohmann::json::parse(run.out);
    CHECK(told["facts"]["converged"] == "yes");
    CHECK(told["rows"].size() == folder.count());
    for (const auto& row : told["rows"]) {
        const std::filesystem::path file = row[0].get<std::string>();
        CHECK(std::filesystem::exists(file));
        if (format != "spd") CHECK(row[1] == std::filesystem::file_size(file));
        if (format == "rgl") CHECK(row[2] <= 2e-3);  // interpolation between its 32 cosines: 1.0e-3
    }
}

TEST_CASE("check says which coupling is reciprocal where a file is not", "[program][export]") {
    const support::TemporaryFolder folder;
    const std::string scene =
        "export --format csv --base hg:0.9,0.4 --wavelengths 550 --roughness "
        "0.2 --surface-index 1.5 -o " +
        (folder / "a.csv");
    support::run_ok(scene + " --coupling paper");
    const auto paper = support::run_program("check " + (folder / "a.csv"));
    CHECK(paper.exit_code == 1);
    CHECK_THAT(paper.err, Catch::Contains("--coupling reciprocal"));
    // The default of exports: readers differ in which direction they take for the light's.
    support::run_ok(scene);
    CHECK_THAT(support::read_file(folder / "a.csv"), Catch::Contains("--coupling reciprocal"));
    const auto reciprocal = support::run_program("check " + (folder / "a.csv"));
    CAPTURE(reciprocal.out);
    CHECK_THAT(reciprocal.err, !Catch::Contains("not reciprocal"));
    CHECK_THAT(reciprocal.out, Catch::Contains("reciprocity_error_rms (mu > 0.2)"));
}

TEST_CASE("grazing directions of a table that miss are a warning, requested values that miss are 4",
          "[program][export]") {
    const support::TemporaryFolder folder;
    const auto table_of = [&](const std::string& words) {
        return support::run_program("export --format npz" + words + "-o " + (folder / "a.npz"));
    };
    const auto gold = table_of(" --base Au --wavelengths 620 --no-cache ");
    CAPTURE(gold.err);
    CHECK(gold.exit_code == 0);
    CHECK_THAT(gold.err, Catch::Contains("warning: grazing directions (mu < 0.2)") &&
                             Catch::Contains("mu_in 0.05"));
    // Clear spheres have a glory straight back, which nodes do not resolve.
    const std::string scene = " --base TiO2 --wavelengths 620 --no-cache ";
    const auto table = table_of(scene);
    CAPTURE(table.err);
    CHECK(table.exit_code == 0);
    CHECK_THAT(table.err, Catch::Contains("warning: single directions miss") &&
                              Catch::Contains("mu_in 1, mu_out 1"));
    // One list of directions has one verdict, whichever command is asked.
    const std::string lists =
        GENERATE("--mu-in 0.05 --mu-out 0.05 --azimuth 0", "--mu-in 0.5 --mu-out 0.5 --azimuth 90");
    const auto listed =
        support::run_program("export --format csv" + scene + lists + " -o " + (folder / "b.csv"));
    const auto asked = support::run_program("brdf" + scene + lists);
    CAPTURE(lists, listed.err, asked.err);
    CHECK(listed.exit_code == asked.exit_code);
}

TEST_CASE("export says where a file is worst, and --accept-error writes what is refused",
          "[program][export]") {
    const support::TemporaryFolder folder;
    const std::string command =
        "export --format klems --base hg:0.9,0.4 --wavelengths 550 "
        "--roughness 0.02 --surface-index 1.5 -o " +
        (folder / "a.xml");
    const auto refused = support::run_program(command);
    CAPTURE(refused.err);
    CHECK(refused.exit_code == 1);
    CHECK_THAT(refused.err, Catch::Contains("near mirror") && Catch::Contains("--accept-error"));
    CHECK(folder.count() == 0);
    const auto accepted = support::run_program(command + " --accept-error");
    CHECK(accepted.exit_code == 0);
    CHECK_THAT(accepted.err, Catch::Contains("retro-reflection") && Catch::Contains("zenith") &&
                                 Catch::Contains("% at mu_in"));
}

TEST_CASE("every format lists wavelengths in one order", "[program][export]") {
    const std::string format = GENERATE("csv", "json", "npz", "exr");
    const support::TemporaryFolder folder;
    const std::string file = folder / "table";
    support::run_ok("export --format " + format +
                    " --base hg:0.9,0.4 --wavelengths rgb --resolution 4 -o " + file);
    const auto checked = support::run_program("check " + file);
    CAPTURE(format, checked.out);
    CHECK_THAT(checked.out, Catch::Contains("# channels: 480, 535, 620") ||
                                Catch::Contains("# channels: 480 nm, 535 nm, 620 nm"));
}

TEST_CASE("check reads what brdf writes, as CSV and as JSON", "[program][export]") {
    const support::TemporaryFolder folder;
    const std::string brdf =
        "brdf --base hg:0.9,0.4 --wavelengths 450,550 --mu-in 0.1:1:0.1 --mu-out 0.1:1:0.1 "
        "--azimuth 0:180:20 -o " +
        (folder / "table");
    std::vector<std::string> rows;
    for (const char* json : {"", " --json"}) {
        support::run_ok(brdf + json);
        const auto checked =
            support::run_program("check " + (folder / "table") + " --base hg:0.9,0.4");
        CAPTURE(json, checked.out, checked.err);
        CHECK(checked.exit_code == 0);
        rows.push_back(checked.out.substr(checked.out.find("quantity,value")));
    }
    CHECK(rows[0] == rows[1]);
    auto table = nlohmann::json::parse(support::read_file(folder / "table"));
    table["rows"].erase(table["rows"].size() - 1);
    folder.write("hole", table.dump());
    CHECK(support::run_program("check " + (folder / "hole")).exit_code == 3);
    table["columns"][4] = "reflection";
    folder.write("other", table.dump());
    const auto other = support::run_program("check " + (folder / "other"));
    CHECK(other.exit_code == 3);
    CHECK_THAT(other.err, Catch::Contains("'brdf'"));
}

TEST_CASE("spectra and single-scattering tables are exports too", "[program][export]") {
    const support::TemporaryFolder folder;
    for (const char* format : {"spd", "irregular", "scattering"}) {
        CAPTURE(format);
        CHECK(support::run_program(std::string("export --format ") + format + kScene + "-o " +
                                   (folder / format))
                  .exit_code == 0);
    }
    CHECK_THAT(support::read_file(folder / "spd"), Catch::Contains("\n550 0."));
    CHECK_THAT(support::read_file(folder / "irregular"), Catch::Contains("450, 550, 650"));
    CHECK_THAT(support::read_file(folder / "scattering"), Catch::Contains("lm_a1.npy"));
}

TEST_CASE("a reflectance that ends within the visible is black beyond, and export says so",
          "[program][export]") {
    const support::TemporaryFolder folder;
    const std::string format = GENERATE("spd", "irregular");
    const std::string start =
        "export --format " + format + " --base hg:0.9,0.4 -o " + (folder / "x") + " --wavelengths ";
    const auto narrow = support::run_program(start + "rgb");
    CHECK(narrow.exit_code == 0);
    CHECK_THAT(narrow.err, Catch::Contains("0 outside 480 to 620 nm"));
    CHECK_THAT(support::run_program(start + "410:700:10").err, Catch::Contains("410 to 700 nm"));
    CHECK_THAT(support::run_program(start + "400:700:50").err, !Catch::Contains("outside"));
}
