#include "tools/miebrdf/bench_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <miebrdf/error.h>

namespace miebrdf::program {
namespace {

namespace fs = std::filesystem;

constexpr char kName[] = "miebrdf-bench";

/// Where it lies beside this program or where both were installed; else the bare name, which execvp
/// looks for along PATH.
std::string bench_program() {
    std::error_code unknown;  // without /proc only PATH is left
    const fs::path here = fs::read_symlink("/proc/self/exe", unknown).parent_path();
    if (!unknown) {
        for (const fs::path& file : {here / kName, here / MIEBRDF_LIBEXEC_FROM_BIN / kName}) {
            if (::access(file.c_str(), X_OK) == 0) return file.string();
        }
    }
    return kName;
}

/// Becomes miebrdf-bench. @throws UsageError  when it is not there
[[noreturn]] void run_bench_program(std::vector<std::string> words) {
    const std::string command = words.front();
    words.insert(words.begin(), kName);
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
        command, kName, MIEBRDF_LIBEXEC_FROM_BIN, kName));
}

}  // namespace

void forward_to_bench_program(CLI::App& command, Shell& shell) {
    command.set_help_flag();  // --help goes on to the other program, like every other word
    command.prefix_command();
    command.callback([&command, &shell] {
        std::vector<std::string> words = command.remaining();
        words.insert(words.begin(), command.get_name());
        shell.set_job([words]() -> int { run_bench_program(words); });
    });
}

}  // namespace miebrdf::program
