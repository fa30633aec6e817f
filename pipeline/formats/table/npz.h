// NumPy's .npz: named .npy arrays (format version 1.0) in an uncompressed zip archive. Writer and
// reader share no code.
#pragma once

#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <vector>

struct zip;  // libzip's archive

namespace miebrdf {

/// Arrays are kept in memory until they are written. The zip container is libzip's: sizes beyond
/// 4 GB, checksums and time stamps are its business.
class NpzArchive {
  public:
    /// @param shape  row-major; empty: one dimension
    void add(const std::string& name, std::vector<double> values,
             std::vector<std::size_t> shape = {});
    /// A text as an array of unsigned bytes: bytes(archive["meta"]).decode() in Python.
    void add_bytes(const std::string& name, const std::string& bytes);

    /// Equal arrays give equal bytes: time stamps are those of 1980-01-01, zip's zero.
    /// @param out  empty, and able to seek: libzip goes back to fill in checksums
    /// @throws InputError  when it cannot be written
    void write(std::ostream& out) const;

  private:
    struct Member {
        std::string name;
        std::string header;          ///< of .npy, and bytes after it
        std::vector<double> values;  ///< of the .npy file
    };
    static void add_to(zip* archive, const Member& member);

    std::vector<Member> members_;
};

struct NpyArray {
    std::vector<std::size_t> shape;
    std::vector<double> values;  ///< of little-endian 32- or 64-bit floats, or bytes
    bool is_bytes = false;
};

/// Members without their ".npy", read without trusting the content. Only stored (not compressed)
/// members are read: then the arrays are no larger than the file. @throws InputError
std::map<std::string, NpyArray> read_npz_arrays(std::string_view content);

}  // namespace miebrdf
