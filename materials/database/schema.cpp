#include "materials/database/schema.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include <miebrdf/database.h>

namespace miebrdf::materials {
namespace {

// docs/materials.md explains the tables. A change here needs a new kDatabaseVersion.
constexpr char kSchema[] = R"sql(
CREATE TABLE material (
    id            INTEGER PRIMARY KEY,
    name          TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 200),
    key           TEXT NOT NULL,              -- normalised name
    title         TEXT NOT NULL DEFAULT '',
    formula       TEXT NOT NULL DEFAULT '',   -- chemical
    default_label TEXT                        -- NULL: the dataset that came first
) STRICT;
CREATE INDEX material_key ON material (key);

CREATE TABLE alias (
    text        TEXT PRIMARY KEY CHECK (length(text) BETWEEN 1 AND 200),
    key         TEXT NOT NULL,                -- normalised text
    material_id INTEGER NOT NULL REFERENCES material (id) ON DELETE CASCADE
) STRICT;
CREATE INDEX alias_key ON alias (key);
CREATE INDEX alias_material ON alias (material_id);

CREATE TABLE dataset (
    id             INTEGER PRIMARY KEY,
    material_id    INTEGER NOT NULL REFERENCES material (id) ON DELETE CASCADE,
    label          TEXT NOT NULL CHECK (length(label) BETWEEN 1 AND 200),
    source         TEXT NOT NULL DEFAULT '',  -- collection
    source_key     TEXT NOT NULL DEFAULT '',  -- name in the collection
    reference      TEXT NOT NULL DEFAULT '',
    doi            TEXT NOT NULL DEFAULT '',
    licence        TEXT NOT NULL DEFAULT '',
    ray            TEXT NOT NULL DEFAULT '' CHECK (ray IN ('', 'o', 'e')),
    composition    TEXT NOT NULL DEFAULT '',
    note           TEXT NOT NULL DEFAULT '',
    format         TEXT NOT NULL DEFAULT '',  -- of the file it was read from
    file           TEXT NOT NULL DEFAULT '',
    file_sha256    TEXT NOT NULL DEFAULT '' CHECK (length(file_sha256) IN (0, 64)),
    content_sha256 TEXT NOT NULL CHECK (length(content_sha256) = 64),
    temperature_k  REAL CHECK (temperature_k > 0),
    density_g_cm3  REAL CHECK (density_g_cm3 > 0 AND density_g_cm3 < 100),
    density_source TEXT NOT NULL DEFAULT '',
    imported       TEXT NOT NULL DEFAULT '',  -- UTC, ISO 8601; '' when that is not known
    UNIQUE (material_id, label)
) STRICT;
CREATE INDEX dataset_key ON dataset (source_key);

CREATE TABLE series (
    dataset_id  INTEGER NOT NULL REFERENCES dataset (id) ON DELETE CASCADE,
    quantity    TEXT NOT NULL CHECK (quantity IN ('n', 'k')),
    formula     INTEGER NOT NULL CHECK (formula BETWEEN 0 AND 9),      -- 0: a table
    unit        TEXT NOT NULL CHECK (unit IN ('nm', 'um', 'angstrom', 'eV', 'cm-1', 'THz')),
    shortest_nm REAL NOT NULL CHECK (shortest_nm > 0),
    longest_nm  REAL NOT NULL CHECK (longest_nm >= shortest_nm AND longest_nm < 1e300),
    row_count   INTEGER NOT NULL CHECK (row_count >= 1),
    x           BLOB CHECK (x IS NULL OR length(x) = 8 * row_count),   -- NULL: formula, or n's grid
    y           BLOB NOT NULL CHECK (length(y) = 8 * row_count),       -- little-endian doubles
    PRIMARY KEY (dataset_id, quantity),
    CHECK (formula = 0 OR x IS NULL),
    CHECK (formula > 0 OR x IS NOT NULL OR quantity = 'k')
) STRICT;

CREATE TABLE correction (
    dataset_id INTEGER NOT NULL REFERENCES dataset (id) ON DELETE CASCADE,
    position   INTEGER NOT NULL,
    text       TEXT NOT NULL,
    PRIMARY KEY (dataset_id, position)
) STRICT, WITHOUT ROWID;

-- Which material an entry of a collection belongs to; rows in the embedded database only.
CREATE TABLE collection (
    source   TEXT NOT NULL,
    key      TEXT NOT NULL,
    material TEXT NOT NULL,
    PRIMARY KEY (source, key)
) STRICT, WITHOUT ROWID;

-- One document per material, rowid = material.id.
CREATE VIRTUAL TABLE material_text USING fts5 (
    name, aliases, title, formula, provenance, tokenize = "unicode61 remove_diacritics 2"
);
)sql";

// The bytes of a database that has the tables and is in write-ahead mode. Turning that mode on in a
// file that other processes can see already takes an exclusive lock, and a process that opens it
// at that moment may get an error.
std::string empty_database() {
    const auto connection = sqlite::Connection::open_memory();
    create_schema(connection);
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

DatabaseState check_schema(const sqlite::Connection& connection) {
    // One statement, so that all three values belong to the same state of the file.
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
    if (application != kDatabaseApplicationId) {
        refuse("is an SQLite database of another program");
    }
    if (version > kDatabaseVersion) {
        refuse(
            fmt::format("has version {}, newer than the {} that this program knows; use the "
                        "program that wrote it, or a later one",
                        version, kDatabaseVersion));
    }
    if (version < kDatabaseVersion) {
        refuse(
            fmt::format("has version {}, older than the {} that this program knows; import the "
                        "files that it was made from into a new database",
                        version, kDatabaseVersion));
    }
    return DatabaseState::ready;
}

void create_schema(const sqlite::Connection& connection) {
    if (check_schema(connection) == DatabaseState::ready) return;
    sqlite::Transaction transaction(connection);
    // Checked again with the lock held: another process may have created the tables meanwhile.
    if (check_schema(connection) == DatabaseState::ready) return;
    connection.execute(kSchema);
    connection.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                   kDatabaseApplicationId, kDatabaseVersion));
    transaction.commit();
}

void create_database_file(const std::filesystem::path& file) {
#ifdef O_TMPFILE
    std::error_code error;
    if (std::filesystem::exists(std::filesystem::symlink_status(file, error))) return;
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    // A file without a name: nothing is left behind when the process is killed before the end.
    const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0644);
    if (descriptor < 0) return;
    try {
        write_all(descriptor, empty_database(), file);
    } catch (...) {
        ::close(descriptor);
        throw;
    }
    // Fails when another process has created the file meanwhile, which is as good.
    const std::string unnamed = fmt::format("/proc/self/fd/{}", descriptor);
    [[maybe_unused]] const int linked =
        ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, file.c_str(), AT_SYMLINK_FOLLOW);
    ::close(descriptor);
#endif
}

}  // namespace miebrdf::materials
