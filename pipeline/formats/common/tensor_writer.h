// The "tensor_file" container: named arrays in one binary file. Several of Mitsuba's materials are
// such files.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace miebrdf {

/// An array, last dimension fastest.
struct TensorField {
    std::string name;
    std::vector<std::uint64_t> shape;
    std::uint8_t type = 10;          ///< the container's number: 1 u8, 3 u16, 10 float32
    std::vector<float> values = {};  ///< of type 10
    std::string bytes = {};          ///< of the others, little-endian
};

TensorField float_field(std::string name, std::vector<std::uint64_t> shape,
                        std::vector<float> values);
TensorField short_field(std::string name, const std::vector<std::uint16_t>& values);
TensorField byte_field(std::string name, std::string bytes);

/// Header, then the data of each field at a multiple of 8 bytes. Little-endian.
void write_tensor_file(const std::vector<TensorField>& fields, std::ostream& out);

}  // namespace miebrdf
