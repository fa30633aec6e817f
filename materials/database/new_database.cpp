#include "materials/database/new_database.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "materials/database/schema.h"
#include "materials/database/sqlite.h"
#include "materials/errors.h"

namespace miebrdf::materials {
namespace {

// The bytes of a database that has the tables and is in write-ahead mode. Turning that mode on in a
// file that others can see already takes an exclusive lock, and whoever comes at that moment may be
// turned away.
std::string empty_database() {
    const auto connection = sqlite::Connection::open_memory();
    create_or_migrate_schema(connection);
    std::string image = connection.image();
    // sqlite.org/fileformat2.html, 1.3.3: read and write version, 2 for write-ahead logging.
    image.at(18) = image.at(19) = 2;
    return image;
}

[[maybe_unused]] void write_all(int descriptor, const std::string& bytes,
                                const std::filesystem::path& file) {
    const auto fail = [&] {
        throw DatabaseError(fmt::format("materials database {}: cannot be written: {}",
                                        file.string(), std::generic_category().message(errno)));
    };
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t part = ::write(descriptor, bytes.data() + done, bytes.size() - done);
        if (part < 0 && errno == EINTR) continue;
        if (part <= 0) fail();
        done += static_cast<std::size_t>(part);
    }
    if (::fsync(descriptor) != 0) fail();
}

}  // namespace

void create_database_file(const std::filesystem::path& file) {
#ifdef O_TMPFILE
    std::error_code error;
    if (std::filesystem::exists(std::filesystem::symlink_status(file, error))) return;
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    // Without a name, so that nothing is left when the process is killed before the end.
    const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0644);
    if (descriptor < 0) return;
    try {
        write_all(descriptor, empty_database(), file);
    } catch (...) {
        ::close(descriptor);
        throw;
    }
    // Fails when another process was faster: its file is as good.
    const std::string unnamed = fmt::format("/proc/self/fd/{}", descriptor);
    [[maybe_unused]] const int linked =
        ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, file.c_str(), AT_SYMLINK_FOLLOW);
    ::close(descriptor);
#endif
}

}  // namespace miebrdf::materials
