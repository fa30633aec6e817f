// What --progress shows: events for programs, a line for people, nothing for files.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/temporary_folder.h"
#include "tests/tools/one_line.h"

using namespace miebrdf;

namespace {

/// Everything that the program writes to a terminal of its own.
std::string on_terminal(std::vector<std::string> arguments) {
    const support::TemporaryFolder cache;
    arguments.insert(arguments.begin(), MIEBRDF_PROGRAM);
    std::vector<char*> words;
    words.reserve(arguments.size() + 1);
    for (std::string& word : arguments) words.push_back(word.data());
    words.push_back(nullptr);
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        ::setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
        ::execv(MIEBRDF_PROGRAM, words.data());
        ::_exit(127);
    }
    REQUIRE(child > 0);
    std::string text;
    char piece[4096];
    // A terminal whose last program is gone gives an error in place of the end.
    for (ssize_t n; (n = ::read(terminal, piece, sizeof piece)) > 0;)
        text.append(piece, std::size_t(n));
    ::close(terminal);
    int status = 0;
    ::waitpid(child, &status, 0);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    return text;
}

const std::string kWork =
    "albedo --base hg:0.9,0.5 --coat index:1.5,0.01@0.1 --effective-radius 0.5 "
    "--wavelengths 500,550,600";

}  // namespace

TEST_CASE("progress as json is one event a line, and each stage comes to its end",
          "[program][progress]") {
    const auto run = support::run_program(kWork + " --progress json");
    REQUIRE(run.exit_code == 0);
    std::map<std::string, nlohmann::json> last;
    std::istringstream lines(run.err);
    for (std::string line; std::getline(lines, line);) {
        CAPTURE(line);
        const auto event = nlohmann::json::parse(line);
        const std::string stage = event.at("stage");
        CHECK(event.at("done") <= event.at("total"));
        CHECK(event.at("per_second") >= 0.0);
        CHECK(event.at("seconds_left") >= 0.0);
        last[stage] = event;
    }
    REQUIRE(last.count("single scattering") == 1);
    REQUIRE(last.count("radiative transfer") == 1);
    for (const auto& [stage, event] : last) {
        CAPTURE(stage);
        CHECK(event.at("done") == event.at("total"));
        CHECK(event.at("seconds_left") == 0.0);
    }
    CHECK(last["radiative transfer"].at("total") == 3);
    CHECK(run.out.find("single scattering\"") == std::string::npos);
}

TEST_CASE("progress is silent where nobody watches, and refuses unknown words",
          "[program][progress]") {
    for (const char* style : {"", " --progress auto", " --progress none"}) {
        const auto run = support::run_program(kWork + style);
        CHECK(run.exit_code == 0);
        CHECK(run.err.empty());
    }
    support::check_one_line(support::run_program(kWork + " --progress lots"), support::kUsage,
                            {"lots", "auto, none, json"});
}

TEST_CASE("on a terminal a line of progress is written over and taken away at the end",
          "[program][progress]") {
    const support::TemporaryFolder folder;
    std::vector<std::string> words = {"-o", folder / "out.csv"};
    std::istringstream work(kWork);
    for (std::string word; work >> word;) words.insert(words.end() - 2, word);
    const std::string shown = on_terminal(words);
    CAPTURE(shown);
    const std::string clear = "\r\033[K";
    CHECK_THAT(shown, Catch::StartsWith(clear + "single scattering: "));
    CHECK_THAT(shown, Catch::Contains(clear + "radiative transfer: 3/3, "));
    CHECK_THAT(shown, Catch::EndsWith("0 s left" + clear));
    CHECK(shown.find('\n') == std::string::npos);
    CHECK(std::filesystem::exists(folder / "out.csv"));

    words.insert(words.end(), {"--progress", "none"});
    CHECK(on_terminal(words).empty());
}
