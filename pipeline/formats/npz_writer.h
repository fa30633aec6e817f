// NumPy's .npz: named .npy arrays (format version 1.0) in an uncompressed zip archive.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

struct zip;  // libzip's archive

namespace miebrdf::exports {

/// Arrays are kept in memory until they are written. The zip container is libzip's: sizes beyond
/// 4 GB, checksums and time stamps are its business.
class NpzArchive {
  public:
    /// @param shape  row-major; empty: one dimension
    void add(const std::string& name, std::vector<double> values,
             std::vector<std::size_t> shape = {});
    /// A text as an array of unsigned bytes: bytes(archive["meta"]).decode() in Python.
    void add_bytes(const std::string& name, const std::string& bytes);

    /// The same arrays give the same bytes: time stamps are those of 1980-01-01, zip's zero.
    /// @throws InputError  when the file cannot be written; then there is no file
    void write(const std::filesystem::path& path) const;

  private:
    struct Member {
        std::string name;
        std::string header;          ///< of .npy, and bytes after it
        std::vector<double> values;  ///< of the .npy file
    };
    static void add_to(zip* archive, const Member& member);

    std::vector<Member> members_;
};

}  // namespace miebrdf::exports
