#include "tools/miebrdf/interrupt.h"

#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <string_view>

#include "pipeline/io/atomic_file.h"

namespace miebrdf::program {
namespace {

// A signal handler can reach only what lives as long as the program.
std::atomic<bool> interrupted = false;
std::atomic<int> signal_number = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

constexpr itimerval kPatience = {.it_interval = {0, 0}, .it_value = {0, 500'000}};

// Both handlers call only what POSIX allows in one.

void end_now(int) {
    remove_unfinished_files();
    constexpr std::string_view kMessage =
        "miebrdf: error: interrupted; nothing unfinished was written\n";
    // There is nobody left to tell that standard error is closed.
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kMessage.data(), kMessage.size());
    ::_exit(interrupt_exit_code());
}

void raise_flag(int signal) {
    signal_number = signal;
    interrupted = true;
    std::signal(signal, SIG_DFL);
    std::signal(SIGALRM, end_now);
    ::setitimer(ITIMER_REAL, &kPatience, nullptr);
}

}  // namespace

const std::atomic<bool>& watch_for_interrupts() {
    std::signal(SIGINT, raise_flag);
    std::signal(SIGTERM, raise_flag);
    return interrupted;
}

int interrupt_exit_code() { return 128 + signal_number; }

}  // namespace miebrdf::program
