// Bad input of every kind: one clear line on stderr, the right exit code, nothing half-written.
#include <cstdlib>
#include <filesystem>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;
using support::check_one_line;
using support::check_refused;
using support::kBadInput;
using support::kUsage;

namespace {

const std::string kDirections = " --wavelengths 550 --mu-in 0.5 --mu-out 0.5 --azimuth 0 ";

}  // namespace

TEST_CASE("numbers out of range end with exit code 2, the value and what is allowed",
          "[program][errors]") {
    check_refused(
        kUsage,
        {
            {"brdf --base hg:0.9,0.5 --mu-in 0 --mu-out 1", {"0 is out of range", "(0, 1]"}},
            {"brdf --base hg:0.9,0.5 --mu-in 0.5 --mu-out 1.5", {"1.5", "(0, 1]"}},
            {"brdf --base hg:0.9,0.5 --mu-in nan --mu-out 1", {"nan", "finite"}},
            {"brdf --base hg:0.9,0.5 --mu-in -0.5 --mu-out 1", {"-0.5", "(0, 1]"}},
            {"brdf --base hg:1.5,0.5 --mu-in 0.5 --mu-out 1", {"1.5", "[0, 1]"}},
            {"brdf --base isotropic:nan --mu-in 0.5 --mu-out 1", {"nan"}},
            {"brdf --base hg:0.9,0.5 --coat hg:0.9,0.1@-0.1 --mu-in 1 --mu-out 1",
             {"-0.1", ">= 0"}},
            {"brdf --base hg:0.9,0.5 --coat hg:0.9,0.1 --mu-in 1 --mu-out 1", {"MEDIUM@DEPTH"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --azimuth 400", {"400", "360"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --tolerance 0", {"tolerance", "(0, 1)"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --streams 1", {"1", "2 to 256"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --grid square", {"square", "gauss"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --roughness -1", {"-1", "0"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --roughness 0.3", {"--surface-index"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --component lobe",
             {"lobe", "subsurface"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --wavelengths -5", {"-5"}},
            {"brdf --base TiO2 --mu-in 1 --mu-out 1 --effective-radius 0", {"0", "> 0"}},
            {"brdf --base TiO2 --mu-in 1 --mu-out 1 --size-distribution cubic",
             {"cubic", "power-law"}},
            {"optics TiO2 --effective-radius inf", {"--effective-radius", "inf", "finite"}},
            {"optics TiO2 --effective-radius 1e6", {"--effective-radius 1000000", "1e+06"}},
            {"albedo --base isotropic:2", {"2", "[0, 1]"}},
            {"sphere --index 1.5,-1 --size-parameter 1", {"-1", "k >= 0"}},
            {"sphere --index 1.5,0 --size-parameter -1", {"-1"}},
            {"sphere --index 1.5,0 --size-parameter 1 --angles 200", {"200", "180"}},
            {"sphere --index 1.5,0 --size-parameter 1 --aspect 9", {"aspect: 9", "0.25 to 4"}},
            {"sphere --index 1.5,0 --size-parameter 60 --aspect 2", {"75.6", "up to 50"}},
            {"sphere --index 1.5,0 --size-parameter 1 --aspect 2 --angles 0",
             {"--angles", "--stokes"}},
            {"optics index:0,0", {"n > 0"}},
            // Squares of such numbers overflow: the albedo had no value, and exit code 0.
            {"albedo --substrate mirror:index:1e155,1 --coat isotropic:0.5@1", {"1e+155", "1e6"}},
            {"brdf --base TiO2 --roughness 0.3 --surface-index 1,1e155 --mu-in 1 --mu-out 1",
             {"1e+155", "1e6"}},
            {"phase hg:0.9,0.5 --angles -1", {"-1", "[0, 180]"}},
            {"table1 --convention 9", {"9"}},
        });
}

TEST_CASE("a command line that cannot be read ends with exit code 2", "[program][errors]") {
    check_refused(kUsage, {{"brdf", {"--base"}},
                           {"brdf --base hg:0.9,0.5", {"--mu-in"}},
                           {"albedo", {"--base", "--substrate"}},
                           {"paint", {"--help"}}});
}

TEST_CASE("words that no command knows are answered with the nearest that it does",
          "[program][errors]") {
    check_refused(
        kUsage,
        {
            {"albdo --base TiO2", {"'albdo'", "did you mean albedo?", "miebrdf --help"}},
            {"xyzzyx", {"'xyzzyx'", "allowed: brdf, albedo"}},
            {"plot hemi", {"'hemi'", "did you mean hemisphere?", "miebrdf plot --help"}},
            {"plan brfd --base TiO2", {"'brfd'", "did you mean brdf?"}},
            {"materials serch oxide", {"'serch'", "did you mean search?"}},
            // Before what is missing: --base is required only because it was mistyped.
            {"brdf --bsae TiO2", {"'--bsae'", "did you mean --base?", "miebrdf brdf --help"}},
            {"brdf --base TiO2 --wavelength=550",
             {"'--wavelength'", "did you mean --wavelengths?"}},
            {"albedo --base TiO2 --radius 0.1", {"'--radius'", "TiO2,radius=100nm"}},
            {"albedo --base TiO2 radius=100nm", {"'radius=100nm'", "TiO2,radius=100nm"}},
            {"albedo --substrate black --coat TiO2 --thickness 4um", {"'--thickness'", "@40um"}},
            {"plot nk TiO2 --titel x", {"'--titel'", "did you mean --title?"}},
            {"albedo --base TiO2 --wavelengths 400 500", {"'500'", "1,2,3"}},
            {"export --format mrel --base hg:0.9,0.5 -o x", {"'mrel'", "did you mean merl"}},
        });
}

TEST_CASE("options without a use are refused", "[program][errors]") {
    check_refused(
        kUsage,
        {
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 -o ''", {"--output", "empty name"}},
            {"brdf --base hg:0.9,0.5 --mu-in 1 --mu-out 1 --component total,total",
             {"total", "twice"}},
            {"albedo --base hg:0.9,0.5 --surface-index 1.5", {"--surface-index", "--roughness"}},
            {"plot nk TiO2 --json", {"--json", "-o FILE"}},
            {"sphere --index 1.5,0 --size-parameter 1 --json --no-comments",
             {"--no-comments", "CSV"}},
        });
    // A surface that was switched off keeps its index.
    CHECK(support::run_program("albedo --base hg:0.9,0.5 --surface-index 1.5 --roughness 0")
              .exit_code == 0);
}

TEST_CASE("particles of the index of their host scatter nothing, and that is said",
          "[program][errors]") {
    for (const char* arguments : {"optics index:1,0", "phase index:1.33,0 --host-index 1.33",
                                  "albedo --base index:1.33,0 --host-index 1.33",
                                  "brdf --base TiO2 --coat index:1,0@1 --mu-in 1 --mu-out 1",
                                  "plan albedo --base index:1,0"}) {
        CAPTURE(arguments);
        check_one_line(support::run_program(std::string(arguments) + " --wavelengths 550"), kUsage,
                       {"contrast", "--host-index"});
    }
    // A millionth is contrast enough; n alone is not all of an index.
    CHECK(support::run_program("optics index:1.000001,0 --wavelengths 550").exit_code == 0);
    CHECK(support::run_program("optics index:1,0.01 --wavelengths 550").exit_code == 0);
}

TEST_CASE("materials, wavelengths and files that are not there are named", "[program][errors]") {
    const support::TemporaryFolder folder;
    const std::string wrong =
        folder.write("m.csv", "# single_scattering_albedo: 0.9\nl,chi\n0,0.5\n");
    const std::string grey = "brdf --base isotropic:0.9" + kDirections + "-o ";
    check_refused(
        kBadInput,
        {{"optics TiO3 --wavelengths 550", {"TiO3", "TiO2"}},
         {"optics TiO2 --wavelengths 5000", {"TiO2", "5000", "180", "1500", "materials import"}},
         {"brdf --base moments:" + wrong + kDirections, {"m.csv", "chi_0 = 0.5"}},
         {"brdf --base moments:/no/such.csv" + kDirections, {"/no/such.csv"}},
         {grey + "/no/such/dir/x.csv", {"/no/such/dir/x.csv", "no folder '/no/such/dir'"}},
         {grey + "/dev/full", {"/dev/full"}}});
}

TEST_CASE("no command replaces a file that it reads", "[program][errors]") {
    const support::TemporaryFolder folder;
    const std::string text =
        "base = \"isotropic:0.9\"\nwavelengths = 550\n[[result]]\ncommand = \"albedo\"\nmu-in = "
        "0.5\n";
    const std::string scene = folder.write("scene.toml", text);
    for (const char* command : {"plan ", "report "}) {
        CAPTURE(command);
        check_one_line(support::run_program(command + scene + " -o " + scene), kUsage,
                       {"scene.toml", "is read", "-o"});
    }
    const std::string own =
        folder.write("own.toml", text + "output = \"" + (folder / "own.toml") + "\"\n");
    const std::string before = support::read_file(own);
    check_one_line(support::run_program("run " + own), kUsage, {"own.toml", "is read"});
    CHECK(support::read_file(own) == before);
    CHECK(support::read_file(scene) == text);
    // An earlier result is no input.
    const std::string old = folder.write("old.csv", "");
    for (const std::string option : {"-o ", "--output=", "--output "}) {
        CAPTURE(option);
        CHECK(support::run_program("albedo --base isotropic:0.9 --wavelengths 550 --mu-in 0.5 " +
                                   option + old)
                  .exit_code == 0);
    }
}

TEST_CASE("an unknown command is one with --help, too", "[program][errors]") {
    check_refused(kUsage, {{"albeod --help", {"albeod", "albedo"}},
                           {"materials serch --help", {"serch", "search"}},
                           {"plan --substrate black --coat isotropic:.9@1", {"plan brdf, albedo"}},
                           {"plan report --coat isotropic:.9@1", {"--base or --substrate"}}});
    CHECK(support::run_program("materials --help").exit_code == 0);
    CHECK(support::run_program("--help").exit_code == 0);
}

TEST_CASE("what is within the tolerance is converged, whichever step took more than its share",
          "[program]") {
    // Mie theory alone has 1.14e-4 of 1.2e-4 here, more than its share.
    const auto ice = support::run_program(
        "albedo --base H2O_ice,radius=31.5 --wavelengths 1300 --mu-in .5 --tolerance 1.2e-4");
    CHECK(ice.exit_code == 0);
    CHECK_THAT(ice.out, !Catch::Contains("not converged"));
    // 11 digits are all that 1.003 has to the host; the series themselves are whole.
    const auto sphere = support::run_program("sphere --index 1.003 --size-parameter 1");
    CHECK(sphere.exit_code == 0);
    CHECK_THAT(sphere.out, Catch::Contains("# note: index within 3.0e-03 of the host's: about 11"));
    CHECK(sphere.err.empty());
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
    support::run_ok("materials import " + table + " --name Testite --database " + cut);
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

TEST_CASE("exit code 4 is explained on stderr", "[program][errors]") {
    // Three nodes cannot resolve such a peak.
    const auto run = support::run_program("brdf --base hg:0.9,0.9 --streams 3" + kDirections);
    CHECK(run.exit_code == 4);
    CHECK_THAT(run.err, Catch::Contains("not converged"));
    CHECK_THAT(run.out, Catch::Contains("# not converged"));
}
