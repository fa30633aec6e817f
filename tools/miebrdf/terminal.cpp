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
constexpr std::chrono::milliseconds kWordsInterval{10'000};

}  // namespace

ProgressStyle parse_progress_style(const std::string& text) {
    if (text == "auto")
        return ::isatty(STDERR_FILENO) != 0 ? ProgressStyle::line : ProgressStyle::words;
    if (text == "none") return ProgressStyle::none;
    if (text == "json") return ProgressStyle::json;
    throw UsageError(fmt::format("unknown progress style '{}'; allowed: auto, none, json", text));
}

ProgressLine::ProgressLine(ProgressStyle style)
    : style_(style), clock_([this](const std::stop_token& stop) { keep_talking(stop); }) {}

void ProgressLine::keep_talking(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        at_end_.wait_for(lock, stop, kEventInterval, [] { return false; });
        if (!stop.stop_requested() && !stage_.empty() && is_due()) print();
    }
}

void ProgressLine::begin() {
    const std::lock_guard lock(mutex_);
    stage_.clear();
    stage_start_ = last_update_ = last_print_ = Clock::now();
}

void ProgressLine::end() {
    const std::lock_guard lock(mutex_);
    if (line_shown_) std::fputs("\r\033[K", stderr);
    line_shown_ = false;
    stage_.clear();
}

void ProgressLine::enter(const std::string& stage, std::size_t total) {
    if (stage == stage_) return;
    stage_ = stage;
    done_ = pieces_ = 0;
    total_ = total;
    stage_start_ = last_update_;
    if (style_ == ProgressStyle::json) last_print_ = Clock::now();
    if (style_ == ProgressStyle::line) last_print_ = Clock::time_point();
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
    const bool is_turn = style_ != ProgressStyle::words &&
                         (is_first || done >= total || last_update_ - last_print_ >= kInterval);
    if (is_turn || is_due()) print();
}

void ProgressLine::job_begun(const std::string& stage, std::size_t total) {
    if (style_ == ProgressStyle::none) return;
    const std::lock_guard lock(mutex_);
    enter(stage, total);
    if (is_due()) print();
}

void ProgressLine::piece_done() {
    if (style_ == ProgressStyle::none) return;
    const std::lock_guard lock(mutex_);
    ++pieces_;
    if (is_due()) print();
}

bool ProgressLine::is_due() const {
    const auto interval = style_ == ProgressStyle::json    ? kEventInterval
                          : style_ == ProgressStyle::words ? kWordsInterval
                                                           : kInterval;
    return Clock::now() - last_print_ >= interval;
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
    if (style_ == ProgressStyle::words) {
        fmt::print(stderr, "miebrdf: {}\n", line);
        return;
    }
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
