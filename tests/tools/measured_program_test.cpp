// miebrdf measured, and measurements as references and points.
#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

const std::string kGreyChart =
    "CGATS.17\nMEASUREMENT_GEOMETRY \"Sphere d/8 SPIN\"\nBEGIN_DATA_FORMAT\nSAMPLE_NAME SPEC_400 "
    "SPEC_450 SPEC_500 SPEC_550 SPEC_600 SPEC_620 SPEC_650 SPEC_700\nEND_DATA_FORMAT\nBEGIN_DATA\n"
    "grey 20 20 20 20 20 20 20 20\nEND_DATA\n";

}  // namespace

TEST_CASE("measured prints what it understood, and reads its own rows again",
          "[program][measured]") {
    const support::TemporaryFolder folder;
    const std::string chart = folder.write("chart.txt", kGreyChart);
    const std::string own = folder / "own.csv", picture = folder / "picture.svg";
    const auto run =
        support::run_ok("measured " + chart + " --sigma 0.01 --plot " + picture + " -o " + own);
    CHECK_THAT(support::read_file(picture), Catch::Contains("<svg") && Catch::Contains("grey"));
    const std::string text = support::read_file(own);
    CHECK_THAT(text, Catch::Contains("# format: cgats"));
    CHECK_THAT(text, Catch::Contains("# reflectance, d8-sci: 8 values, 400 to 700 nm"));
    CHECK_THAT(text, Catch::Contains("quantity,geometry,wavelength_nm,mu_in,mu_out,azimuth_deg,"
                                     "value,sigma\nreflectance,d8-sci,400,0.99026806874157"));
    const auto again = support::run_ok("measured " + own);
    const auto rows = [](const std::string& table) {
        return table.substr(table.find("quantity,"));
    };
    CHECK(rows(again.out) == rows(text));
}

TEST_CASE("a goniometer's list is drawn against the angle of reflection", "[program][measured]") {
    const support::TemporaryFolder folder;
    const std::string list =
        folder.write("list.csv",
                     "theta_i,phi_i,theta_r,phi_r,nm,brdf\n45,0,45,180,500,0.5\n45,0,45,0,500,0.2\n"
                     "45,0,30,90,500,0.3\n");
    const std::string picture = folder / "list.svg";
    const auto run = support::run_program("measured " + list + " --plot " + picture);
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(support::read_file(picture), Catch::Contains("angle of reflection"));
}

TEST_CASE("a measured chart is a reference for colours, and points beside a spectrum",
          "[program][measured]") {
    const support::TemporaryFolder folder;
    const std::string chart = folder.write("chart.txt", kGreyChart);
    const auto colour = support::run_ok(
        "albedo --substrate lambert:0.2 --coat isotropic:0@1e-9 --mu-in 1 --wavelengths "
        "400:700:20 --colour d65 --reference " +
        chart);
    CHECK(support::CsvOutput(colour.out).number(0, "de76") <= 1e-4);
    const auto plot = support::run_program(
        "plot spectrum --base hg:0.9,0.5 --wavelengths 400:600:100 --points " + chart);
    CAPTURE(plot.err);
    CHECK(plot.exit_code == 0);
    CHECK_THAT(plot.out, Catch::Contains("grey"));
}

TEST_CASE("measurements that cannot be used are refused with what would help",
          "[program][measured][errors]") {
    const support::TemporaryFolder folder;
    const std::string percent = folder.write("percent.csv", "nm,R\n400,80\n500,81\n");
    const std::string chart = folder.write("chart.txt", kGreyChart);
    struct Case {
        std::string arguments, complaint;
        int exit_code;
    };
    for (const Case& wrong : std::vector<Case>{
             {"measured " + percent, "percent", 3},
             {"measured nosuch.csv", "nosuch.csv", 3},
             {"measured " + chart + " --column blue", "grey", 2},
             {"measured " + chart + " --quantity gloss", "d8-sci", 2},
             {"measured " + chart + " --plot x.pdf", ".svg", 2},
             {"measured " + chart + " --percent --shares", "--shares", 2},
             {"measured " + chart + " --mu-in 0.5,1", "2 numbers", 2},
             {"plot spectrum --base hg:0.9,0.5 --wavelengths 900:950:10 --points " + chart,
              "no reflectance from 900", 3}}) {
        const auto run = support::run_program(wrong.arguments);
        CAPTURE(wrong.arguments, run.err);
        CHECK(run.exit_code == wrong.exit_code);
        CHECK(run.out.empty());
        CHECK_THAT(run.err, Catch::Contains(wrong.complaint));
    }
    CHECK(support::run_program("measured " + percent + " --percent").exit_code == 0);
}

TEST_CASE("measured directions become a file for renderers, with their residual said",
          "[program][measured]") {
    const support::TemporaryFolder folder;
    std::string text = "theta_i,theta_r,azimuth_deg,nm,brdf\n";
    for (const int in : {0, 30, 60}) {
        for (const int out : {0, 20, 40, 60, 75}) {
            for (const int azimuth : {0, 60, 120, 180})
                text += std::to_string(in) + "," + std::to_string(out) + "," +
                        std::to_string(azimuth) + ",550,0.2\n";
        }
    }
    const std::string list = folder.write("list.csv", text), out = folder / "made.csv";
    const auto run = support::run_ok("export --format csv --from " + list + " -o " + out);
    CHECK_THAT(run.err, Catch::Contains("interpolated from 60 measured values"));
    // A Lambertian BRDF of 0.2 has the albedo 0.2 pi at measured incidences and below them.
    CHECK_THAT(run.err, Catch::Contains("albedo 0.628 from mu_in 0.5 up, as measured; 0.628 with"));
    CHECK_THAT(support::read_file(out), Catch::Contains(list));
    const support::CsvOutput table(support::read_file(out));
    REQUIRE(table.size() > 100);
    // A Lambertian surface stays one, beyond the measured directions too.
    for (std::size_t row = 0; row < table.size(); row += 37)
        CHECK(table.number(row, "brdf") == Approx(0.2).epsilon(1e-4));
    const auto check = support::run_program("check " + out);
    CHECK(check.exit_code == 0);

    const std::string from = "export --from " + list + " -o " + out + " --format ";
    for (const auto& [words, complaint] : {std::pair<std::string, std::string>{"spd", "no BRDF"},
                                           {"csv --base TiO2", "--base"},
                                           {"csv --column x", "column"}}) {
        const auto wrong = support::run_program(from + words);
        CAPTURE(words, wrong.err);
        CHECK(wrong.exit_code == 2);
        CHECK_THAT(wrong.err, Catch::Contains(complaint));
    }
}
