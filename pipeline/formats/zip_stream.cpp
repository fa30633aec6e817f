#include "pipeline/formats/zip_stream.h"

#include <cerrno>
#include <ostream>
#include <stdexcept>

namespace miebrdf::exports {

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

}  // namespace miebrdf::exports
