// The list of commands: help, suggestions, scene files and tests read it.
#pragma once

#include <span>
#include <string_view>

#include "tools/miebrdf/command.h"

namespace miebrdf::program {

std::span<const Command> commands();

/// The one of this name; null if there is none.
const Command* find_command(std::string_view name);

// Commands of miebrdf-bench, the second program: the reference methods, tables of truth and cases
// that these two need, and nobody else.
inline constexpr char kBenchHelp[] = "error against run time of every method";
inline constexpr char kStressHelp[] = "stiff and extreme cases, each with a bound that has a cause";

}  // namespace miebrdf::program
