// Finished chunks of a sweep as files in a folder beside its table: what a run that was ended, by
// whatever, has left for the next one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace miebrdf::sweep {

struct Layout;
struct SceneResult;
struct Sweep;

/// Consecutive scenes that are computed and stored together.
struct Chunk {
    std::size_t number = 0;  ///< from 0
    std::size_t first = 0, count = 0;
};

/// The division of a sweep; the same for every process that works on it.
class Chunks {
  public:
    /// Whole groups of scenes that share Mie theory where these are small, pieces of them where
    /// they are large; or as many scenes as the sweep says.
    Chunks(const Sweep& sweep, const Layout& layout);

    std::size_t size() const { return (scenes_ + scenes_per_chunk_ - 1) / scenes_per_chunk_; }
    Chunk operator[](std::size_t number) const;

  private:
    std::size_t scenes_, scenes_per_chunk_;
};

/// Names everything that the values of a sweep depend on but for n and k: axes, scene, outputs,
/// the versions of solver and program. Titles and comments are not in it.
std::string identity_of(const Sweep& sweep);

/// The folder. Several processes may use one, on one machine or on many: files appear whole, by
/// renaming, and are never changed.
class Parts {
  public:
    /// TABLE.parts
    static std::filesystem::path folder_of(const std::filesystem::path& table);

    /// Makes the folder. @throws InputError  when it cannot be made
    Parts(const Sweep& sweep, const Layout& layout, std::filesystem::path folder);

    const Chunks& chunks() const { return chunks_; }
    const std::filesystem::path& folder() const { return folder_; }

    /// The results of a chunk; empty if it is not there, damaged, or of another sweep, another
    /// version, or other n and k. Such files are left where they are, to be replaced.
    std::optional<std::vector<SceneResult>> read(const Chunk& chunk) const;

    /// Whether this process is the first of a launch (crew.h) to ask for the chunk.
    /// @throws InputError  when nothing can be written
    bool take(const Chunk& chunk, const std::string& launch) const;

    /// When its file was written; empty if there is none.
    std::optional<std::filesystem::file_time_type> time_of(const Chunk& chunk) const;

    /// @throws InputError  when it cannot be written; what is there stays
    void write(const Chunk& chunk, const std::vector<SceneResult>& results) const;

    /// The folder where processes that work on the sweep together share single scattering.
    std::filesystem::path optics_folder() const { return folder_ / "optics"; }

    /// The place where a table is written before it appears beside the folder; remove() takes what
    /// a killed process leaves of it.
    std::filesystem::path unfinished_table(const std::filesystem::path& table) const;

    /// Removes the files of this folder that parts have names of and shared single scattering, then
    /// the folder if it is empty.
    void remove() const;

  private:
    std::filesystem::path file_of(const Chunk& chunk) const;
    /// First line of a file: what the chunk's values depend on, n and k included.
    std::string header_of(const Chunk& chunk) const;

    const Sweep& sweep_;
    const Layout& layout_;
    Chunks chunks_;
    std::filesystem::path folder_;
    std::string identity_;
};

}  // namespace miebrdf::sweep
