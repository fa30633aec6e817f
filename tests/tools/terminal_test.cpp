// Progress for programs, people and files; Ctrl-C and SIGTERM.
#include <fcntl.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <map>
#include <sstream>
#include <thread>
#include <utility>

#include "pipeline/cache/result_cache.h"
#include "tests/support/catch.h"
#include "tests/support/program.h"
#include "tests/support/program_csv.h"
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
    const auto run = support::run_ok(kWork + " --progress json");
    std::map<std::string, nlohmann::json> last;
    std::istringstream lines(run.err);
    for (std::string line; std::getline(lines, line);) {
        CAPTURE(line);
        const auto event = nlohmann::json::parse(line);
        const std::string stage = event.at("stage");
        CHECK(event.at("done") <= event.at("total"));
        CHECK(event.at("per_second") >= 0.0);
        // Before the first job is done nobody knows how long the others take.
        if (event.at("done") > 0) CHECK(event.at("seconds_left") >= 0.0);
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

namespace {

constexpr auto kPoll = std::chrono::milliseconds(5);
const char* const kCacheFile = "miebrdf/results.sqlite";

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
        words.reserve(arguments.size() + 1);
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

    /// Waits until it has had that much processor time, which a busy machine gives it late.
    void let_work(double cpu_s) const {
        while (running() && this->cpu_s() < cpu_s) std::this_thread::sleep_for(kPoll);
    }
    void send(int signal) const { ::kill(pid_, signal); }
    /// Sends a signal while the program stands still, and returns the processor time until then.
    double send_at(int signal) const {
        send(SIGSTOP);
        siginfo_t info{};
        ::waitid(P_PID, id_t(pid_), &info, WSTOPPED | WEXITED | WNOWAIT);
        const double before = cpu_s();
        send(signal);
        send(SIGCONT);
        return before;
    }
    bool running() const {
        siginfo_t info{};
        return ::waitid(P_PID, id_t(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
               info.si_pid == 0;
    }
    int wait() {
        int status = 0;
        ::wait4(std::exchange(pid_, -1), &status, 0, &used_);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    /// Processor time of all its threads, once it has ended.
    double whole_cpu_s() const {
        const auto s = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
        return s(used_.ru_utime) + s(used_.ru_stime);
    }

  private:
    double cpu_s() const {
        clockid_t clock{};
        timespec time{};
        if (::clock_getcpuclockid(pid_, &clock) != 0 || ::clock_gettime(clock, &time) != 0)
            return 0;
        return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
    }

    pid_t pid_;
    rusage used_{};
};

}  // namespace

TEST_CASE("Ctrl-C between the Mie jobs of a scene file ends it cleanly", "[program][interrupt]") {
    // Pieces of jobs under way were once left out, and what they had not written was read.
    const int signal = GENERATE(SIGINT, SIGTERM);
    const support::TemporaryFolder folder, cache;
    const std::string scene =
        folder.write("scene.toml",
                     "mu-in = 1\nmu-out = 1\nwavelengths = \"400:700:2\"\nbase = \"TiO2\"\n"
                     "[[result]]\ncommand = \"brdf\"\noutput = \"" +
                         (folder / "first.csv") +
                         "\"\n"
                         "[[result]]\ncommand = \"brdf\"\nbase = \"GaP\"\noutput = \"" +
                         (folder / "second.csv") + "\"\n");
    Background program({"run", scene}, cache.path(), cache / "err");
    program.let_work(0.5);
    REQUIRE(program.running());
    program.send(signal);
    CHECK(program.wait() == 128 + signal);
    CHECK_THAT(support::read_file(cache / "err"), Catch::Contains("interrupted"));
    CHECK(folder.count() == 1);  // the scene file
}

TEST_CASE("Ctrl-C and SIGTERM stop a long job within a second, and leave no file",
          "[program][interrupt]") {
    const int signal = GENERATE(SIGINT, SIGTERM);
    const support::TemporaryFolder folder, cache;
    // One job of 256 nodes and some hundred orders: many seconds without a look at the flag.
    Background program({"brdf", "--base=hg:0.999,0.98", "--coat=hg:0.99,0.95@1", "--streams=256",
                        "--tolerance=1e-6", "--mu-in=0.01:1:0.01", "--mu-out=0.01:1:0.01",
                        "--wavelengths=550", "--threads=1", "-o", folder / "out.csv"},
                       cache.path(), cache / "err");
    program.let_work(0.5);
    REQUIRE(program.running());
    const double before = program.send_at(signal);
    CHECK(program.wait() == 128 + signal);
    // Half a second of patience, by the clock on the wall: at most as much of one processor,
    // however late a busy machine schedules it. The rest is the way out.
    CHECK(program.whole_cpu_s() - before <= 1.0);
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
    const auto entries = [&] { return ResultCache(cache / kCacheFile).info().entries; };
    while (program.running() && entries() < 3) std::this_thread::sleep_for(kPoll);
    REQUIRE(program.running());
    program.send(SIGINT);
    CHECK(program.wait() == 128 + SIGINT);
    CHECK(folder.count() == 0);
    CHECK(entries() >= 3);
    CHECK(entries() < 3001);
}

TEST_CASE("a fit that is interrupted prints the best so far", "[program][interrupt]") {
    const support::TemporaryFolder folder, cache;
    // Two numbers of the averages of large spheres at 80 wavelengths: several seconds.
    std::string rows = "wavelength_nm,albedo\n";
    for (int i = 0; i < 80; ++i) rows += std::to_string(500 + 10 * i) + ",0.6\n";
    folder.write("flat.csv", rows);
    const std::string file =
        folder.write("fit.toml",
                     "[scene]\nbase = \"index:1.5,{k},radius={r},distribution=mono\"\n"
                     "[unknowns]\nk = \"1e-5 in 1e-7:1e-2 log\"\nr = \"30 in 5:80 log\"\n"
                     "[[measured]]\nfile = \"flat.csv\"\nquantity = \"spherical_albedo\"\n"
                     "sigma = 1e-4\n");
    Background program({"fit", file, "--threads=1", "--no-cache"}, cache.path(), cache / "said");
    program.let_work(1.0);
    REQUIRE(program.running());
    program.send(SIGINT);
    CHECK(program.wait() == 4);  // not converged
    const std::string said = support::read_file(cache / "said");
    CHECK_THAT(said, Catch::Contains("interrupted: the best so far"));
    CHECK_THAT(said, Catch::Contains("\nk,,") && Catch::Contains("\nr,,"));
}

TEST_CASE("programs that share a new cache neither fail nor disagree", "[program][cache]") {
    const support::TemporaryFolder folder, cache, cache_of_one;
    const auto start = [&](const std::string& name, const support::TemporaryFolder& its_cache) {
        return Background(
            {"albedo", "--base=index:1.5,0.01", "--effective-radius=1", "--wavelengths=400:700:10",
             "--threads=1", "--quiet", "-o", folder / name},
            its_cache.path(), folder / ("err" + name));
    };
    std::vector<Background> programs;
    for (int p = 0; p < 6; ++p) programs.push_back(start(std::to_string(p), cache));
    for (Background& program : programs) CHECK(program.wait() == 0);
    CHECK(start("alone", cache_of_one).wait() == 0);
    const auto rows = [&](int p) {
        const std::string text = support::read_file(folder / std::to_string(p));
        return text.substr(text.find("wavelength_nm,mu_in"));
    };
    for (int p = 0; p < 6; ++p) {
        CHECK(rows(p) == rows(0));
        CHECK(support::read_file(folder / ("err" + std::to_string(p))).empty());
    }
    // At least the single scattering of the medium and the layers for each wavelength.
    const auto entries = ResultCache(cache_of_one / kCacheFile).info().entries;
    CHECK(entries >= 62);
    CHECK(ResultCache(cache / kCacheFile).info().entries == entries);
}
