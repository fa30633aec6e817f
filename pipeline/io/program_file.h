// The file of the program that runs. A header alone: programs and tests without the pipeline ask,
// too.
#pragma once

#include <sys/auxv.h>

#include <bit>
#include <filesystem>

namespace miebrdf {

/// The file of the program that this process runs, by /proc; where there is none, in a root of its
/// own say, as it was started. Empty: not known.
inline std::filesystem::path program_file() {
    namespace fs = std::filesystem;
    std::error_code unknown;
    fs::path file = fs::read_symlink("/proc/self/exe", unknown);
    if (!file.empty()) return file;
    const auto* started = std::bit_cast<const char*>(::getauxval(AT_EXECFN));
    return started == nullptr ? fs::path() : fs::canonical(started, unknown);
}

}  // namespace miebrdf
