// Zip archives written straight into a stream.
#pragma once

#include <zip.h>

#include <iosfwd>
#include <memory>
#include <string>

namespace miebrdf::exports {

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

}  // namespace miebrdf::exports
