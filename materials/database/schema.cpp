#include "materials/database/schema.h"

#include <fmt/format.h>

#include <iterator>

#include "materials/errors.h"
#include "materials/schema_sql.h"  // generated from schema.sql

namespace miebrdf::materials {
namespace {

// The first entry leads from version 1 to 2, and so on. What was released is never changed: the
// result has to be schema.sql, whichever way a file came there.
constexpr const char* migrations[] = {
    // When a dataset was imported; of those that are there already nobody knows.
    "ALTER TABLE dataset ADD COLUMN imported TEXT NOT NULL DEFAULT ''",
};
static_assert(std::size(migrations) == database_version - 1);

std::int64_t version_of(const sqlite::Connection& connection) {
    return connection.integer("PRAGMA user_version");
}

}  // namespace

DatabaseState check_schema(const sqlite::Connection& connection) {
    // One statement, so that all three are of the same moment.
    sqlite::Statement header = connection.prepare(
        "SELECT (SELECT count(*) FROM sqlite_schema), application_id, user_version "
        "FROM pragma_application_id, pragma_user_version");
    header.step();
    const auto objects = header.integer(0);
    const auto application = header.integer(1);
    const auto version = header.integer(2);
    if (objects == 0 && application == 0 && version == 0) return DatabaseState::empty;
    const auto refuse = [&](const std::string& reason) {
        throw DatabaseError(fmt::format("materials database {}: {}", connection.name(), reason));
    };
    if (application != database_application_id) {
        refuse("is an SQLite database of another program");
    }
    if (version > database_version) {
        refuse(
            fmt::format("has version {}, newer than the {} that this program knows; use the "
                        "program that wrote it, or a later one",
                        version, database_version));
    }
    if (version < 1) refuse(fmt::format("has the unknown version {}", version));
    return version < database_version ? DatabaseState::older : DatabaseState::ready;
}

void create_or_migrate_schema(const sqlite::Connection& connection) {
    if (check_schema(connection) == DatabaseState::ready) return;
    const sqlite::Connection& c = connection;
    sqlite::Transaction transaction(c);
    // Looked at again with the lock held: another process may have been faster.
    switch (check_schema(c)) {
        case DatabaseState::empty:
            c.execute(schema_sql);
            c.execute(fmt::format("PRAGMA application_id = {}", database_application_id));
            break;
        case DatabaseState::older:
            for (auto version = version_of(c); version < database_version; ++version) {
                c.execute(migrations[version - 1]);
            }
            break;
        case DatabaseState::ready:
            return;
    }
    c.execute(fmt::format("PRAGMA user_version = {}", database_version));
    transaction.commit();
}

}  // namespace miebrdf::materials
