// npz: NumPy's archive of arrays. docs/formats/table.md
#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "pipeline/formats/table/late_zip.h"
#include "pipeline/formats/table/npz.h"
#include "pipeline/formats/table/tabulate.h"

namespace miebrdf {

FormatReader npz_reader();  // npz_reader.cpp

namespace {

/// A new archive whose bytes go to `out`, which must be empty and able to seek. libzip's own files
/// are temporaries under a name of its choice, which would stay behind when a signal ends the
/// program; a stream's file is known to whoever opened it.
class ZipStream {
  public:
    /// @throws std::runtime_error  when libzip cannot begin
    explicit ZipStream(std::ostream& out);
    ~ZipStream();
    ZipStream(const ZipStream&) = delete;
    ZipStream& operator=(const ZipStream&) = delete;

    zip_t* archive() const { return archive_; }

    /// Writes everything that was added. @throws std::runtime_error  with libzip's reason
    void close();

  private:
    struct Sink;
    static zip_int64_t answer(void* sink, void* data, zip_uint64_t length,
                              zip_source_cmd_t command);

    std::unique_ptr<Sink> sink_;
    zip_t* archive_ = nullptr;
};

struct ZipStream::Sink {
    explicit Sink(std::ostream& stream) : out(stream) { zip_error_init(&error); }
    ~Sink() { zip_error_fini(&error); }
    Sink(const Sink&) = delete;
    Sink& operator=(const Sink&) = delete;

    zip_int64_t fail(int code, int system) {
        zip_error_set(&error, code, system);
        return -1;
    }
    /// `result`, or an error when the stream has had enough.
    zip_int64_t checked(zip_int64_t result, int code) {
        return out.good() ? result : fail(code, errno != 0 ? errno : EIO);
    }
    zip_int64_t seek(void* data, zip_uint64_t length) {
        const auto* to = ZIP_SOURCE_GET_ARGS(zip_source_args_seek_t, data, length, &error);
        if (to == nullptr) return -1;
        out.seekp(to->offset, to->whence == SEEK_SET   ? std::ios::beg
                              : to->whence == SEEK_CUR ? std::ios::cur
                                                       : std::ios::end);
        return checked(0, ZIP_ER_SEEK);
    }

    std::ostream& out;
    zip_error_t error;
};

zip_int64_t ZipStream::answer(void* self, void* data, zip_uint64_t length,
                              zip_source_cmd_t command) {
    Sink& sink = *static_cast<Sink*>(self);
    errno = 0;
    switch (command) {
        case ZIP_SOURCE_SUPPORTS:
            // Archives must be readable to libzip, but a new one it never reads.
            return zip_source_make_command_bitmap(
                ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE, ZIP_SOURCE_STAT,
                ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, ZIP_SOURCE_SEEK, ZIP_SOURCE_TELL,
                ZIP_SOURCE_SUPPORTS, ZIP_SOURCE_BEGIN_WRITE, ZIP_SOURCE_COMMIT_WRITE,
                ZIP_SOURCE_ROLLBACK_WRITE, ZIP_SOURCE_WRITE, ZIP_SOURCE_SEEK_WRITE,
                ZIP_SOURCE_TELL_WRITE, ZIP_SOURCE_REMOVE, -1);
        case ZIP_SOURCE_STAT:
            return sink.fail(ZIP_ER_READ, ENOENT);  // there is none yet
        case ZIP_SOURCE_WRITE:
            sink.out.write(static_cast<const char*>(data), static_cast<std::streamsize>(length));
            return sink.checked(static_cast<zip_int64_t>(length), ZIP_ER_WRITE);
        case ZIP_SOURCE_SEEK_WRITE:
            return sink.seek(data, length);
        case ZIP_SOURCE_TELL_WRITE:
            return sink.checked(sink.out.tellp(), ZIP_ER_TELL);
        case ZIP_SOURCE_COMMIT_WRITE:
            sink.out.flush();
            return sink.checked(0, ZIP_ER_WRITE);
        case ZIP_SOURCE_ERROR:
            return zip_error_to_data(&sink.error, data, length);
        case ZIP_SOURCE_BEGIN_WRITE:
        case ZIP_SOURCE_ROLLBACK_WRITE:
        case ZIP_SOURCE_REMOVE:
        case ZIP_SOURCE_FREE:
            return 0;
        default:
            return sink.fail(ZIP_ER_OPNOTSUPP, 0);
    }
}

ZipStream::ZipStream(std::ostream& out) : sink_(std::make_unique<Sink>(out)) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_function_create(answer, sink_.get(), &error);
    if (source != nullptr) archive_ = zip_open_from_source(source, ZIP_CREATE, &error);
    if (archive_ == nullptr) {
        const std::string reason = zip_error_strerror(&error);
        zip_source_free(source);
        zip_error_fini(&error);
        throw std::runtime_error(reason);
    }
    zip_error_fini(&error);
}

ZipStream::~ZipStream() {
    if (archive_ != nullptr) zip_discard(archive_);
}

void ZipStream::close() {
    if (zip_close(archive_) < 0) throw std::runtime_error(zip_strerror(archive_));
    archive_ = nullptr;  // zip_close has freed it
}

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
    std::string header("\x93NUMPY\x01\x00", 8);
    header += static_cast<char>(length & 0xff);
    header += static_cast<char>(length >> 8);
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

void NpzArchive::write(std::ostream& out) const {
    try {
        ZipStream zip(out);
        for (const Member& member : members_) add_to(zip.archive(), member);
        zip.close();
    } catch (const std::runtime_error& error) {
        throw InputError(fmt::format("npz: {}", error.what()));
    }
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

namespace {

/// Arrays wavelength_nm, mu_in, mu_out, azimuth_deg, brdf[wavelength, mu_in, mu_out, azimuth],
/// where it is known mueller[..., row, column], and meta (JSON as bytes).
void write_npz(const ExportJob& job, std::ostream& out) {
    const std::vector<double>& wavelength_nm = job.spectral.wavelength_nm();
    const rte::Directions grid = table_directions(job.options);
    NpzArchive archive;
    archive.add("wavelength_nm", wavelength_nm);
    archive.add("mu_in", grid.mu_in);
    archive.add("mu_out", grid.mu_out);
    archive.add("azimuth_deg", grid.azimuth_deg);
    archive.add(
        "brdf", tabulate(job.spectral, grid, job.control),
        {wavelength_nm.size(), grid.mu_in.size(), grid.mu_out.size(), grid.azimuth_deg.size()});
    if (const int components = job.spectral.components(); components > 1) {
        const auto c = static_cast<std::size_t>(components);
        archive.add("mueller", tabulate_mueller(job.spectral, grid, job.control),
                    {wavelength_nm.size(), grid.mu_in.size(), grid.mu_out.size(),
                     grid.azimuth_deg.size(), c, c});
    }
    archive.add_bytes("meta", metadata(job.spectral, {.format = "npz",
                                                      .cosine_included = false,
                                                      .azimuth_zero = "mirror side",
                                                      .colour = ""})
                                  .dump(1));
    archive.write(out);
}

}  // namespace

Format npz_format() {
    Format format = table_format("npz", "NumPy", ".npz", write_npz, npz_reader());
    format.seeks = true;
    return format;
}

}  // namespace miebrdf
