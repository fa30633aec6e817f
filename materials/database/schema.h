// The tables of a materials database, and how a file is recognised as one.
#pragma once

#include "materials/database/sqlite.h"

namespace miebrdf::materials {

/// "mieb": marks the file in SQLite's header, so that a foreign database is never taken for ours.
inline constexpr int database_application_id = 0x6d696562;
inline constexpr int database_version = 2;

enum class DatabaseState { empty, older, ready };

/// @throws DatabaseError  when the file is another program's, damaged or of a newer version
DatabaseState check_schema(const sqlite::Connection& connection);

/// Creates the tables in an empty database, brings an older one up to date; one transaction.
void create_or_migrate_schema(const sqlite::Connection& connection);

}  // namespace miebrdf::materials
