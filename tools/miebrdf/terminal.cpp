#include "tools/miebrdf/terminal.h"

#include <fmt/format.h>
#include <sys/time.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <cstdio>
#include <string_view>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"

namespace miebrdf::program {
namespace {

constexpr std::chrono::milliseconds kInterval{100};

}  // namespace

ProgressStyle parse_progress_style(const std::string& text) {
    if (text == "auto")
        return ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::line : ProgressStyle::none;
    if (text == "none") return ProgressStyle::none;
    if (text == "json") return ProgressStyle::json;
    throw UsageError(fmt::format("unknown progress style '{}'; allowed: auto, none, json", text));
}

void ProgressLine::begin() {
    stage_.clear();
    stage_start_ = last_update_ = Clock::now();
}

void ProgressLine::end() {
    if (line_shown_) std::fputs("\r\033[K", stderr);
    line_shown_ = false;
}

void ProgressLine::update(const std::string& stage, std::size_t done, std::size_t total) {
    if (style_ == ProgressStyle::none) return;
    const auto now = Clock::now();
    if (stage != stage_) {
        stage_ = stage;
        stage_start_ = last_update_;
        last_print_ = {};
    }
    last_update_ = now;
    if (done < total && now - last_print_ < kInterval) return;
    last_print_ = now;
    print(done, total, std::chrono::duration<double>(now - stage_start_).count());
}

void ProgressLine::print(std::size_t done, std::size_t total, double elapsed_s) {
    const double rate = elapsed_s > 0.0 ? static_cast<double>(done) / elapsed_s : 0.0;
    const double left_s = rate > 0.0 ? static_cast<double>(total - done) / rate : 0.0;
    if (style_ == ProgressStyle::json) {
        const nlohmann::ordered_json event = {{"stage", stage_},
                                              {"done", done},
                                              {"total", total},
                                              {"per_second", rate},
                                              {"seconds_left", left_s}};
        fmt::print(stderr, "{}\n", event.dump());
        return;
    }
    fmt::print(stderr, "\r\033[K{}: {}/{}, {:.3g}/s, {:.0f} s left", stage_, done, total, rate,
               left_s);
    std::fflush(stderr);
    line_shown_ = true;
}

namespace {

// Signal handlers can only use global variables.
std::atomic<bool> interrupted = false;
std::atomic<int> signal_number = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

constexpr itimerval kTimeToEnd = {.it_interval = {0, 0}, .it_value = {0, 500'000}};

// Both handlers call only functions that POSIX allows in a signal handler.

void end_now(int) {
    remove_unfinished_files();
    constexpr std::string_view kMessage =
        "miebrdf: error: interrupted; nothing unfinished was written\n";
    // The program ends here, whether or not the message could be written.
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kMessage.data(), kMessage.size());
    ::_exit(interrupt_exit_code());
}

void raise_flag(int signal) {
    signal_number = signal;
    interrupted = true;
    std::signal(signal, SIG_DFL);
    std::signal(SIGALRM, end_now);
    ::setitimer(ITIMER_REAL, &kTimeToEnd, nullptr);
}

}  // namespace

const std::atomic<bool>& watch_for_interrupts() {
    std::signal(SIGINT, raise_flag);
    std::signal(SIGTERM, raise_flag);
    return interrupted;
}

int interrupt_exit_code() { return 128 + signal_number; }

}  // namespace miebrdf::program
