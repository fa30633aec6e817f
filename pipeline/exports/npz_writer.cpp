#include "pipeline/exports/npz_writer.h"

#include <fmt/format.h>
#include <zip.h>

#include <bit>
#include <memory>

#include "pipeline/atomic_file.h"
#include "pipeline/error.h"

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

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason) {
    throw InputError(fmt::format("cannot write '{}': {}", path.string(), reason));
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
    int error = 0;
    // Until zip_close succeeds nothing is written; what is not closed must be discarded.
    std::unique_ptr<zip_t, decltype(&zip_discard)> archive(
        zip_open(file.temporary_path().c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error), zip_discard);
    if (!archive) refuse(path, fmt::format("libzip error {}", error));
    for (const Member& member : members_) {
        // libzip takes pieces as they are, and never writes to them.
        const zip_buffer_fragment_t pieces[] = {
            {bytes_of(member.header.data()), member.header.size()},
            {bytes_of(member.values.data()), member.values.size() * sizeof(double)}};
        zip_source_t* source = zip_source_buffer_fragment(archive.get(), pieces, 2, 0);
        const zip_int64_t index =
            source == nullptr
                ? -1
                : zip_file_add(archive.get(), member.name.c_str(), source, ZIP_FL_ENC_UTF_8);
        if (index < 0) {
            zip_source_free(source);
            refuse(path, zip_strerror(archive.get()));
        }
        const auto entry = static_cast<zip_uint64_t>(index);
        constexpr zip_uint16_t kMidnight = 0, kFirstOf1980 = (1 << 5) | 1;
        if (zip_set_file_compression(archive.get(), entry, ZIP_CM_STORE, 0) < 0 ||
            zip_file_set_dostime(archive.get(), entry, kMidnight, kFirstOf1980, 0) < 0) {
            refuse(path, zip_strerror(archive.get()));
        }
    }
    if (zip_close(archive.get()) < 0) refuse(path, zip_strerror(archive.get()));
    (void)archive.release();  // zip_close has freed it
    file.commit();
}

}  // namespace miebrdf::exports
