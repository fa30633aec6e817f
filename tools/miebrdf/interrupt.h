// Ctrl-C and SIGTERM as a flag that computations look at.
#pragma once

#include <atomic>

namespace miebrdf::program {

/// From now on the first SIGINT or SIGTERM raises the flag; a second one ends the program at once.
const std::atomic<bool>& watch_for_interrupts();

/// Exit code of a program ended by the signal that came: 128 + its number.
int interrupt_exit_code();

}  // namespace miebrdf::program
