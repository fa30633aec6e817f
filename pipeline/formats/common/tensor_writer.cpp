#include "pipeline/formats/common/tensor_writer.h"

#include <sstream>
#include <utility>

#include "pipeline/formats/common/byte_writer.h"

namespace miebrdf {
namespace {

constexpr std::uint8_t kUnsigned8 = 1, kUnsigned16 = 3, kFloat32 = 10;

std::uint64_t data_size(const TensorField& field) {
    return field.type == kFloat32 ? field.values.size() * sizeof(float) : field.bytes.size();
}

std::uint64_t header_size(const std::vector<TensorField>& fields) {
    std::uint64_t size = 12 + 2 + 4;  // magic, version, number of fields
    for (const TensorField& field : fields)
        size += 2 + field.name.size() + 2 + 1 + 8 + 8 * field.shape.size();
    return size;
}

std::uint64_t aligned(std::uint64_t offset) { return (offset + 7) / 8 * 8; }

}  // namespace

TensorField float_field(std::string name, std::vector<std::uint64_t> shape,
                        std::vector<float> values) {
    return {std::move(name), std::move(shape), kFloat32, std::move(values), {}};
}

TensorField short_field(std::string name, const std::vector<std::uint16_t>& values) {
    std::ostringstream bytes;
    ByteWriter writer(bytes);
    for (const std::uint16_t value : values) writer.put(value);
    return {std::move(name), {values.size()}, kUnsigned16, {}, std::move(bytes).str()};
}

TensorField byte_field(std::string name, std::string bytes) {
    const std::uint64_t size = bytes.size();
    return {std::move(name), {size}, kUnsigned8, {}, std::move(bytes)};
}

void write_tensor_file(const std::vector<TensorField>& fields, std::ostream& out) {
    ByteWriter bytes(out);
    bytes.put_text({"tensor_file\0", 12});
    bytes.put(std::uint8_t{1});
    bytes.put(std::uint8_t{0});
    bytes.put(static_cast<std::uint32_t>(fields.size()));
    std::uint64_t offset = header_size(fields);
    for (const TensorField& field : fields) {
        offset = aligned(offset);
        bytes.put(static_cast<std::uint16_t>(field.name.size()));
        bytes.put_text(field.name);
        bytes.put(static_cast<std::uint16_t>(field.shape.size()));
        bytes.put(field.type);
        bytes.put(offset);
        for (const std::uint64_t extent : field.shape) bytes.put(extent);
        offset += data_size(field);
    }
    offset = header_size(fields);
    for (const TensorField& field : fields) {
        bytes.put_zeros(aligned(offset) - offset);
        if (field.type == kFloat32) {
            bytes.put_all(field.values);
        } else {
            bytes.put_text(field.bytes);
        }
        offset = aligned(offset) + data_size(field);
    }
}

}  // namespace miebrdf
