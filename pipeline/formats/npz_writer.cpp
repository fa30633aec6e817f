#include "pipeline/formats/npz_writer.h"

#include <fmt/format.h>

#include <bit>
#include <sstream>
#include <stdexcept>

#include <miebrdf/error.h>
#include "pipeline/formats/zip_stream.h"
#include "pipeline/io/atomic_file.h"

namespace miebrdf::exports {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays are declared little-endian");

/// Magic, version 1.0, header length, a Python dict padded with blanks so that the data begins at a
/// multiple of 64 bytes (numpy.lib.format, version 1.0).
std::string npy_header(const char* type, const std::vector<std::size_t>& shape) {
    const std::string dict =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type,
                    fmt::join(shape, ", "));
    constexpr std::size_t kPreamble = 10;
    const std::size_t padded = (kPreamble + dict.size() + 1 + 63) / 64 * 64;
    const std::size_t length = padded - kPreamble;
    std::string header = {'\x93',
                          'N',
                          'U',
                          'M',
                          'P',
                          'Y',
                          '\x01',
                          '\x00',
                          static_cast<char>(length & 0xff),
                          static_cast<char>(length >> 8)};
    header += dict;
    header.append(padded - 1 - header.size(), ' ');
    header += '\n';
    return header;
}

zip_uint8_t* bytes_of(const void* data) {
    return static_cast<zip_uint8_t*>(const_cast<void*>(data));
}

}  // namespace

void NpzArchive::add(const std::string& name, std::vector<double> values,
                     std::vector<std::size_t> shape) {
    if (shape.empty()) shape = {values.size()};
    std::string header = npy_header("<f8", shape);
    members_.push_back({name + ".npy", std::move(header), std::move(values)});
}

void NpzArchive::add_bytes(const std::string& name, const std::string& bytes) {
    members_.push_back({name + ".npy", npy_header("|u1", {bytes.size()}) + bytes, {}});
}

void NpzArchive::write(const std::filesystem::path& path) const {
    AtomicFile file(path);
    try {
        // libzip goes back to fill in checksums, which pipes and devices do not allow.
        std::stringstream memory;
        const bool seeks = std::filesystem::is_regular_file(file.temporary_path());
        ZipStream zip(seeks ? file.stream() : memory);
        for (const Member& member : members_) add_to(zip.archive(), member);
        zip.close();
        if (!seeks) file.stream() << memory.rdbuf();
    } catch (const std::runtime_error& error) {
        throw InputError(fmt::format("cannot write '{}': {}", path.string(), error.what()));
    }
    file.commit();
}

void NpzArchive::add_to(zip_t* archive, const Member& member) {
    // libzip takes pieces as they are, and never writes to them.
    const zip_buffer_fragment_t pieces[] = {
        {bytes_of(member.header.data()), member.header.size()},
        {bytes_of(member.values.data()), member.values.size() * sizeof(double)}};
    zip_source_t* source = zip_source_buffer_fragment(archive, pieces, 2, 0);
    const zip_int64_t index =
        source == nullptr ? -1
                          : zip_file_add(archive, member.name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
        zip_source_free(source);
        throw std::runtime_error(zip_strerror(archive));
    }
    const auto entry = static_cast<zip_uint64_t>(index);
    constexpr zip_uint16_t kMidnight = 0, kFirstOf1980 = (1 << 5) | 1;
    if (zip_set_file_compression(archive, entry, ZIP_CM_STORE, 0) < 0 ||
        zip_file_set_dostime(archive, entry, kMidnight, kFirstOf1980, 0) < 0) {
        throw std::runtime_error(zip_strerror(archive));
    }
}

}  // namespace miebrdf::exports
