#include "pipeline/formats/common/tensor_reader.h"

#include <fmt/format.h>

#include <miebrdf/error.h>

namespace miebrdf {
namespace {

/// Bytes of one number of each type, from the container's description: none, u8, i8, u16, i16, u32,
/// i32, u64, i64, f16, f32, f64.
constexpr std::uint64_t kTypeSize[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8};
constexpr std::uint16_t kMostDimensions = 8;

Tensor read_field(ByteReader& header, std::string_view content, const std::string& name) {
    Tensor field;
    const auto dimensions = header.number<std::uint16_t>();
    field.type = header.number<std::uint8_t>();
    const auto offset = header.number<std::uint64_t>();
    if (dimensions > kMostDimensions || field.type == 0 || field.type >= std::size(kTypeSize)) {
        throw InputError(fmt::format("tensor_file: field '{}' has {} dimensions and type {}", name,
                                     dimensions, field.type));
    }
    std::uint64_t size = kTypeSize[field.type];
    for (std::uint16_t d = 0; d < dimensions; ++d) {
        const auto extent = header.number<std::uint64_t>();
        if (extent != 0 && size > content.size() / extent) {
            throw InputError(fmt::format("tensor_file: field '{}' is larger than the file", name));
        }
        size *= extent;
        field.shape.push_back(extent);
    }
    ByteReader data(content);
    data.seek(offset);
    field.bytes = data.take(size);
    return field;
}

}  // namespace

TensorFields read_tensor_file(std::string_view content) {
    ByteReader header(content);
    header.take(12);
    const auto major = header.number<std::uint8_t>();
    header.number<std::uint8_t>();
    if (major != 1) throw InputError(fmt::format("tensor_file: version {}; known: 1", major));
    const auto count = header.number<std::uint32_t>();
    TensorFields fields;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto length = header.number<std::uint16_t>();
        const std::string name(header.take(length));
        fields[name] = read_field(header, content, name);
    }
    return fields;
}

const Tensor& tensor(const TensorFields& fields, std::string_view name, std::size_t dimensions) {
    const auto found = fields.find(name);
    if (found == fields.end()) throw InputError(fmt::format("tensor_file: no field '{}'", name));
    if (found->second.shape.size() != dimensions) {
        throw InputError(fmt::format("tensor_file: field '{}' has {} dimensions; expected {}", name,
                                     found->second.shape.size(), dimensions));
    }
    return found->second;
}

RealView<float> tensor_floats(const TensorFields& fields, std::string_view name) {
    const auto found = fields.find(name);
    if (found == fields.end()) throw InputError(fmt::format("tensor_file: no field '{}'", name));
    if (found->second.type != kTensorFloat) {
        throw InputError(fmt::format("tensor_file: field '{}' is not of 32-bit floats", name));
    }
    return RealView<float>(found->second.bytes);
}

}  // namespace miebrdf
