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
constexpr std::chrono::milliseconds kEventInterval{1000};

}  // namespace

ProgressStyle parse_progress_style(const std::string& text) {
    if (text == "auto")
        return ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::line : ProgressStyle::none;
    if (text == "none") return ProgressStyle::none;
    if (text == "json") return ProgressStyle::json;
    throw UsageError(fmt::format("unknown progress style '{}'; allowed: auto, none, json", text));
}

void ProgressLine::begin() {
    const std::lock_guard lock(mutex_);
    stage_.clear();
    stage_start_ = last_update_ = Clock::now();
}

void ProgressLine::end() {
    const std::lock_guard lock(mutex_);
    if (line_shown_) std::fputs("\r\033[K", stderr);
    line_shown_ = false;
}

void ProgressLine::enter(const std::string& stage, std::size_t total) {
    if (stage == stage_) return;
    stage_ = stage;
    done_ = pieces_ = 0;
    total_ = total;
    stage_start_ = last_update_;
    last_print_ = style_ == ProgressStyle::json ? Clock::now() : Clock::time_point();
}

void ProgressLine::update(const std::string& stage, std::size_t done, std::size_t total) {
    if (style_ == ProgressStyle::none) return;
    const std::lock_guard lock(mutex_);
    const bool is_first = stage != stage_;
    enter(stage, total);
    done_ = done;
    total_ = total;
    pieces_ = 0;
    last_update_ = Clock::now();
    if (!is_first && done < total && last_update_ - last_print_ < kInterval) return;
    print();
}

void ProgressLine::job_begun(const std::string& stage, std::size_t total) {
    if (style_ == ProgressStyle::none) return;
    const std::lock_guard lock(mutex_);
    enter(stage, total);
    print_if_due();
}

void ProgressLine::piece_done() {
    if (style_ == ProgressStyle::none) return;
    const std::lock_guard lock(mutex_);
    ++pieces_;
    print_if_due();
}

void ProgressLine::print_if_due() {
    const auto interval = style_ == ProgressStyle::json ? kEventInterval : kInterval;
    if (Clock::now() - last_print_ >= interval) print();
}

void ProgressLine::print() {
    last_print_ = Clock::now();
    const double elapsed_s = std::chrono::duration<double>(last_print_ - stage_start_).count();
    const double rate = elapsed_s > 0.0 ? static_cast<double>(done_) / elapsed_s : 0.0;
    const double left_s = rate > 0.0 ? static_cast<double>(total_ - done_) / rate : 0.0;
    if (style_ == ProgressStyle::json) {
        nlohmann::ordered_json event = {
            {"stage", stage_}, {"done", done_}, {"total", total_}, {"per_second", rate}};
        event["seconds_left"] = done_ > 0 ? nlohmann::ordered_json(left_s) : nullptr;
        if (pieces_ > 0) event["pieces"] = pieces_;
        fmt::print(stderr, "{}\n", event.dump());
        return;
    }
    std::string line = fmt::format("{}: {}/{}", stage_, done_, total_);
    if (pieces_ > 0) line += fmt::format(" and {} pieces of the next", pieces_);
    line += done_ > 0 ? fmt::format(", {:.3g}/s, {:.0f} s left", rate, left_s)
                      : fmt::format(", {:.0f} s so far", elapsed_s);
    fmt::print(stderr, "\r\033[K{}", line);
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
