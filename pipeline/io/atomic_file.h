// A file that appears whole or not at all.
#pragma once

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>

namespace miebrdf {

/// Writes beside the target under a temporary name; commit() renames it into place. Without
/// commit() the destructor removes it, so an error never leaves half a file. A target that exists
/// and is no regular file (a pipe, /dev/null) is written directly.
class AtomicFile {
  public:
    /// @throws InputError  when the folder does not exist or cannot be written
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    std::ostream& stream() { return stream_; }
    /// The file to hand to writers that open it themselves; close nothing but what they opened.
    const std::filesystem::path& temporary_path() const { return temporary_; }

    /// Puts all that was written so far into the temporary file, to be read by others.
    /// @throws InputError  when anything could not be written (a full disk shows here)
    void flush();

    /// Flushes to disk and renames.
    /// @throws InputError  when anything could not be written (a full disk shows here)
    void commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path temporary_;
    std::ofstream stream_;
    bool renames_ = true;
    bool committed_ = false;
    char* listed_name_ = nullptr;
    std::atomic<char*>* slot_ = nullptr;  ///< in the list of unfinished files
};

/// Removes the temporary files of every AtomicFile that is neither committed nor destroyed. For a
/// program that has to end inside a signal handler, and only then: it calls unlink(2) alone.
void remove_unfinished_files() noexcept;

}  // namespace miebrdf
