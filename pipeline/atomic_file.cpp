#include "pipeline/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "pipeline/error.h"

namespace miebrdf {
namespace {

namespace fs = std::filesystem;

// The library's one piece of global state: a signal handler can reach nothing else. It only ever
// holds names of files that exist while an AtomicFile does.
constexpr std::size_t kSlots = 64;
std::array<std::atomic<const char*>, kSlots> unfinished;

/// kSlots when all are taken: then only an abrupt end would leave a temporary file.
std::size_t enlist(const char* name) {
    std::size_t slot = 0;
    for (; slot < kSlots; ++slot) {
        const char* none = nullptr;
        if (unfinished[slot].compare_exchange_strong(none, name)) break;
    }
    return slot;
}

void strike_off(std::size_t slot) {
    if (slot < kSlots) unfinished[slot] = nullptr;
}

[[noreturn]] void refuse(const fs::path& target, int error) {
    throw InputError(fmt::format("cannot write '{}': {}", target.string(), std::strerror(error)));
}

/// What a file newly made by open(2) would get; mkstemp alone leaves it readable by its owner only.
mode_t default_file_mode() {
    const mode_t mask = ::umask(0);
    ::umask(mask);
    return 0666 & ~mask;
}

void flush_to_disk(const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)), slot_(kSlots) {
    std::error_code ignored;
    if (fs::is_symlink(target_, ignored)) {
        const fs::path resolved = fs::weakly_canonical(target_, ignored);
        if (!resolved.empty()) target_ = resolved;
    }
    const fs::file_status status = fs::status(target_, ignored);
    if (fs::is_directory(status)) refuse(target_, EISDIR);
    renames_ = !fs::exists(status) || fs::is_regular_file(status);
    if (!renames_) {
        temporary_ = target_;
        stream_.open(target_, std::ios::binary);
        if (!stream_) refuse(target_, errno);
        return;
    }
    std::string pattern = target_.string() + ".XXXXXX";
    const int descriptor = ::mkstemp(pattern.data());
    if (descriptor < 0) refuse(target_, errno);
    ::fchmod(descriptor, default_file_mode());
    ::close(descriptor);
    temporary_ = pattern;
    slot_ = enlist(temporary_.c_str());
    stream_.open(temporary_, std::ios::binary | std::ios::trunc);
    if (stream_) return;
    const int error = errno;
    strike_off(slot_);
    ::unlink(temporary_.c_str());
    refuse(target_, error);
}

AtomicFile::~AtomicFile() {
    stream_.close();
    std::error_code ignored;
    if (renames_ && !committed_) fs::remove(temporary_, ignored);
    strike_off(slot_);
}

void AtomicFile::commit() {
    errno = 0;
    stream_.flush();
    const bool good = stream_.good();
    stream_.close();
    if (!good || stream_.fail()) refuse(target_, errno != 0 ? errno : EIO);
    if (renames_) {
        flush_to_disk(temporary_);
        if (::rename(temporary_.c_str(), target_.c_str()) != 0) refuse(target_, errno);
    }
    committed_ = true;
    strike_off(slot_);
}

void remove_unfinished_files() noexcept {
    for (const auto& name : unfinished) {
        if (const char* path = name) ::unlink(path);
    }
}

}  // namespace miebrdf
