#include "tools/miebrdf/processor_path.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>

#include <miebrdf/error.h>
#include <miebrdf/processor_path.h>
#include "pipeline/io/program_file.h"
#include "rte/math/compiled_for.h"

namespace miebrdf::program {
namespace {

namespace fs = std::filesystem;

/// Set while the program begins again, so that it does so once.
constexpr char kBegunAgain[] = "MIEBRDF_PROCESSOR_PATH_BEGUN_AGAIN";
constexpr char kPreload[] = "LD_PRELOAD";
/// The loader's name for the folder of such libraries, and the folders in it.
constexpr char kLoadersFolder[] = "glibc-hwcaps";
constexpr std::array kLoadersPaths = {"x86-64-v2", "x86-64-v3", "x86-64-v4"};
/// Libraries of the arithmetic, those first that others need
/// (tools/cmake/MiebrdfProcessorPaths.cmake).
constexpr std::array kArithmetic = {"libmiebrdf_math", "libmiebrdf_mie", "libmiebrdf_rte"};

bool processor_has([[maybe_unused]] std::string_view path) {
#if defined(__x86_64__)
    const bool v2 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt");
    const bool v3 = v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi2");
    const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl");
    if (path == "x86-64-v4") return v4;
    if (path == "x86-64-v3") return v3;
    if (path == "x86-64-v2") return v2;
#endif
    return true;
}

/// The file in which processor_path() was found: a shared library, or the program itself.
fs::path arithmetic_file() {
    Dl_info info{};
    // Its text lies where the function does; the function's own address may be that of a stub here.
    if (::dladdr(processor_path().data(), &info) == 0 || info.dli_fname == nullptr) return {};
    std::error_code unknown;
    return fs::absolute(info.dli_fname, unknown);
}

std::string names(const std::vector<ProcessorPath>& paths, bool that_run_here) {
    std::vector<std::string> chosen;
    for (const ProcessorPath& path : paths) {
        if (path.runs_here == that_run_here) chosen.push_back(path.name);
    }
    return fmt::format("{}", fmt::join(chosen, ", "));
}

/// LD_PRELOAD has to begin with this for the path. LD_LIBRARY_PATH would not do: of the libraries
/// for every processor the loader looks for better ones in the folders below.
std::string preloaded(const ProcessorPath& path) {
    const std::string file = arithmetic_file().filename();
    const std::string suffix = file.substr(std::min(file.size(), std::strlen(kArithmetic[0])));
    std::vector<std::string> files;
    files.reserve(std::size(kArithmetic));
    for (const char* library : kArithmetic)
        files.push_back((fs::path(path.folder) / library).string() + suffix);
    return fmt::format("{}", fmt::join(files, ":"));
}

[[noreturn]] void begin_again(const ProcessorPath& path, char** argv) {
    const char* before = std::getenv(kPreload);
    const std::string preload =
        preloaded(path) + (before != nullptr ? ":" + std::string(before) : "");
    ::setenv(kPreload, preload.c_str(), 1);
    ::setenv(kBegunAgain, before != nullptr ? before : "", 1);
    const fs::path program = program_file();
    if (program.empty()) {  // as a shell finds it
        ::execvp(argv[0], argv);
    } else {
        ::execv(program.c_str(), argv);
    }
    throw UsageError(
        fmt::format("{}: the program cannot begin again: {}", kPathVariable, std::strerror(errno)));
}

/// Leaves the environment of programs that this one starts as it was.
void restore_preload(const std::string& before) {
    if (before.empty()) {
        ::unsetenv(kPreload);
    } else {
        ::setenv(kPreload, before.c_str(), 1);
    }
    ::unsetenv(kBegunAgain);
}

}  // namespace

std::vector<ProcessorPath> processor_paths() {
    const fs::path file = arithmetic_file();
    const std::string name = file.filename();
    if (name.rfind(kArithmetic[0], 0) != 0)
        return {{std::string(processor_path()), true, file.parent_path()}};
    fs::path base = file.parent_path();
    if (base.parent_path().filename() == kLoadersFolder) base = base.parent_path().parent_path();
    // This file is compiled as the libraries for every processor are.
    std::vector<ProcessorPath> paths = {{kCompiledFor, true, base}};
    for (const char* path : kLoadersPaths) {
        const fs::path folder = base / kLoadersFolder / path;
        std::error_code unreadable;
        if (fs::exists(folder / name, unreadable))
            paths.push_back({path, processor_has(path), folder});
    }
    return paths;
}

std::string processor_path_line() {
    std::vector<ProcessorPath> others = processor_paths();
    others.erase(std::remove_if(others.begin(), others.end(),
                                [](const auto& path) { return path.name == processor_path(); }),
                 others.end());
    std::string line = fmt::format("processor path: {}", processor_path());
    if (others.empty()) return line + ", the only one in this build";
    const std::string possible = names(others, true), lacking = names(others, false);
    if (!possible.empty()) line += "; here also: " + possible;
    if (!lacking.empty()) line += "; not on this processor: " + lacking;
    return line;
}

void obey_processor_path(char** argv) {
    const char* value = std::getenv(kPathVariable);
    const std::string asked = value != nullptr ? value : "";
    const char* begun_again = std::getenv(kBegunAgain);
    const bool is_second = begun_again != nullptr;
    if (is_second) restore_preload(begun_again);
    if (asked.empty() || asked == processor_path()) return;

    const std::vector<ProcessorPath> paths = processor_paths();
    const auto found = std::find_if(paths.begin(), paths.end(),
                                    [&](const ProcessorPath& path) { return path.name == asked; });
    const std::string allowed = names(paths, true);
    if (found == paths.end())
        throw UsageError(fmt::format("{}: '{}' is not in this build; allowed: {}", kPathVariable,
                                     asked, allowed));
    if (!found->runs_here)
        throw UsageError(fmt::format("{}: this processor cannot run {}; allowed: {}", kPathVariable,
                                     asked, allowed));
    if (is_second)
        throw UsageError(
            fmt::format("{}: the loader does not take the libraries in '{}'; allowed "
                        "are folders without blanks and colons in their names",
                        kPathVariable, found->folder));
    begin_again(*found, argv);
}

}  // namespace miebrdf::program
