// Ctrl-C and SIGTERM: a flag that computations look at, and an end for those that do not in time.
#pragma once

#include <atomic>

namespace miebrdf::program {

/// From now on the first SIGINT or SIGTERM raises the flag. A program that has not ended by itself
/// half a second later (one job can take longer) removes its temporary files and ends; what the
/// cache has is on disk already. A second signal ends the program at once.
const std::atomic<bool>& watch_for_interrupts();

/// Exit code of a program ended by the signal that came: 128 + its number.
int interrupt_exit_code();

}  // namespace miebrdf::program
