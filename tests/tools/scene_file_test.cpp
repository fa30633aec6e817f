// Scene files as their users meet them: what is refused, and that it is refused before any work.
#include <filesystem>

#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;
using support::check_one_line;
using support::kBadInput;
using support::kUsage;

TEST_CASE("a scene file's mistakes are named with line and column", "[program][errors]") {
    const support::TemporaryFolder folder;
    struct Case {
        const char* text;
        int exit_code;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {"base = \"TiO2\"\nroughnes = 0.3\n[[result]]\ncommand = \"albedo\"\n",
         kUsage,
         {"line 2, column 1", "roughnes", "did you mean roughness?"}},
        {"[scene.a]\n  bsae = \"TiO2\"\n[[result]]\ncommand = \"albedo\"\n",
         kUsage,
         {"line 2, column 3", "bsae", "did you mean base?"}},
        {"[[results]]\ncommand = \"albedo\"\n",
         kUsage,
         {"line 1", "results", "did you mean result?"}},
        {"[[result]]\ncommand = \"albedo\"\nmu-out = 1\n",
         kUsage,
         {"line 3, column 1", "mu-out", "albedo"}},
        {"[[result]]\ncommand = \"paint\"\n", kUsage, {"line 2, column 11", "paint", "brdf"}},
        {"[[result]]\ncommand = \"albdo\"\n", kUsage, {"line 2", "did you mean albedo?"}},
        {"[scene.paint]\n[[result]]\ncommand = \"brdf\"\nscene = \"piant\"\n",
         kUsage,
         {"line 4", "no such scene", "did you mean paint?"}},
        {"command = \"brdf\"\n[[result]]\n", kBadInput, {"line 1", "[[result]]"}},
        {"wavelengths = 550\n", kBadInput, {"asks for nothing", "[[result]]"}},
        {"base = \n", kBadInput, {"line 1"}},
        // `--mu-in=` would take the next option for its value.
        {"mu-in = []\noutput = \"x.csv\"\n[[result]]\ncommand = \"albedo\"\nbase = "
         "\"hg:0.9,0.5\"\n",
         kBadInput,
         {"line 1, column 9", "'mu-in' is an empty list"}},
        {"[[result]]\ncommand = \"albedo\"\nbase = \"hg:0.9,0.5\"\nwavelengths = \"\"\n",
         kBadInput,
         {"line 4, column 15", "'wavelengths' is empty"}},
        {"[[result]]\ncommand = \"optics\"\nmedium = []\n",
         kBadInput,
         {"line 3, column 10", "'medium' is an empty list"}},
        {"[[result]]\ncommand = \"albedo\"\nbase = \"hg:0.9,0.5\"\ncoat = [\"\"]\n",
         kBadInput,
         {"line 4, column 9", "'coat' is empty"}},
    };
    for (const Case& c : cases) {
        const std::string file = folder.write("scene.toml", c.text);
        for (const char* command : {"run ", "plan "}) {
            CAPTURE(c.text, command);
            check_one_line(support::run_program(command + file), c.exit_code, c.words);
        }
    }
}

TEST_CASE("values that no scene can have are refused with their place in the file",
          "[program][errors][scene]") {
    const support::TemporaryFolder folder;
    const std::string head = "[[result]]\ncommand = \"albedo\"\nbase = \"hg:0.9,0.5\"\n";
    struct Case {
        const char* line;
        int exit_code;
        std::vector<std::string> words;
    };
    const std::vector<Case> cases = {
        {"roughness = -1", kUsage, {"line 4, column 13", "roughness", "-1", "0 (no lobe) to 2"}},
        {"roughness = [0.1, 0.2]", kUsage, {"line 4", "roughness", "one value"}},
        {"roughness = inf", kUsage, {"line 4", "roughness", "inf", "finite"}},
        {"streams = 2.5", kUsage, {"line 4, column 11", "streams", "2.5"}},
        {"grid = \"square\"", kUsage, {"line 4, column 8", "square", "gauss"}},
        {"coat = [\"hg:0.9,0.5\"]", kUsage, {"line 4, column 8", "MEDIUM@DEPTH"}},
        {"coat = \"moments:/no/such.csv@1\"", kBadInput, {"line 4", "/no/such.csv"}},
        {"wavelengths = [550, -1]", kUsage, {"line 4, column 15", "-1", "> 0"}},
        {"wavelengths = \"400:500\"", kUsage, {"line 4", "400:500"}},
        {"surface-index = [1.5, -1]", kUsage, {"line 4", "surface-index", "k >= 0"}},
        {"no-delta-m = 1", kBadInput, {"line 4, column 14", "true or false"}},
        {"base = { name = \"TiO2\" }", kBadInput, {"line 4"}},
        {"effective-radius = 0\ncoat = \"TiO2@1\"", kUsage, {"--effective-radius (um)", "> 0"}},
        {"surface-index = 1.5", kUsage, {"--surface-index", "--roughness"}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.line);
        const bool again = std::string(c.line).rfind("base", 0) == 0;
        const std::string text = again ? "[[result]]\ncommand = \"albedo\"\n\n" : head;
        const std::string file = folder.write("scene.toml", text + c.line + "\n");
        check_one_line(support::run_program("run " + file), c.exit_code, c.words);
    }
}

TEST_CASE("an output says which result of which file it is, with all that was said",
          "[program][scene]") {
    const support::TemporaryFolder folder;
    const std::string file = folder.write(
        "scene.toml",
        "base = \"hg:0.9,0.5\"\nwavelengths = [450, 550]\n[[result]]\ncommand = \"albedo\"\n"
        "[[result]]\ncommand = \"brdf\"\nmu-in = 0.5\nmu-out = [0.25, 1]\nno-delta-m = true\n"
        "coat = [\"hg:0.5,0@0.1\", \"isotropic:0.5@1\"]\n");
    const auto run = support::run_program("run " + file);
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    CHECK_THAT(run.out,
               Catch::Contains("# command: miebrdf run " + file +
                               ", result 1: albedo base=hg:0.9,0.5 wavelengths=450,550\n"));
    CHECK_THAT(run.out, Catch::Contains(", result 2: brdf base=hg:0.9,0.5 coat=hg:0.5,0@0.1 "
                                        "coat=isotropic:0.5@1 mu-in=0.5 mu-out=0.25,1 no-delta-m "
                                        "wavelengths=450,550\n"));
}

TEST_CASE("run finds a mistake in a later result before it computes the first",
          "[program][errors][scene]") {
    const support::TemporaryFolder folder;
    const std::string first =
        "mu-in = 1\n[[result]]\ncommand = \"albedo\"\nbase = \"hg:0.9,0.5\"\noutput = \"" +
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
        {"base = \"hg:0.9,0.5\"\noutput = \"/no/such/dir/x.csv\"\n",
         kBadInput,
         {"result 2 (albedo)", "/no/such/dir"}},
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

TEST_CASE("two results that name one file are refused before the first is computed",
          "[program][errors][scene]") {
    const support::TemporaryFolder folder;
    const std::string head =
        "base = \"hg:0.9,0.5\"\n[[result]]\ncommand = \"albedo\"\noutput = \"" +
        (folder / "a.csv") + "\"\n[[result]]\ncommand = \"optics\"\n" +
        "medium = \"hg:0.9,0.5\"\noutput = \"";
    // This is the file by another way.
    const std::string other = folder.path().string() + "/./a.csv";
    const std::string file = folder.write("scene.toml", head + other + "\"\n");
    check_one_line(support::run_program("run " + file), kUsage,
                   {"1 (albedo)", "2 (optics)", other});
    CHECK_FALSE(std::filesystem::exists(folder / "a.csv"));
    const std::string devices =
        folder.write("devices.toml",
                     "base = \"hg:0.9,0.5\"\noutput = \"/dev/null\"\n[[result]]\ncommand = "
                     "\"albedo\"\n[[result]]\ncommand = \"albedo\"\n");
    CHECK(support::run_program("run " + devices).exit_code == 0);
}

TEST_CASE("a scene file exports in any format, and mistakes come first", "[program][scene]") {
    const support::TemporaryFolder folder;
    const std::string scene =
        // The shared part may hold options that only some formats take.
        "base = \"hg:0.9,0.4\"\nwavelengths = \"rgb\"\nmu-out = [0.2, 1]\n[[result]]\ncommand = "
        "\"export\"\nformat = "
        "\"pbrt\"\noutput = \"" +
        (folder / "a.bsdf") +
        "\"\n[[result]]\ncommand = \"export\"\nformat = \"csv\"\nmu-in = [0.5, 1]\n";
    const std::string output = "output = \"" + (folder / "a.csv") + "\"\n";
    const std::string good = folder.write("good.toml", scene + output);
    const auto run = support::run_program("run " + good + " --json");  // one object each
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    for (const char* file : {"a.bsdf", "a.csv"}) {
        CAPTURE(file);
        CHECK(support::run_program("check " + (folder / file)).exit_code == 0);
        std::filesystem::remove(folder / file);
    }
    const std::string nowhere = folder.write("nowhere.toml", scene);
    check_one_line(support::run_program("run " + nowhere), kUsage, {"result 2 (export)", "output"});
    const std::string useless = folder.write("useless.toml", scene + output + "max-error = 0.1\n");
    check_one_line(support::run_program("run " + useless), kUsage,
                   {"result 2 (export)", "--max-error", "--mu-in"});
    CHECK_FALSE(std::filesystem::exists(folder / "a.bsdf"));
}

TEST_CASE("an empty list of coats in a result takes back those that are shared",
          "[program][scene]") {
    const support::TemporaryFolder folder;
    const auto rows = [&](const std::string& shared, const std::string& own) {
        const std::string file = folder.write(
            "scene.toml",
            shared + "base = \"hg:0.9,0.5\"\n[[result]]\ncommand = \"albedo\"\n" + own);
        const auto run = support::run_ok("run " + file);
        CAPTURE(file);
        return run.out.substr(run.out.find("wavelength_nm,mu_in"));
    };
    const std::string coat = "coat = \"hg:0.5,0.5@1\"\n";
    CHECK(rows(coat, "coat = []\n") == rows("", ""));
    CHECK(rows(coat, "") != rows("", ""));
}
