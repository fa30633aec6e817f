// Bad input of every kind: one clear line on stderr, the right exit code, nothing half-written.
#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

constexpr int kUsage = 2;
constexpr int kBadInput = 3;

void check_one_line(const support::ProgramRun& run, int exit_code,
                    const std::vector<std::string>& words) {
    CAPTURE(run.err, run.out);
    CHECK(run.exit_code == exit_code);
    CHECK(run.out.empty());
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_THAT(run.err, Catch::StartsWith("miebrdf: error: "));
    for (const std::string& word : words) CHECK_THAT(run.err, Catch::Contains(word));
}

const std::string kDirections = " --wavelengths 550 --mu-in 0.5 --mu-out 0.5 --azimuth 0 ";

}  // namespace

TEST_CASE("numbers out of range end with exit code 2, the value and what is allowed",
          "[program][errors]") {
    struct Case {
        const char* arguments;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {"brdf --base hg:0.9,0.5 --mu-in 0 --mu-out 1", {"0 is out of range", "(0, 1]"}},
        {"brdf --base hg:0.9,0.5 --mu-in 0.5 --mu-out 1.5", {"1.5", "(0, 1]"}},
        {"brdf --base hg:0.9,0.5 --mu-in nan --mu-out 1", {"nan", "finite"}},
        {"brdf --base hg:0.9,0.5 --mu-in -0.5 --mu-out 1", {"-0.5", "(0, 1]"}},
        {"brdf --base hg:1.5,0.5 --mu-in 0.5 --mu-out 1", {"1.5", "[0, 1]"}},
        {"brdf --base isotropic:nan --mu-in 0.5 --mu-out 1", {"nan"}},
        {"brdf --base hg:0.9,0.5 --coat hg:0.9,0.1@-0.1 --mu-in 1 --mu-out 1", {"-0.1", ">= 0"}},
        {"brdf --base hg:0.9,0.5 --coat hg:0.9,0.1 --mu-in 1 --mu-out 1", {"MEDIUM@OPTICAL_DEPTH"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --azimuth 400", {"400", "360"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --tolerance 0", {"tolerance", "(0, 1)"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --streams 1", {"1", "2 to 256"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --grid square", {"square", "gauss"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --roughness -1", {"-1", "0"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --roughness 0.3", {"--surface-index"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --component lobe", {"lobe", "subsurface"}},
        {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --wavelengths -5", {"-5"}},
        {"brdf --base TiO2 --mu-in 1 --mu-out 1 --effective-radius 0", {"0", "> 0"}},
        {"brdf --base TiO2 --mu-in 1 --mu-out 1 --size-distribution cubic", {"cubic", "power-law"}},
        {"albedo --base isotropic:2", {"2", "[0, 1]"}},
        {"sphere --index 1.5,-1 --size-parameter 1", {"-1", "k >= 0"}},
        {"sphere --index 1.5,0 --size-parameter -1", {"-1"}},
        {"sphere --index 1.5,0 --size-parameter 1 --angles 200", {"200", "180"}},
        {"optics index:0,0", {"n > 0"}},
        {"phase hg:0.9,0.5 --angles -1", {"-1", "[0, 180]"}},
        {"table1 --convention 9", {"9"}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.arguments);
        check_one_line(support::run_program(c.arguments), kUsage, c.words);
    }
}

TEST_CASE("a command line that cannot be read ends with exit code 2", "[program][errors]") {
    check_one_line(support::run_program("brdf"), kUsage, {"--base"});
    check_one_line(support::run_program("paint"), kUsage, {"--help"});
    check_one_line(support::run_program("brdf --bsae TiO2"), kUsage, {"--help"});
}

TEST_CASE("an unknown material is answered with the nearest names", "[program][errors]") {
    check_one_line(support::run_program("optics TiO3 --wavelengths 550"), kBadInput,
                   {"TiO3", "TiO2"});
}

TEST_CASE("a wavelength outside the table is answered with the valid range", "[program][errors]") {
    check_one_line(support::run_program("optics TiO2 --wavelengths 5000"), kBadInput,
                   {"TiO2", "5000", "360", "840"});
}

TEST_CASE("a moments file that is wrong or missing is named", "[program][errors]") {
    const support::TemporaryFolder folder;
    const std::string wrong =
        folder.write("m.csv", "# single_scattering_albedo: 0.9\nl,chi\n0,0.5\n");
    check_one_line(support::run_program("brdf --base moments:" + wrong + kDirections), kBadInput,
                   {"m.csv", "chi_0 = 0.5"});
    check_one_line(support::run_program("brdf --base moments:/no/such.csv" + kDirections),
                   kBadInput, {"/no/such.csv"});
}

TEST_CASE("an output that cannot be written leaves nothing behind", "[program][errors]") {
    check_one_line(
        support::run_program("brdf --base isotropic:0.9" + kDirections + "-o /no/such/dir/x.csv"),
        kBadInput, {"/no/such/dir/x.csv"});
    check_one_line(support::run_program("brdf --base isotropic:0.9" + kDirections + "-o /dev/full"),
                   kBadInput, {"/dev/full"});
}

TEST_CASE("an error after the output was named leaves no partial file and keeps the old one",
          "[program][errors]") {
    const support::TemporaryFolder folder;
    const std::string old = folder.write("old.csv", "precious");
    const auto run = support::run_program("optics TiO2 --wavelengths 5000 -o " + old);
    CHECK(run.exit_code == kBadInput);
    CHECK(support::read_file(old) == "precious");
    CHECK(folder.count() == 1);
}

TEST_CASE("a damaged, truncated or foreign database is refused and left as it was",
          "[program][errors]") {
    const support::TemporaryFolder folder;
    const std::string foreign = folder.write("foreign.db", std::string(8192, 'x'));
    const std::string truncated = folder.write("truncated.db", "SQLite format 3");
    // A database of ours, cut in half.
    const std::string cut = folder / "cut.db";
    const std::string table = folder.write("x.csv", "wavelength_nm,n,k\n400,1.5,0\n700,1.4,0\n");
    REQUIRE(support::run_program("materials import " + table + " --name Testite --database " + cut)
                .exit_code == 0);
    std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
    for (const std::string& file : {foreign, truncated, cut, folder / "missing.db"}) {
        CAPTURE(file);
        check_one_line(support::run_program("optics TiO2 --wavelengths 550 --database " + file),
                       kBadInput, {file});
        check_one_line(
            support::run_program("optics TiO2 --wavelengths 550", "MIEBRDF_DATABASE=" + file),
            kBadInput, {file});
    }
    CHECK(support::read_file(foreign) == std::string(8192, 'x'));
    CHECK_FALSE(std::filesystem::exists(folder / "missing.db"));
}

TEST_CASE("a scene file's mistakes are named with line and column", "[program][errors]") {
    const support::TemporaryFolder folder;
    struct Case {
        const char* text;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {"base = \"TiO2\"\nroughnes = 0.3\n[[result]]\ncommand = \"albedo\"\n",
         {"line 2, column 1", "roughnes"}},
        {"[scene.a]\n  bsae = \"TiO2\"\n[[result]]\ncommand = \"albedo\"\n",
         {"line 2, column 3", "bsae"}},
        {"[[result]]\ncommand = \"albedo\"\nmu-out = 1\n", {"line 3, column 1", "mu-out", "albedo"}},
        {"[[result]]\ncommand = \"paint\"\n", {"line 2, column 11", "paint", "brdf"}},
        {"[[result]]\ncommand = \"brdf\"\nscene = \"b\"\n", {"line 3", "no such scene"}},
        {"base = \n", {"line 1"}},
    };
    for (const Case& c : cases) {
        const std::string file = folder.write("scene.toml", c.text);
        for (const char* command : {"run ", "plan "}) {
            CAPTURE(c.text, command);
            check_one_line(support::run_program(command + file), kBadInput, c.words);
        }
    }
}

TEST_CASE("run finds a mistake in a later result before it computes the first",
          "[program][errors][scene]") {
    const support::TemporaryFolder folder;
    const std::string first = "mu-in = 1\n[[result]]\ncommand = \"albedo\"\nbase = \"hg:0.9,0.5\"\noutput = \"" +
                              (folder / "first.csv") + "\"\n[[result]]\ncommand = \"albedo\"\n";
    struct Case {
        const char* second;
        int exit_code;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {"base = \"TiO22\"\n", kBadInput, {"result 2 (albedo)", "TiO22"}},
        {"base = \"TiO2\"\nwavelengths = 50\n", kBadInput, {"result 2 (albedo)", "50"}},
        {"base = \"hg:2,0.5\"\n", kUsage, {"result 2 (albedo)", "2"}},
        {"", kUsage, {"result 2 (albedo)", "--base"}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.second);
        const std::string file = folder.write("scene.toml", first + c.second);
        check_one_line(support::run_program("run " + file), c.exit_code, c.words);
        CHECK_FALSE(std::filesystem::exists(folder / "first.csv"));
    }
    const std::string good = folder.write("scene.toml", first + "base = \"hg:0.9,0.5\"\n");
    check_one_line(support::run_program("run " + good + " -o x.csv"), kUsage, {"output"});
}

TEST_CASE("exit code 4 is explained on stderr", "[program][errors]") {
    // Three nodes cannot resolve such a peak.
    const auto run = support::run_program("brdf --base hg:0.9,0.9 --streams 3" + kDirections);
    CHECK(run.exit_code == 4);
    CHECK_THAT(run.err, Catch::Contains("not converged"));
    CHECK_THAT(run.out, Catch::Contains("# not converged"));
}
