#include "tools/miebrdf/interrupt.h"

#include <csignal>

namespace miebrdf::program {
namespace {

// A signal handler can reach only what lives as long as the program.
std::atomic<bool> interrupted = false;
std::atomic<int> signal_number = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void raise_flag(int signal) {
    signal_number = signal;
    interrupted = true;
    std::signal(signal, SIG_DFL);
}

}  // namespace

const std::atomic<bool>& watch_for_interrupts() {
    std::signal(SIGINT, raise_flag);
    std::signal(SIGTERM, raise_flag);
    return interrupted;
}

int interrupt_exit_code() { return 128 + signal_number; }

}  // namespace miebrdf::program
