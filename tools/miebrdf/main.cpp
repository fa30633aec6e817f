// The program miebrdf: its list of commands, and those that another program does.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include <miebrdf/error.h>
#include "pipeline/io/program_file.h"
#include "tools/miebrdf/commands.h"
#include "tools/miebrdf/program.h"

namespace miebrdf::program {
namespace {

namespace fs = std::filesystem;

constexpr char kBenchProgram[] = "miebrdf-bench";

/// Its path beside this program or where both were installed; else the bare name, which execvp
/// looks for along PATH.
std::string bench_program() {
    const fs::path here = program_file().parent_path();
    if (!here.empty()) {
        for (const fs::path& file :
             {here / kBenchProgram, here / MIEBRDF_LIBEXEC_FROM_BIN / kBenchProgram}) {
            if (::access(file.c_str(), X_OK) == 0) return file.string();
        }
    }
    return kBenchProgram;
}

/// Becomes miebrdf-bench. @throws UsageError  when it is not there
[[noreturn]] void run_bench_program(std::vector<std::string> words) {
    const std::string command = words.front();
    words.insert(words.begin(), kBenchProgram);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const std::string program = bench_program();
    ::execvp(program.c_str(), arguments.data());
    if (errno != ENOENT) throw UsageError(fmt::format("{}: {}", program, std::strerror(errno)));
    throw UsageError(fmt::format(
        "'miebrdf {}' needs the program {}, which is not beside this one, in {}, or in "
        "PATH; build it with `cmake --build BUILD-FOLDER --target {}` or install all of "
        "miebrdf with `cmake --install BUILD-FOLDER`",
        command, kBenchProgram, MIEBRDF_LIBEXEC_FROM_BIN, kBenchProgram));
}

}  // namespace

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

/// Makes a command that hands all its words to the command of the same name of miebrdf-bench. That
/// program is looked for beside this one, then where it is installed, then along PATH.
void forward_to_bench_program(CLI::App& command, Shell& shell) {
    command.set_help_flag();  // --help goes on to the other program, like every other word
    command.prefix_command();
    command.callback([&command, &shell] {
        std::vector<std::string> words = command.remaining();
        words.insert(words.begin(), command.get_name());
        shell.set_job([words]() -> int { run_bench_program(words); });
    });
}

#ifndef MIEBRDF_HAS_RENDER
/// In a build without its packages: says which they are.
void add_render(CLI::App& command, Shell& shell) {
    static constexpr char kReason[] =
        "this build cannot render; install libembree-dev, libtinyobjloader-dev, libopenexr-dev and "
        "libpng-dev, then configure and build again";
    command.allow_extras();  // its options are not known here, and not to blame
    command.footer(kReason);
    shell.on_run(command, []() -> int { throw UsageError(kReason); });
}
#endif

}  // namespace miebrdf::program

int main(int argc, char** argv) {
    return miebrdf::program::run_main(miebrdf::program::commands(), argc, argv);
}
