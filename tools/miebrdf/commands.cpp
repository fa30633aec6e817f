#include "tools/miebrdf/commands.h"

#include <algorithm>

#include "tools/miebrdf/bench_program.h"

namespace miebrdf::program {

#define COMMAND(add, name, help, in_scene_files) void add(CLI::App& command, Shell& shell);
#include "tools/miebrdf/commands.inc"
#undef COMMAND

std::span<const Command> commands() {
#define COMMAND(add, name, help, in_scene_files) {name, help, add, in_scene_files},
    static constexpr Command kCommands[] = {
#include "tools/miebrdf/commands.inc"
    };
#undef COMMAND
    return kCommands;
}

const Command* find_command(std::string_view name) {
    const auto all = commands();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Command& c) { return c.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace miebrdf::program
