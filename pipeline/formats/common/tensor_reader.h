// The named arrays of a "tensor_file", read without trusting it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/formats/common/byte_reader.h"

namespace miebrdf {

struct Tensor {
    std::vector<std::uint64_t> shape;
    std::uint8_t type = 0;   ///< 1: unsigned byte, 3: unsigned 16-bit, 10: 32-bit float, ...
    std::string_view bytes;  ///< into the file's content
};

inline constexpr std::uint8_t kTensorByte = 1, kTensorShort = 3, kTensorFloat = 10;

using TensorFields = std::map<std::string, Tensor, std::less<>>;  ///< by name

/// The fields of a "tensor_file" container. @throws InputError
TensorFields read_tensor_file(std::string_view content);

/// The values of a field of 32-bit floats, where they are in the content.
/// @throws InputError  when missing or of another type
RealView<float> tensor_floats(const TensorFields& fields, std::string_view name);

/// @throws InputError  when the field is missing or its shape has another number of dimensions
const Tensor& tensor(const TensorFields& fields, std::string_view name, std::size_t dimensions);

}  // namespace miebrdf
