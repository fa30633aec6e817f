// Sweeps and look-ups as their users type them.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "pipeline/io/netcdf_file.h"
#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Catch::Contains;
using support::run_program;

namespace {

constexpr char kProgramSweep[] = R"(outputs = ["brdf", "spherical_albedo"]
chunk = 3
[scene]
base = "hg:{albedo},{g}"
tolerance = 1e-2
[axes]
albedo = "0.1:0.9:5 linear"
g = [0, 0.2, 0.4]
mu_in = [0.5, 1]
mu_out = [0.3, 0.6, 0.9]
azimuth_deg = "0:180:90"
wavelength_nm = [500, 600]
)";

std::string bytes_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string extension() { return has_netcdf() ? ".nc" : ".csv"; }

}  // namespace

TEST_CASE("parts of several processes merge to the bytes of one", "[sweep][program]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write("s.toml", kProgramSweep);
    const std::string one = folder / ("one" + extension()), many = folder / ("many" + extension());
    support::run_ok("sweep " + file + " -o " + one);
    const auto early = run_program("sweep " + file + " --merge -o " + many);
    CHECK(early.exit_code == 3);
    CHECK_THAT(early.err, Contains("5 of 5 chunks are missing"));
    for (const char* part : {"3/3", "1/3", "2/3"})
        support::run_ok("sweep " + file + " --part " + part + " -o " + many);
    support::run_ok("sweep " + file + " --merge -o " + many);
    CHECK(bytes_of(one) == bytes_of(many));
    CHECK_FALSE(std::filesystem::exists(many + ".parts"));

    const auto again = run_program("sweep " + file + " -o " + many);
    CHECK(again.exit_code == 0);
    CHECK_THAT(again.err, Contains("complete already"));
}

TEST_CASE("CSV has a row for each scene, wavelength and direction", "[sweep][program]") {
    const support::TemporaryFolder folder;
    const std::string table = folder / "t.csv";
    support::run_ok("sweep " + folder.write("s.toml", kProgramSweep) + " -o " + table);
    const support::CsvOutput csv(bytes_of(table));
    REQUIRE(csv.size() == 5 * 3 * 2 * 2 * 3 * 3);
    const auto alone = run_program(
        "brdf --base hg:0.1,0 --tolerance 1e-2 --wavelengths 500,600 --mu-in 0.5,1 --mu-out "
        "0.3,0.6,0.9 --azimuth 0,90,180 --no-cache");
    const support::CsvOutput expected(alone.out);
    REQUIRE(expected.size() == 36);
    CHECK(csv.text(0, "converged") == "1");
    CHECK(csv.text(0, "brdf") == expected.text(0, "brdf"));  // to the last bit
}

TEST_CASE("sweeps store derivatives by axes and by named numbers",
          "[sweep][program][derivatives]") {
    const support::TemporaryFolder folder;
    // Nodes are given, so that neighbouring scenes are solved alike.
    const std::string text = R"(outputs = ["brdf", "plane_albedo", "spherical_albedo"]
derivatives = ["albedo", "g"]
[scene]
base = "hg:{albedo},{g=0.4}"
coat = "isotropic:0.9@0.5"
streams = 12
tolerance = 1e-5
[axes]
albedo = [0.699, 0.7, 0.701]
mu_in = [0.5, 1]
mu_out = [0.3]
azimuth_deg = [0, 90]
wavelength_nm = [500]
)";
    const std::string table = folder / "t.csv";
    support::run_ok("sweep " + folder.write("s.toml", text) + " -o " + table);
    const support::CsvOutput csv(bytes_of(table));
    constexpr std::size_t directions = 4;
    REQUIRE(csv.size() == 3 * directions);
    const std::string alone =
        " --base 'hg:{albedo=0.7},{g=0.4}' --coat isotropic:0.9@0.5 --streams 12 --tolerance 1e-5 "
        "--wavelengths 500 --mu-in 0.5,1 --derivatives albedo,g --no-cache";
    const support::CsvOutput albedos = support::csv_of("albedo" + alone);
    const support::CsvOutput brdf = support::csv_of("brdf --mu-out 0.3 --azimuth 0,90" + alone);
    for (const char* value : {"brdf", "plane_albedo", "spherical_albedo"}) {
        const std::string by_albedo = std::string(value) + "_d_albedo";
        for (std::size_t row = 0; row < directions; ++row) {
            CAPTURE(value, row);
            const std::size_t here = directions + row;
            const double slope =
                (csv.number(here + directions, value) - csv.number(row, value)) / 2e-3;
            // The third derivative is some 4 / (1 - albedo)^2 of the first, and counts h^2 / 6.
            CHECK(std::abs(csv.number(here, by_albedo) - slope) <= 2e-5 * std::abs(slope));
            const bool is_brdf = std::string(value) == "brdf";
            const support::CsvOutput& truth = is_brdf ? brdf : albedos;
            const std::size_t place = is_brdf ? row : row / 2;
            for (const std::string& by : {by_albedo, std::string(value) + "_d_g"})
                CHECK(csv.number(here, by) == truth.number(place, by));
        }
    }
}

TEST_CASE("contrast ratios of a sweep are those of drawdowns", "[sweep][program]") {
    const support::TemporaryFolder folder;
    const std::string film = "index:2.6,1e-4,radius=0.13,volume=15% in index:1.5@";
    const std::string table = folder / "t.csv";
    support::run_ok("sweep " +
                    folder.write("s.toml",
                                 "outputs = [\"contrast_ratio\"]\n[scene]\nsubstrate = "
                                 "\"black\"\ncoat = \"" +
                                     film +
                                     "{um}um\"\n[axes]\n"
                                     "um = [5, 20]\nmu_in = [1]\n"
                                     "wavelength_nm = \"400:700:30\"\n") +
                    " -o " + table);
    const support::CsvOutput rows(bytes_of(table));
    REQUIRE(rows.size() == 2);
    for (std::size_t row = 0; row < 2; ++row) {
        const auto drawdown = support::csv_of(
            "albedo --over black,white --colour d65 --mu-in 1 --wavelengths 400:700:30 --coat '" +
            film + (row == 0 ? "5um'" : "20um'"));
        CHECK(std::abs(rows.number(row, "contrast_ratio") - drawdown.number(0, "contrast_ratio")) <=
              1e-9);
    }
}

TEST_CASE("tables of sweeps hold Mueller matrices", "[sweep][program][polarisation]") {
    const support::TemporaryFolder folder;
    const std::string four = GENERATE(as<std::string>(), "", "stokes = 4\n");
    const std::string text = R"(outputs = ["brdf", "mueller"]
[scene]
base = "rayleigh:{albedo}"
)" + four + R"([axes]
albedo = [0.5, 0.9]
mu_in = [0.8]
mu_out = [0.5, 1]
azimuth_deg = [0, 90]
wavelength_nm = [500]
)";
    const std::string table = folder / "t.csv";
    support::run_ok("sweep " + folder.write("s.toml", text) + " -o " + table);
    const support::CsvOutput csv(bytes_of(table));
    REQUIRE(csv.size() == 8);
    const auto alone = run_program(
        "brdf --base rayleigh:0.5 --wavelengths 500 --mu-in 0.8 "
        "--mu-out 0.5,1 --azimuth 0,90 --no-cache --stokes " +
        std::string(four.empty() ? "3" : "4"));
    const support::CsvOutput expected(alone.out);
    for (const std::string& column : expected.columns()) {
        if (column[0] != 'm' || column.starts_with("mu")) continue;
        CAPTURE(column);
        for (std::size_t row = 0; row < 4; ++row)
            CHECK(csv.text(row, column) == expected.text(row, column));
    }
    CHECK(std::abs(csv.number(0, "brdf") - csv.number(0, "m11")) <= 2e-3 * csv.number(0, "m11"));
}

TEST_CASE("look-ups find nodes and what lies between", "[sweep][program]") {
    if (!has_netcdf()) {
        WARN("skipped: this build has no NetCDF");
        return;
    }
    const support::TemporaryFolder folder;
    const std::string table = folder / "t.nc";
    support::run_ok("sweep " + folder.write("s.toml", kProgramSweep) + " -o " + table);
    const auto run = support::run_ok("lookup " + table +
                                     " --albedo 0.6 --g=0.2 --wavelength 550 --variables "
                                     "spherical_albedo --interpolation cubic");
    const support::CsvOutput found(run.out);
    REQUIRE(found.size() == 1);
    const support::CsvOutput exact(
        run_program("albedo --base hg:0.6,0.2 --wavelengths 550 --no-cache").out);
    const double error = std::abs(found.number(0, "value") - exact.number(0, "spherical_albedo"));
    CHECK(error <= 0.02 * found.number(0, "value"));
    const auto all = run_program("lookup " + table + " --albedo 0.5 --variables spherical_albedo");
    CHECK(support::CsvOutput(all.out).size() == 3 * 2);

    CHECK(run_program("lookup " + table + " --albedo 0.95").exit_code == 2);
    CHECK_THAT(run_program("lookup " + table + " --radius 3").err,
               Contains("no axis 'radius'") && Contains("albedo"));
    CHECK_THAT(run_program("lookup " + table + " --albedo").err, Contains("needs a value"));
    CHECK(run_program("lookup " + folder.write("no.nc", "no table")).exit_code == 3);
}

TEST_CASE("a sweep with scenes that cannot be computed says so, not that a tolerance is missed",
          "[sweep][program][errors]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write("s.toml",
                                          "outputs = [\"spherical_albedo\"]\n[scene]\nbase = "
                                          "\"isotropic:{a}\"\n[axes]\na = [0.5, 1.5]\n"
                                          "wavelength_nm = 550\n");
    const auto run = run_program("sweep " + file + " -o " + (folder / "t.csv"));
    CHECK(run.exit_code == 4);
    CHECK_THAT(run.err, Contains("1 of 2 scenes could not be computed") && Contains("remark") &&
                            !Contains("--tolerance"));
}

TEST_CASE("sweeps refuse what they cannot do before they begin", "[sweep][program][errors]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write("s.toml", kProgramSweep);
    CHECK(run_program("sweep " + file).exit_code == 2);
    CHECK_THAT(run_program("sweep " + file + " -o " + (folder / "t.xls")).err, Contains(".nc"));
    CHECK_THAT(run_program("sweep " + file + " --plan --merge -o " + (folder / "t.csv")).err,
               Contains("one of them"));
    CHECK_THAT(run_program("sweep " + file + " --part 5/4 -o " + (folder / "t.csv")).err,
               Contains("5/4"));
    const auto plan = run_program("sweep " + file + " --plan");
    CHECK(plan.exit_code == 0);
    CHECK_THAT(plan.out, Contains("scenes,15,"));
    const auto script = run_program("sweep " + file + " --sbatch 4 -o " + (folder / "t.csv"));
    CHECK_THAT(script.out, Contains("--array=1-4"));
    CHECK_FALSE(std::filesystem::exists(folder / "t.csv.parts"));
}

TEST_CASE("plug-ins are found without /proc", "[sweep][program]") {
    // The loader asks /proc where $ORIGIN of the run path is; containers and roots of their own may
    // have none.
    const support::TemporaryFolder folder;
    const std::string empty = folder / "empty";
    std::filesystem::create_directory(empty);
    const std::string hide = "unshare -rm sh -c 'mount --bind \"" + empty + "\" /proc && exec ";
    if (!has_netcdf() || std::system((hide + "true' 2>/dev/null").c_str()) != 0) {
        WARN("skipped: this needs unshare(1), the right to mount, and a build with NetCDF");
        return;
    }
    const std::string file = folder.write("s.toml", kProgramSweep), table = folder / "t.nc";
    const auto run = run_program("sweep " + file + " -o " + table, hide + "\"$0\" \"$@\"'");
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    CHECK(std::filesystem::exists(table));
}

TEST_CASE("sweeps have reflectance factors and emissivities", "[sweep][program]") {
    const support::TemporaryFolder folder;
    const std::string text = R"(outputs = ["hdrf", "emissivity", "plane_albedo", "brdf"]
derivatives = ["g"]
diffuse_fraction = 1
[scene]
base = "hg:0.9,{g}"
[axes]
g = [0.1, 0.4]
mu_in = [0.5, 0.9]
mu_out = [0.5, 0.9]
azimuth_deg = [0]
wavelength_nm = 11000
)";
    const std::string file = folder.write("s.toml", text);
    support::run_ok("sweep " + file + " -o " + (folder / "t.csv"));
    const auto table = support::CsvOutput(bytes_of(folder / "t.csv"));
    REQUIRE(table.size() == 8);
    for (std::size_t row = 0; row < table.size(); ++row) {
        CHECK(std::abs(table.number(row, "emissivity") + table.number(row, "plane_albedo") - 1) <=
              1e-12);
        CHECK(table.number(row, "emissivity_d_g") == -table.number(row, "plane_albedo_d_g"));
        // Of a uniform sky the plane albedo of the direction of reflection, at the same tolerance.
        if (table.number(row, "mu_in") != table.number(row, "mu_out")) continue;
        CHECK(table.number(row, "hdrf") == Approx(table.number(row, "plane_albedo")).epsilon(1e-9));
    }
    // A Lambertian ground has its albedo under every sky.
    support::run_ok("sweep " +
                    folder.write("g.toml",
                                 "outputs = [\"hdrf\"]\ndiffuse_fraction = 0.7\nsky = "
                                 "\"cie-clear\"\n[scene]\nsubstrate = \"lambert:{a}\"\n[axes]\n"
                                 "a = [0.2, 0.6]\nmu_in = 0.5\nmu_out = 0.9\nazimuth_deg = 0\n"
                                 "wavelength_nm = 550\n") +
                    " -o " + (folder / "g.csv"));
    const auto ground = support::CsvOutput(bytes_of(folder / "g.csv"));
    for (std::size_t row = 0; row < 2; ++row)
        CHECK(ground.number(row, "hdrf") == Approx(ground.number(row, "a")).epsilon(1e-9));
    const auto refused = [&](const std::string& what, const std::string& with, const char* reason) {
        std::string bad = text;
        bad.replace(bad.find(what), what.size(), with);
        const auto run =
            run_program("sweep " + folder.write("b.toml", bad) + " -o " + (folder / "b.csv"));
        CHECK(run.exit_code != 0);
        CHECK_THAT(run.err, Contains(reason));
    };
    refused("diffuse_fraction = 1\n", "", "needs diffuse_fraction");
    refused("diffuse_fraction = 1\n", "diffuse_fraction = 1.5\n", "0 to 1");
    refused("base = \"hg:0.9,{g}\"", "substrate = \"none\"\ncoat = \"hg:0.9,{g}@1\"",
            "no emissivity");
}
