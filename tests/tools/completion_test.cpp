// Completion scripts and the man page say what --help says.
#include <sstream>

#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

/// Standard output of a shell command; empty when it fails.
std::string output_of(const std::string& command) {
    const support::TemporaryFolder folder;
    const std::string file = folder / "out";
    if (std::system((command + " >'" + file + "' 2>/dev/null").c_str()) != 0) return {};
    return support::read_file(file);
}

bool is_there(const std::string& program) { return !output_of("command -v " + program).empty(); }

/// "--base", "--coat", ... as a help text lists them.
std::vector<std::string> options_in(const std::string& help) {
    std::vector<std::string> options;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
        const auto at = line.find("--");
        // Names begin within the first columns; further right is what they do.
        if (at == std::string::npos || at > 6) continue;
        options.push_back(line.substr(at, line.find_first_of(" ,", at) - at));
    }
    return options;
}

std::string script_for(const std::string& shell) {
    const auto run = support::run_ok("completion " + shell);
    return run.out;
}

/// The words that bash would offer after these.
std::string offered_by_bash(const std::string& words) {
    const support::TemporaryFolder folder;
    const std::string file = folder.write("script", script_for("bash"));
    return output_of("bash -c '. " + file + "; COMP_WORDS=(miebrdf " + words +
                     "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _miebrdf; "
                     "printf \"%s \" \"${COMPREPLY[@]}\"'");
}

}  // namespace

TEST_CASE("scripts and the man page have every command and option of --help",
          "[program][completion]") {
    const std::string bash = script_for("bash"), zsh = script_for("zsh"), fish = script_for("fish");
    const std::string page = support::run_program("manual").out;
    for (const std::string& command : support::commands_in(support::run_program("--help").out)) {
        CAPTURE(command);
        CHECK_THAT(bash, Catch::Contains("'" + command + "') words="));
        CHECK_THAT(zsh, Catch::Contains("'" + command + ":"));
        CHECK_THAT(fish, Catch::Contains(" -a " + command + " "));
        CHECK_THAT(page, Catch::Contains(".SS miebrdf " + command + "\n"));
    }
    const auto options = options_in(support::run_program("brdf --help").out);
    REQUIRE(options.size() > 30);
    for (const std::string& option : options) {
        CAPTURE(option);
        CHECK_THAT(bash, Catch::Contains(option));
        CHECK_THAT(zsh, Catch::Contains("'*" + option + "["));
        CHECK_THAT(fish, Catch::Contains(" -l " + option.substr(2) + " "));
    }
    CHECK_THAT(page, Catch::Contains("\\fB\\-\\-effective\\-radius\\fR \\fIUM\\fR"));
}

TEST_CASE("bash offers what fits", "[program][completion]") {
    if (!is_there("bash")) {
        WARN("skipped: bash is not installed");
        return;
    }
    CHECK(offered_by_bash("br") == "brdf ");
    CHECK(offered_by_bash("brdf --mu-") == "--mu-in --mu-out ");
    CHECK(offered_by_bash("materials sea") == "search ");
    CHECK(offered_by_bash("brdf --base TiO2 --quant") == "--quantity ");
}

TEST_CASE("the shells take their scripts", "[program][completion]") {
    for (const std::string shell : {"bash", "zsh", "fish"}) {
        if (!is_there(shell)) continue;
        CAPTURE(shell);
        const support::TemporaryFolder folder;
        const std::string file = folder.write("script", script_for(shell));
        CHECK(output_of(shell + " -n " + file + " && echo good") == "good\n");
    }
    if (is_there("fish")) {
        const support::TemporaryFolder folder;
        const std::string file = folder.write("script", script_for("fish"));
        CHECK_THAT(output_of("fish -c 'source " + file + "; complete -C \"miebrdf brdf --mu-o\"'"),
                   Catch::StartsWith("--mu-out"));
    }
    if (is_there("groff")) {
        const support::TemporaryFolder folder;
        const std::string file = folder.write("page", support::run_program("manual").out);
        CHECK(output_of("groff -man -ww -Tutf8 " + file + " 2>&1 >/dev/null; echo end") == "end\n");
    }
}

TEST_CASE("an unknown shell is refused with those that are known", "[program][completion]") {
    const auto run = support::run_program("completion csh");
    CHECK(run.exit_code == 2);
    CHECK_THAT(run.err, Catch::Contains("csh") && Catch::Contains("bash, zsh, fish"));
}
