#include "pipeline/io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include <miebrdf/error.h>

namespace miebrdf {
namespace {

namespace fs = std::filesystem;

// The library's global state (with the count below): a signal handler can reach nothing else. It
// only ever holds names of files that exist while an AtomicFile does. A name belongs to whoever
// takes it out of its slot: the AtomicFile frees it, a signal handler, which may not, leaves it.
constexpr std::size_t kSlots = 64;
std::array<std::atomic<char*>, kSlots> unfinished;
static_assert(std::atomic<char*>::is_always_lock_free, "used in signal handlers");

/// Nowhere when all slots are taken: then only an abrupt end would leave a temporary file.
std::atomic<char*>* enlist(char* name) {
    for (auto& slot : unfinished) {
        char* none = nullptr;
        if (slot.compare_exchange_strong(none, name)) return &slot;
    }
    return nullptr;
}

/// A name that a signal handler may take, and then keeps until the process ends.
char* name_for_signal_handlers(const std::string& name) { return ::strdup(name.c_str()); }

/// Frees the name unless a signal handler has taken it; the slot may be another file's by then.
void strike_off(std::atomic<char*>* slot, char* name) {
    if (slot == nullptr || slot->compare_exchange_strong(name, nullptr)) std::free(name);
}

[[noreturn]] void refuse(const fs::path& target, int error) {
    throw InputError(fmt::format("cannot write '{}': {}", target.string(), std::strerror(error)));
}

/// A new, empty file beside the target, with the permissions that any new file gets: mkstemp would
/// need the process's umask for that, which no thread can read without changing it for all.
std::string make_temporary(const fs::path& target) {
    static std::atomic<unsigned> count = 0;
    constexpr int kAttempts = 1000;  // leftovers of another process with this number
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        std::string name = fmt::format("{}.{}-{}", target.string(), ::getpid(), count++);
        const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) {
            ::close(descriptor);
            return name;
        }
        if (errno != EEXIST) break;
    }
    refuse(target, errno);
}

/// Why a stream could not be written: a stream keeps no reason, but the disk is still full.
int reason_of_failure(const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
    if (descriptor < 0) return errno;
    const std::array<char, 65536> block{};
    const bool written = ::write(descriptor, block.data(), block.size()) == ssize_t(block.size());
    const int error = written ? EIO : errno != 0 ? errno : ENOSPC;
    ::close(descriptor);
    return error;
}

void flush_to_disk(const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
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
    temporary_ = make_temporary(target_);
    listed_name_ = name_for_signal_handlers(temporary_.string());
    if (listed_name_ != nullptr) slot_ = enlist(listed_name_);
    stream_.open(temporary_, std::ios::binary | std::ios::trunc);
    if (stream_) return;
    const int error = errno;
    ::unlink(temporary_.c_str());
    strike_off(slot_, listed_name_);
    refuse(target_, error);
}

AtomicFile::~AtomicFile() {
    stream_.close();
    std::error_code ignored;
    if (renames_ && !committed_) fs::remove(temporary_, ignored);
    strike_off(slot_, listed_name_);
}

void AtomicFile::flush() {
    errno = 0;
    stream_.flush();
    if (!stream_.good()) refuse(target_, errno != 0 ? errno : reason_of_failure(temporary_));
}

void AtomicFile::commit() {
    errno = 0;
    stream_.flush();
    const bool good = stream_.good();
    stream_.close();
    if (!good || stream_.fail())
        refuse(target_, errno != 0 ? errno : reason_of_failure(temporary_));
    if (renames_) {
        flush_to_disk(temporary_);
        if (::rename(temporary_.c_str(), target_.c_str()) != 0) refuse(target_, errno);
    }
    committed_ = true;
    strike_off(std::exchange(slot_, nullptr), std::exchange(listed_name_, nullptr));
}

void remove_unfinished_files() noexcept {
    for (auto& slot : unfinished) {
        if (const char* path = slot.exchange(nullptr)) ::unlink(path);
    }
}

}  // namespace miebrdf
