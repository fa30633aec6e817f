#include "materials/schema.h"

#include <fmt/format.h>

#include "materials/errors.h"
#include "materials/schema_sql.h"  // generated from schema.sql

namespace miebrdf::materials {

DatabaseState check_schema(const sqlite::Connection& connection) {
    const auto objects = connection.integer("SELECT count(*) FROM sqlite_schema");
    const auto application = connection.integer("PRAGMA application_id");
    const auto version = connection.integer("PRAGMA user_version");
    if (objects == 0 && application == 0 && version == 0) return DatabaseState::empty;
    const auto refuse = [&](const std::string& reason) {
        throw DatabaseError(fmt::format("materials database {}: {}", connection.name(), reason));
    };
    if (application != database_application_id) {
        refuse("is an SQLite database of another program");
    }
    if (version > database_version) {
        refuse(fmt::format("has version {}, newer than the {} that this program knows", version,
                           database_version));
    }
    if (version < 1) refuse(fmt::format("has the unknown version {}", version));
    return DatabaseState::ready;
}

void create_or_migrate_schema(const sqlite::Connection& connection) {
    if (check_schema(connection) == DatabaseState::ready &&
        connection.integer("PRAGMA user_version") == database_version) {
        return;
    }
    const sqlite::Connection& c = connection;
    sqlite::Transaction transaction(c);
    // Looked at again with the lock held: another process may have been faster.
    if (check_schema(c) == DatabaseState::empty) {
        c.execute(schema_sql);
        c.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                              database_application_id, database_version));
    }
    // Migrations from version v to v + 1 will stand here, oldest first.
    transaction.commit();
}

}  // namespace miebrdf::materials
