// What SQLite's error codes mean to somebody who has a materials database in front of him.
#pragma once

#include <string>

struct sqlite3;

namespace miebrdf::materials::sqlite {

/// How long to wait for another process that is writing.
constexpr int busy_timeout_ms = 30000;

/// Whether the disk is full: that is what the code says, or the system behind it.
bool no_room(int code, sqlite3* connection);

/// @param connection  may be null: then the code alone explains
/// @param name  of the database, as it appears in the message
/// @throws DamagedDatabase  for contents that are none; DatabaseError for everything else
[[noreturn]] void fail(int code, sqlite3* connection, const std::string& name);

}  // namespace miebrdf::materials::sqlite
