// The tables of a materials database, how a file is recognised as one, and how one comes into
// being.
#pragma once

#include <filesystem>

#include "materials/database/sqlite.h"

namespace miebrdf::materials {

/// "mieb": marks the file in SQLite's header, so that a foreign database is never taken for ours.
inline constexpr int kDatabaseApplicationId = 0x6d696562;
/// The only version that is read and written.
inline constexpr int kDatabaseVersion = 3;

enum class DatabaseState { empty, ready };

/// @throws DatabaseError  when the file is another program's, damaged or of another version
DatabaseState check_schema(const sqlite::Connection& connection);

/// Creates the tables in an empty database; one transaction. @throws DatabaseError  as check_schema
void create_schema(const sqlite::Connection& connection);

/// Puts a complete database without materials at `file`, in one step: other processes see no file
/// or all of it, and of several that create it at once the first wins and the others find it there.
/// Does nothing when the file exists, or where the system cannot do this (no unnamed files or hard
/// links, a folder that does not exist or is read-only): then SQLite creates it when it is opened.
/// @throws DatabaseError  when it cannot be written (a full disk); then there is no file
void create_database_file(const std::filesystem::path& file);

}  // namespace miebrdf::materials
