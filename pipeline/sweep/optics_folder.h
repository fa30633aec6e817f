// Optics of species as files in a folder that processes on several machines have in common.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/solve/optics_memo.h"

namespace miebrdf::sweep {

/// A file is named by what its numbers depend on, appears whole by renaming, and is never changed:
/// whoever writes one writes the same, so any number of machines may do it at once, over NFS too.
/// Never in the way: what cannot be read is computed, what cannot be written is not shared.
/// Thread-safe.
class OpticsFolder final : public OpticsStore {
  public:
    /// Written by one process at most; then it only reads.
    static constexpr std::size_t kDefaultLimit_bytes = std::size_t{1} << 30;

    /// @param folder  made with the first file, in one that is there
    explicit OpticsFolder(std::filesystem::path folder,
                          std::size_t limit_bytes = kDefaultLimit_bytes)
        : folder_(std::move(folder)), free_bytes_(limit_bytes) {}

    /// Empty if there is no such file or it is damaged.
    /// @param hash  optics_hash
    std::optional<std::vector<double>> find(const std::string& hash) override;
    void store(const std::string& hash, const std::vector<double>& numbers) override;

  private:
    std::filesystem::path file_of(const std::string& hash) const;

    std::filesystem::path folder_;
    std::atomic<std::size_t> free_bytes_;
};

}  // namespace miebrdf::sweep
