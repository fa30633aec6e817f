#include "materials/database/sqlite_failure.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <cerrno>
#include <system_error>

#include "materials/errors.h"

namespace miebrdf::materials::sqlite {
namespace {

// What the system said when a file could not be read or written; 0 when it said nothing.
int system_error(sqlite3* connection) {
    return connection == nullptr ? 0 : sqlite3_system_errno(connection);
}

std::string with_system_error(const std::string& text, sqlite3* connection) {
    const int error = system_error(connection);
    return error == 0 ? text : text + ": " + std::generic_category().message(error);
}

std::string reason(int code, sqlite3* connection) {
    if (no_room(code, connection))
        return "cannot be written: the disk is full; nothing was changed";
    switch (code & 0xff) {
        case SQLITE_NOTADB:
            return "is not a materials database (not even an SQLite file)";
        case SQLITE_CORRUPT:
            return "is damaged or cut short";
        case SQLITE_READONLY:
            return "cannot be written: the file or its folder is read-only";
        case SQLITE_CANTOPEN:
            return with_system_error("cannot be opened", connection);
        case SQLITE_PERM:
            return "cannot be opened: no permission";
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return fmt::format("is locked by another program (waited {} s)",
                               busy_timeout_ms / 1000);
        case SQLITE_IOERR:
            return with_system_error("cannot be read or written; nothing was changed", connection);
        default:
            break;
    }
    return connection != nullptr ? sqlite3_errmsg(connection) : sqlite3_errstr(code);
}

}  // namespace

// SQLite reports a full disk as such only where it writes the database itself, not when the log or
// the shared memory beside it cannot grow.
bool no_room(int code, sqlite3* connection) {
    const int error = system_error(connection);
    const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
    return (code & 0xff) == SQLITE_FULL || ((code & 0xff) == SQLITE_IOERR && full);
}

void fail(int code, sqlite3* connection, const std::string& name) {
    const std::string text =
        fmt::format("materials database {}: {}", name, reason(code, connection));
    const int primary = code & 0xff;
    if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB) throw DamagedDatabase(text);
    throw DatabaseError(text);
}

}  // namespace miebrdf::materials::sqlite
