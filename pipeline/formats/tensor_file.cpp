#include "pipeline/formats/tensor_file.h"

#include "pipeline/formats/binary_writer.h"

namespace miebrdf::exports {
namespace {

constexpr std::uint8_t kUnsigned8 = 1, kFloat32 = 10;  // the container's type numbers

std::uint64_t data_size(const TensorField& field) {
    return field.values.empty() ? field.bytes.size() : field.values.size() * sizeof(float);
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
    return {std::move(name), std::move(shape), std::move(values), {}};
}

TensorField byte_field(std::string name, std::string bytes) {
    return {std::move(name), {bytes.size()}, {}, std::move(bytes)};
}

void write_tensor_file(const std::vector<TensorField>& fields, std::ostream& out) {
    BinaryWriter binary(out);
    binary.put_text({"tensor_file\0", 12});
    binary.put(std::uint8_t{1});
    binary.put(std::uint8_t{0});
    binary.put(static_cast<std::uint32_t>(fields.size()));
    std::uint64_t offset = header_size(fields);
    for (const TensorField& field : fields) {
        offset = aligned(offset);
        binary.put(static_cast<std::uint16_t>(field.name.size()));
        binary.put_text(field.name);
        binary.put(static_cast<std::uint16_t>(field.shape.size()));
        binary.put(field.values.empty() ? kUnsigned8 : kFloat32);
        binary.put(offset);
        for (const std::uint64_t extent : field.shape) binary.put(extent);
        offset += data_size(field);
    }
    offset = header_size(fields);
    for (const TensorField& field : fields) {
        binary.put_zeros(aligned(offset) - offset);
        if (field.values.empty()) {
            binary.put_text(field.bytes);
        } else {
            binary.put_all(field.values);
        }
        offset = aligned(offset) + data_size(field);
    }
}

}  // namespace miebrdf::exports
