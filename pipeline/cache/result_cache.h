// Results remembered between runs, in an SQLite file of the user's cache folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace miebrdf {

/// The checksum covers a stored result and its key: a result that stands under another's key is
/// as damaged as one whose numbers have changed.
std::string checksum_of(const std::string& hash, std::string_view bytes);

/// Never in the way: an entry that is damaged is forgotten, a file that is damaged is begun anew,
/// one that is locked, full or cannot be written only means that nothing is remembered. May be used
/// from several threads and processes.
class ResultCache {
  public:
    static constexpr std::int64_t kDefaultLimit_bytes = std::int64_t{256} << 20;

    /// $XDG_CACHE_HOME/miebrdf/results.sqlite, else ~/.cache/miebrdf/results.sqlite.
    static std::filesystem::path default_file();

    /// Opens or creates the file; when that fails the cache is there but remembers nothing.
    explicit ResultCache(const std::filesystem::path& file,
                         std::int64_t limit_bytes = kDefaultLimit_bytes);
    ~ResultCache();

    /// Numbers stored for a job, if they are there and undamaged.
    std::optional<std::vector<double>> find(const std::string& hash);
    void store(const std::string& hash, std::span<const double> numbers);

    struct Info {
        std::filesystem::path file;
        bool usable = false;
        std::int64_t entries = 0;
        std::int64_t bytes = 0;
        std::int64_t limit_bytes = 0;
    };
    Info info() const;
    /// Removes the file and begins a new one. @returns the number of entries forgotten
    std::int64_t clear();

  private:
    struct Database;
    void open();
    /// Forgets a file that is no longer a whole database.
    void start_again();
    void forget_oldest();

    std::filesystem::path file_;
    std::int64_t limit_bytes_;
    mutable std::mutex mutex_;
    std::unique_ptr<Database> database_;  ///< empty when not usable
};

}  // namespace miebrdf
