// Colours, drawdowns and skies on the command line: columns, references, refusals.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Columns = std::vector<std::string>;

namespace {

support::CsvOutput answer(const std::string& arguments) {
    const auto run = support::run_ok(arguments);
    CAPTURE(arguments);
    return support::CsvOutput(run.out);
}

const std::string kPaint =
    " --coat 'index:2.6,1e-4,radius=0.13,distribution=gamma,volume=15% in index:1.5@12um' "
    "--wavelengths 400:700:30";

}  // namespace

TEST_CASE("a scene has no colour difference to itself, however it is said", "[program][colour]") {
    const support::TemporaryFolder folder;
    const std::string scene =
        "albedo --base index:1.6,0.05,radius=0.2 --mu-in 0.5,1 --wavelengths 400:700:20";
    const std::string table = (folder.path() / "table.csv").string();
    support::run_ok(scene + " -o " + table);
    const std::string file = folder.write(
        "scene.toml", "base = \"index:1.6,0.05,radius=0.2\"\n[[result]]\ncommand = \"albedo\"\n");
    for (const std::string& reference : {table, file}) {
        const auto csv = answer(scene + " --colour d50,10 --reference " + reference);
        CAPTURE(reference);
        REQUIRE(csv.size() == 3);
        for (std::size_t row = 0; row < csv.size(); ++row) {
            CHECK(csv.number(row, "de76") <= 1e-6);
            CHECK(csv.number(row, "de2000") <= 1e-6);
        }
    }
    // Greys of 0.2 and 0.3: dE76 is the difference of 116 Y^(1/3).
    std::string spectrum = "wavelength_nm,reflectance\n";
    for (int nm = 400; nm <= 700; nm += 20) spectrum += std::to_string(nm) + ",0.2\n";
    const std::string grey = folder.write("grey.csv", spectrum);
    const std::string ground =
        "albedo --substrate lambert:0.3 --coat isotropic:0@1e-9 --mu-in 1 --wavelengths 400:700:20 "
        "--colour d65 --reference ";
    const auto csv = answer(ground + grey);
    CHECK(std::abs(csv.number(0, "de76") - 116 * (std::cbrt(0.3) - std::cbrt(0.2))) <= 1e-5);
    const auto brdf = answer(
        "brdf --substrate lambert:0.3 --coat isotropic:0@1e-9 --mu-in 1 --mu-out 0.5,1 "
        "--wavelengths 400:700:20 --colour d65 --reference " +
        grey);
    REQUIRE(brdf.size() == 2);
    CHECK(std::abs(brdf.number(1, "y") - 0.3) <= 2e-6);
    CHECK(std::abs(brdf.number(1, "de76") - csv.number(0, "de76")) <= 1e-4);
}

TEST_CASE("tables of colours are references, row by row, under their own light",
          "[program][colour]") {
    const support::TemporaryFolder folder;
    const std::string table = (folder.path() / "colours.csv").string();
    // Tables have six decimals of Lab.
    constexpr double kDecimals = 3e-6;
    const std::string albedo =
        "albedo --base index:1.6,0.05,radius=0.2 --mu-in 0.5,1 --wavelengths 400:700:20 ";
    const std::string over = "albedo --over black,white --theta-in 0,60" + kPaint + " ";
    const std::string brdf =
        "brdf --base hg:0.9,0.5 --mu-in 0.5 --mu-out 0.3,0.9 --wavelengths 400:700:20 ";
    for (const std::string& scene : {albedo, albedo + "--diffuse-fraction 0.3 ", over, brdf}) {
        CAPTURE(scene);
        support::run_ok(scene + "--colour d65,10 -o " + table);
        const auto csv = answer(scene + "--colour d65,10 --reference " + table);
        REQUIRE(csv.size() >= 2);
        for (std::size_t row = 0; row < csv.size(); ++row)
            CHECK(csv.number(row, "de76") <= kDecimals);
        const auto other = support::run_program(scene + "--colour d50 --reference " + table);
        CHECK(other.exit_code == 3);
        CHECK_THAT(other.err, Catch::Contains("10-degree") && Catch::Contains("D50"));
    }
}

TEST_CASE("Lab in CSV is a reference, of a drawdown one for each ground", "[program][colour]") {
    // A grey of Y = 0.3 has L* = 116 cbrt(0.3) - 16 and a* = b* = 0 under any light.
    const support::TemporaryFolder folder;
    const std::string ground =
        "albedo --substrate lambert:0.3 --coat isotropic:0@1e-9 --mu-in 1 --wavelengths 400:700:20 "
        "--colour d65 --reference ";
    const double grey = 116 * std::cbrt(0.3) - 16;
    for (const char* names : {"L*,a*,b*", "sample,lab_l,lab_a,lab_b"}) {
        const std::string sample = std::string(names).starts_with("sample") ? "grey," : "";
        const std::string lab =
            folder.write("lab.csv", std::string(names) + "\n" + sample + "50,3,4\n");
        const auto csv = answer(ground + lab);
        CHECK(std::abs(csv.number(0, "de76") - std::hypot(grey - 50, 5)) <= 1e-5);
        CHECK(std::abs(csv.number(1, "de76") - std::hypot(grey - 50, 5)) <= 1e-5);
    }
    // Over black nothing comes back; the darker row is of the dark ground, whatever its place.
    const std::string film =
        "albedo --coat isotropic:0@1e-9 --wavelengths 400:700:20 --colour d65 ";
    const std::string two = folder.write("two.csv", "lab_l,lab_a,lab_b\n60,0,0\n1,0,0\n");
    const auto csv = answer(film + "--over black,lambert:0.3 --reference " + two);
    REQUIRE(csv.size() == 4);
    CHECK(std::abs(csv.number(0, "de76") - 1) <= 1e-5);
    CHECK(std::abs(csv.number(3, "de76") - std::abs(grey - 60)) <= 1e-5);
    const auto which = support::run_program(ground + two);
    CHECK(which.exit_code == 3);
    CHECK_THAT(which.err, Catch::Contains("which of its 2 colours"));
}

TEST_CASE("a drawdown is compared with spectra over both grounds", "[program][drawdown]") {
    const support::TemporaryFolder folder;
    const std::string scene = "albedo --over black,white --theta-in 0" + kPaint + " ";
    const std::string table = (folder.path() / "spectra.csv").string();
    support::run_ok(scene + "-o " + table);
    const std::string file = folder.write(
        "film.toml",
        "coat = \"index:2.6,1e-4,radius=0.13,distribution=gamma,volume=15% in index:1.5@12um\"\n"
        "substrate = \"black\"\n[[result]]\ncommand = \"albedo\"\n");
    for (const std::string& reference : {table, file}) {
        const auto csv = answer(scene + "--colour d65 --reference " + reference);
        CAPTURE(reference);
        REQUIRE(csv.size() == 4);
        for (std::size_t row = 0; row < csv.size(); ++row) CHECK(csv.number(row, "de76") <= 1e-6);
    }
}

TEST_CASE("a BRDF is compared with a table of it", "[program][colour]") {
    const support::TemporaryFolder folder;
    const std::string scene =
        "brdf --base hg:0.9,0.5 --mu-in 0.5,1 --mu-out 0.3,0.9 --azimuth 0,90 --wavelengths "
        "400:700:20";
    const std::string table = (folder.path() / "table.csv").string();
    support::run_ok(scene + " -o " + table);
    const auto csv = answer(scene + " --colour a --reference " + table);
    CHECK(csv.columns() == Columns{"mu_in", "mu_out", "azimuth_deg", "x", "y", "z", "lab_l",
                                   "lab_a", "lab_b", "srgb_red", "srgb_green", "srgb_blue", "lch_c",
                                   "lch_h", "colour_error", "de76", "de2000", "tint_strength"});
    REQUIRE(csv.size() == 8);
    for (std::size_t row = 0; row < csv.size(); ++row) CHECK(csv.number(row, "de76") <= 1e-6);
}

TEST_CASE("a drawdown says spectra, colours, contrast and hiding power", "[program][drawdown]") {
    const auto spectra = answer("albedo --over black,white" + kPaint);
    CHECK(spectra.columns() ==
          Columns{"wavelength_nm", "mu_in", "albedo_over_dark", "albedo_over_light", "ratio"});
    REQUIRE(spectra.size() == 2 * 11);
    const auto alone = answer("albedo --substrate lambert:0.8 --mu-in 1" + kPaint);
    CHECK(spectra.text(2, "albedo_over_light") == alone.text(1, "plane_albedo"));
    CHECK(spectra.number(0, "ratio") ==
          Approx(spectra.number(0, "albedo_over_dark") / spectra.number(0, "albedo_over_light")));

    const auto colours = answer("albedo --over black,lambert:0.8 --colour d65,10" + kPaint);
    REQUIRE(colours.size() == 4);
    CHECK(colours.text(0, "over") == "black");
    CHECK(colours.text(3, "over") == "lambert:0.8");
    CHECK(colours.number(0, "contrast_ratio") ==
          Approx(colours.number(0, "y") / colours.number(2, "y")).epsilon(1e-5));
    CHECK(colours.number(0, "hiding_thickness_um") *
              colours.number(0, "hiding_spreading_rate_m2_per_l") ==
          Approx(1000));
}

TEST_CASE("the sky's share is a column of albedos and a quantity of BRDFs", "[program][hdrf]") {
    const auto albedo = answer("albedo --base hg:0.9,0.5 --mu-in 0.5 --diffuse-fraction 0.25");
    CHECK(albedo.columns().back() == "blue_sky_albedo");
    CHECK(albedo.number(0, "blue_sky_albedo") ==
          Approx(0.75 * albedo.number(0, "plane_albedo") +
                 0.25 * albedo.number(0, "spherical_albedo")));
    const auto hdrf = answer(
        "brdf --base hg:0.9,0.5 --mu-in 0.5 --mu-out 0.5 --quantity hdrf --diffuse-fraction 1");
    CHECK(hdrf.columns().back() == "hdrf");
    CHECK(hdrf.number(0, "hdrf") == Approx(albedo.number(0, "plane_albedo")).epsilon(1e-9));
}

TEST_CASE("colours and reflectance under a sky have columns of derivatives",
          "[program][colour][hdrf][derivatives]") {
    const std::string scene = " --mu-in 0.5 --wavelengths 400:700:20 --streams 12 --base hg:{w=";
    const auto with = [&](const std::string& command, const std::string& w,
                          const std::string& options) {
        return answer(command + scene + w + "},0.5" + options);
    };
    const auto within = [](double found, double plus, double minus) {
        const double truth = (plus - minus) / 2e-3;
        CAPTURE(found, truth);
        CHECK(std::abs(found - truth) <= 1e-3 * std::abs(truth));  // colours have six decimals
    };
    const std::string colour = " --colour d65,10";
    const auto albedo = with("albedo", "0.9", colour + " --derivatives w");
    CHECK(albedo.columns().back() == "lch_h_d_w");
    const auto more = with("albedo", "0.901", colour), less = with("albedo", "0.899", colour);
    for (const char* name : {"x", "y", "z", "lab_l", "srgb_green"}) {
        CAPTURE(name);
        for (const std::size_t row : {0u, 1u})
            within(albedo.number(row, std::string(name) + "_d_w"), more.number(row, name),
                   less.number(row, name));
    }
    CHECK(albedo.text(0, "lch_h_d_w").empty());  // a grey
    const std::string view = " --mu-out 0.4 --azimuth 30";
    const auto brdf = with("brdf", "0.9", view + colour + " --derivatives w");
    within(brdf.number(0, "y_d_w"), with("brdf", "0.901", view + colour).number(0, "y"),
           with("brdf", "0.899", view + colour).number(0, "y"));
    const std::string sky = view + " --quantity hdrf --diffuse-fraction 0.3";
    within(with("brdf", "0.9", sky + " --derivatives w").number(0, "hdrf_d_w"),
           with("brdf", "0.901", sky).number(0, "hdrf"),
           with("brdf", "0.899", sky).number(0, "hdrf"));
}

TEST_CASE("colours, grounds and skies that cannot be are refused with what is allowed",
          "[program][colour][errors]") {
    const support::TemporaryFolder folder;
    const std::string few =
        folder.write("few.csv", "wavelength_nm,reflectance\n500,0.2\n600,0.2\n");
    const std::string rows = folder.write("rows.csv", "wavelength_nm,reflectance\n500\n");
    const std::string words = folder.write("words.csv", "wavelength_nm,reflectance\n500,abc\n");
    const std::string many = folder.write("many.csv", "wavelength_nm,a,b\n500,1,2\n");
    std::string bad = "wavelength_nm,reflectance\n";
    for (int nm = 400; nm <= 700; nm += 20) bad += std::to_string(nm) + ",-0.2\n";
    const std::string negative = folder.write("negative.csv", bad);
    struct Case {
        std::string arguments, complaint;
        int exit_code;
    };
    const std::string base = "albedo --base hg:0.9,0.5 ";
    const std::string colour = base + "--wavelengths 400:700:20 --colour d65 --reference ";
    const std::string brdf = "brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 ";
    for (const Case& wrong : std::vector<Case>{
             {base + "--colour d65,5", "d65,10", 2},
             {base + "--reference x.csv", "--colour", 2},
             {colour + "nosuch.csv", "nosuch.csv", 3},
             {colour + few, "eight", 3},
             {colour + rows, "rows.csv:2: ", 3},
             {colour + words, "abc", 3},
             {colour + many, "which column", 3},
             {colour + negative, "-0.2", 3},
             {base + "--diffuse-fraction 1.5", "[0, 1]", 2},
             {base + "--diffuse-fraction nan", "nan", 2},
             {base + "--diffuse-fraction -0.1", "-0.1", 2},
             {base + "--diffuse-fraction some", "some", 2},
             {brdf + "--quantity hdrf", "--diffuse-fraction", 2},
             {brdf + "--diffuse-fraction 0.2", "--quantity hdrf", 2},
             {brdf + "--quantity hdrf --diffuse-fraction 2", "[0, 1]", 2},
             {brdf + "--colour d65", "eight wavelengths", 2},
             {brdf + "--roughness 0.3 --surface-index 1.5 --quantity hdrf --diffuse-fraction 0.1",
              "reciprocal", 2},
             {base + "--over black,white", "--over", 2},
             {"albedo --over black,white --diffuse-fraction 0.2" + kPaint, "--diffuse-fraction", 2},
             {"albedo --over black" + kPaint, "two", 2},
             {"albedo --over black,white,black" + kPaint, "3 grounds", 2},
             {"albedo --over black,grass" + kPaint, "grass", 2},
             {"albedo --over black,lambert:1.3" + kPaint, "1.3", 2},
             {"albedo --over white,black --colour d65" + kPaint, "lighter", 2},
             {"albedo --wavelengths 550", "--base or --substrate", 2}}) {
        const auto run = support::run_program(wrong.arguments);
        CAPTURE(wrong.arguments, run.err);
        CHECK(run.exit_code == wrong.exit_code);
        CHECK(run.out.empty());
        CHECK_THAT(run.err, Catch::Contains(wrong.complaint));
    }
}

TEST_CASE("columns of tables become a chart, and wrong ones a message", "[program][plot]") {
    const support::TemporaryFolder folder;
    const std::string line = folder.write("line.csv", "# note\nx,y\n1,0.2\n2,0.4\n3,\n4,0.3\n");
    const std::string points = folder.write("points.csv", "x,y\n2,0.5\n");
    const auto chart = support::run_program("plot columns a=" + line + " --points a=" + points +
                                            " --x x --y y --range 0,1 --title Chart");
    CAPTURE(chart.err);
    CHECK(chart.exit_code == 0);
    CHECK_THAT(chart.out, Catch::Contains("<svg") && Catch::Contains("Chart"));
    const std::string text = folder.write("text.csv", "x,y\n1,two\n");
    const std::string empty = folder.write("empty.csv", "x,y\n");
    struct Case {
        std::string arguments, complaint;
        int exit_code;
    };
    for (const Case& wrong : std::vector<Case>{{"nosuch.csv --y y", "nosuch.csv", 3},
                                               {line + " --x x --y z", "x, y", 2},
                                               {text + " --x x --y y", "two", 3},
                                               {empty + " --x x --y y", "no rows", 3},
                                               {line + " --x x --y y --range 1,0", "1,0", 2}}) {
        const auto run = support::run_program("plot columns " + wrong.arguments);
        CAPTURE(wrong.arguments, run.err);
        CHECK(run.exit_code == wrong.exit_code);
        CHECK(run.out.empty());
        CHECK_THAT(run.err, Catch::Contains(wrong.complaint));
    }
}
