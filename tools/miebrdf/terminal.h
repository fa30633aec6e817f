// Progress on standard error, and what Ctrl-C and SIGTERM do.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>

namespace miebrdf::program {

enum class ProgressStyle { none, line, words, json };

/// `auto` (a line on a terminal, else words now and then), `none`, `json`.
/// @throws UsageError
ProgressStyle parse_progress_style(const std::string& text);

/// A line that is printed at most ten times a second, and at the end of every stage; as JSON, what
/// happens within a job at most once a second; in words every ten seconds. A clock of its own goes
/// on where a job says nothing. Any thread may call.
class ProgressLine {
  public:
    explicit ProgressLine(ProgressStyle style);
    ~ProgressLine() { end(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// The work begins now: the clock of its first stage starts.
    void begin();
    void update(const std::string& stage, std::size_t done, std::size_t total);
    /// One of `total` jobs of a stage has begun.
    void job_begun(const std::string& stage, std::size_t total);
    /// A piece of a job is done: the line moves within a wavelength, too.
    void piece_done();
    /// Wipes the line, so that what follows starts on a clean one.
    void end();

  private:
    using Clock = std::chrono::steady_clock;
    void enter(const std::string& stage, std::size_t total);
    bool is_due() const;
    void print();
    void keep_talking(const std::stop_token& stop);

    ProgressStyle style_;
    std::mutex mutex_;
    std::string stage_;
    std::size_t done_ = 0, total_ = 0;
    std::size_t pieces_ = 0;  ///< done since the last job was
    /// A stage begins where the one before it ended: its first job counts too.
    Clock::time_point stage_start_ = Clock::now();
    Clock::time_point last_update_ = stage_start_;
    Clock::time_point last_print_ = stage_start_;
    bool line_shown_ = false;
    std::condition_variable_any at_end_;
    std::jthread clock_;  ///< the last member: it uses the others
};

/// From now on the first SIGINT or SIGTERM raises the flag. A program that has not ended by itself
/// half a second later (one job can take longer) removes its temporary files and ends; what the
/// cache has is on disk already. A second signal ends the program at once.
const std::atomic<bool>& watch_for_interrupts();

/// Exit code of a program ended by the signal that came: 128 + its number.
int interrupt_exit_code();

}  // namespace miebrdf::program
