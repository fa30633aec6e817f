// Reading a database that may lie where nobody may write, or that a crashed writer has left.
#include <fmt/format.h>
#include <sqlite3.h>

#include <cctype>
#include <system_error>

#include "materials/database/sqlite.h"
#include "materials/database/sqlite_failure.h"

namespace miebrdf::materials::sqlite {
namespace {

// SQLITE_OK when the schema can be read, which is the first thing that needs the file itself.
int try_reading(sqlite3* connection) {
    sqlite3_stmt* raw = nullptr;
    int code =
        sqlite3_prepare_v2(connection, "SELECT count(*) FROM sqlite_schema", -1, &raw, nullptr);
    if (code == SQLITE_OK) {
        code = sqlite3_step(raw);
        if (code == SQLITE_ROW) code = SQLITE_OK;
    }
    sqlite3_finalize(raw);
    return code;
}

bool writer_died(int code) {
    return code == SQLITE_READONLY_ROLLBACK || code == SQLITE_READONLY_RECOVERY;
}

bool no_place_beside(int code, sqlite3* connection) {
    const int primary = code & 0xff;
    return primary == SQLITE_CANTOPEN || primary == SQLITE_READONLY || no_room(code, connection);
}

bool not_empty(const std::string& path) {
    std::error_code error;
    return std::filesystem::exists(path, error) && std::filesystem::file_size(path, error) > 0;
}

// SQLite's name for a file that does not change while it is read.
std::string immutable_uri(const std::filesystem::path& file) {
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(file).string()) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = std::isalnum(byte) != 0 || c == '/' || c == '.' || c == '_' || c == '-';
        uri += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    return uri + "?immutable=1";
}

}  // namespace

Connection Connection::open_read_only(const std::filesystem::path& file) {
    const std::string name = file.string();
    const auto readable = [](const Connection& connection) {
        return try_reading(connection.connection_.get()) == SQLITE_OK;
    };
    Connection connection(name, name, SQLITE_OPEN_READONLY);
    sqlite3* handle = connection.connection_.get();
    const int code = try_reading(handle);
    if (code == SQLITE_OK) return connection;
    if (writer_died(code)) {
        // Opening for writing once lets SQLite roll the journal back.
        const Connection repair(name, name, SQLITE_OPEN_READWRITE);
        if (readable(repair)) return Connection(name, name, SQLITE_OPEN_READONLY);
    }
    const bool log_left = not_empty(name + "-wal") || not_empty(name + "-journal");
    if (no_place_beside(code, handle) && !log_left) {
        // Write-ahead logging wants a shared-memory file beside the database. Where the folder is
        // read-only or the disk full nobody can be writing either, so the file may be read as it
        // is.
        Connection frozen(immutable_uri(file), name, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
        if (readable(frozen)) return frozen;
    }
    fail(code, handle, name);
}

}  // namespace miebrdf::materials::sqlite
