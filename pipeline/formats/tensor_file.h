// The "tensor_file" container of RGL (EPFL): named arrays in one binary file.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace miebrdf::exports {

/// An array of 32-bit floats, last dimension fastest, or a text.
struct TensorField {
    std::string name;
    std::vector<std::uint64_t> shape;
    std::vector<float> values;
    std::string bytes;  ///< instead of values: unsigned 8-bit
};

TensorField float_field(std::string name, std::vector<std::uint64_t> shape,
                        std::vector<float> values);
TensorField byte_field(std::string name, std::string bytes);

/// Header, then the data of each field at a multiple of 8 bytes. Little-endian.
void write_tensor_file(const std::vector<TensorField>& fields, std::ostream& out);

}  // namespace miebrdf::exports
