// Arrays out of NumPy's .npz, read without trusting it.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::exports {

struct NpyArray {
    std::vector<std::size_t> shape;
    std::vector<double> values;  ///< of little-endian 32- or 64-bit floats, or bytes
    bool is_bytes = false;
};

/// Members without their ".npy". Only stored (not compressed) members are read: then the arrays are
/// no larger than the file. @throws InputError
std::map<std::string, NpyArray> read_npz_arrays(std::string_view content);

}  // namespace miebrdf::exports
