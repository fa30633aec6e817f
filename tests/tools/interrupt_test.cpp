// Ctrl-C and SIGTERM in the middle of long jobs, and several programs on one cache.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>
#include <utility>

#include "pipeline/result_cache.h"
#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using Clock = std::chrono::steady_clock;

namespace {

/// A program that runs beside the test, without a shell between them.
class Background {
  public:
    Background(std::vector<std::string> arguments, const std::filesystem::path& cache,
               const std::string& err) {
        arguments.insert(arguments.begin(), MIEBRDF_PROGRAM);
        pid_ = ::fork();
        if (pid_ != 0) return;
        ::setenv("XDG_CACHE_HOME", cache.c_str(), 1);
        const int file = ::open(err.c_str(), O_WRONLY | O_CREAT, 0600);
        ::dup2(file, STDERR_FILENO);
        ::dup2(file, STDOUT_FILENO);
        std::vector<char*> words;
        for (std::string& word : arguments) words.push_back(word.data());
        words.push_back(nullptr);
        ::execv(MIEBRDF_PROGRAM, words.data());
        ::_exit(127);
    }
    ~Background() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            wait();
        }
    }
    Background(Background&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}

    void send(int signal) const { ::kill(pid_, signal); }
    bool running() const {
        siginfo_t info{};
        return ::waitid(P_PID, id_t(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
               info.si_pid == 0;
    }
    int wait() {
        int status = 0;
        ::waitpid(std::exchange(pid_, -1), &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

  private:
    pid_t pid_;
};

constexpr auto kPoll = std::chrono::milliseconds(5);
const char* const kCacheFile = "miebrdf/results.sqlite";

}  // namespace

TEST_CASE("Ctrl-C between the Mie jobs of a scene file ends it cleanly", "[program][interrupt]") {
    // Pieces of jobs under way were once left out, and what they had not written was read.
    const int signal = GENERATE(SIGINT, SIGTERM);
    const support::TemporaryFolder folder, cache;
    const std::string scene = folder.write(
        "scene.toml",
        "mu-in = 1\nmu-out = 1\nwavelengths = \"400:700:2\"\nbase = \"TiO2\"\n"
        "[[result]]\ncommand = \"brdf\"\noutput = \"" + (folder / "first.csv") + "\"\n"
        "[[result]]\ncommand = \"brdf\"\nbase = \"GaP\"\noutput = \"" + (folder / "second.csv") + "\"\n");
    Background program({"run", scene}, cache.path(), cache / "err");
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    REQUIRE(program.running());
    program.send(signal);
    CHECK(program.wait() == 128 + signal);
    CHECK_THAT(support::read_file(cache / "err"), Catch::Contains("interrupted"));
    CHECK(folder.count() == 1);  // the scene file
}

TEST_CASE("Ctrl-C and SIGTERM stop a long job within a second, leave no file and keep the cache",
          "[program][interrupt]") {
    const int signal = GENERATE(SIGINT, SIGTERM);
    const support::TemporaryFolder folder, cache;
    // One job of 256 nodes and some hundred orders: many seconds without a look at the flag.
    Background program({"brdf", "--base=hg:0.999,0.98", "--coat=hg:0.99,0.95@1", "--streams=256",
                        "--tolerance=1e-6", "--mu-in=0.01:1:0.01", "--mu-out=0.01:1:0.01",
                        "--wavelengths=550", "-o", folder / "out.csv"},
                       cache.path(), cache / "err");
    std::this_thread::sleep_for(std::chrono::seconds(1));
    REQUIRE(program.running());
    program.send(signal);
    const auto sent = Clock::now();
    const int exit_code = program.wait();
    const double seconds = std::chrono::duration<double>(Clock::now() - sent).count();
    CHECK(exit_code == 128 + signal);
    // Half a second of patience, and what a busy machine needs to schedule the end.
    CHECK(seconds <= 1.0);
    CHECK(folder.count() == 0);
    const std::string said = support::read_file(cache / "err");
    CHECK_THAT(said, Catch::Contains("interrupted; nothing unfinished was written"));
}

TEST_CASE("a run that is interrupted keeps the wavelengths it has finished",
          "[program][interrupt]") {
    const support::TemporaryFolder folder, cache;
    Background program({"albedo", "--base=index:1.5,0.01", "--effective-radius=3", "--streams=128",
                        "--wavelengths=400:700:0.1", "--threads=1", "-o", folder / "out.csv"},
                       cache.path(), cache / "err");
    const auto entries = [&] {
        return ResultCache(cache / kCacheFile).info().entries;
    };
    while (program.running() && entries() < 3) std::this_thread::sleep_for(kPoll);
    REQUIRE(program.running());
    program.send(SIGINT);
    CHECK(program.wait() == 128 + SIGINT);
    CHECK(folder.count() == 0);
    CHECK(entries() >= 3);
    CHECK(entries() < 3001);
}

TEST_CASE("programs that share a new cache neither fail nor disagree", "[program][cache]") {
    const support::TemporaryFolder folder, cache;
    std::vector<Background> programs;
    for (int p = 0; p < 6; ++p) {
        const std::string name = std::to_string(p);
        programs.push_back(Background({"albedo", "--base=index:1.5,0.01", "--effective-radius=1",
                                       "--wavelengths=400:700:10", "--threads=1", "--quiet", "-o",
                                       folder / name},
                                      cache.path(), folder / ("err" + name)));
    }
    for (Background& program : programs) CHECK(program.wait() == 0);
    const auto rows = [&](int p) {
        const std::string text = support::read_file(folder / std::to_string(p));
        return text.substr(text.find("wavelength_nm,mu_in"));
    };
    for (int p = 0; p < 6; ++p) {
        CHECK(rows(p) == rows(0));
        CHECK(support::read_file(folder / ("err" + std::to_string(p))).empty());
    }
    // For each wavelength the single scattering of the medium and the layers.
    CHECK(ResultCache(cache / kCacheFile).info().entries == 62);
}
