// The list of commands: help, suggestions, scene files and the tests of the documentation read it.
#pragma once

#include <span>

#include "tools/miebrdf/command.h"

namespace miebrdf::program {

std::span<const Command> commands();

/// The one of this name; null if there is none.
const Command* find_command(std::string_view name);

}  // namespace miebrdf::program
