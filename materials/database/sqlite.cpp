#include "materials/database/sqlite.h"

#include <sqlite3.h>

#include <chrono>
#include <thread>

#include "materials/database/sqlite_failure.h"
#include "materials/errors.h"

namespace miebrdf::materials::sqlite {

void Connection::Closer::operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }

Connection::Connection(const std::string& file, const std::string& name, int flags)
    : name_(std::make_unique<std::string>(name)) {
    sqlite3* raw = nullptr;
    const int code = sqlite3_open_v2(file.c_str(), &raw, flags | SQLITE_OPEN_EXRESCODE, nullptr);
    connection_.reset(raw);
    if (code != SQLITE_OK) fail(code, raw, name);
    sqlite3_busy_timeout(raw, busy_timeout_ms);
    execute("PRAGMA foreign_keys = ON; PRAGMA trusted_schema = OFF");
}

Connection Connection::open_read_write(const std::filesystem::path& file) {
    const std::string name = file.string();
    return Connection(name, name, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
}

Connection Connection::open_image(std::span<const unsigned char> image) {
    Connection connection(":memory:", "(embedded)", SQLITE_OPEN_READWRITE);
    // SQLite promises not to write to an image opened read-only.
    auto* bytes = const_cast<unsigned char*>(image.data());
    const auto size = static_cast<sqlite3_int64>(image.size());
    const int code = sqlite3_deserialize(connection.connection_.get(), "main", bytes, size, size,
                                         SQLITE_DESERIALIZE_READONLY);
    if (code != SQLITE_OK) fail(code, connection.connection_.get(), connection.name());
    return connection;
}

Connection Connection::open_memory() {
    return Connection(":memory:", "(memory)", SQLITE_OPEN_READWRITE);
}

std::string Connection::image() const {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> bytes(
        sqlite3_serialize(connection_.get(), "main", &size, 0), &sqlite3_free);
    if (bytes == nullptr) fail(SQLITE_NOMEM, nullptr, name());
    return {reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size)};
}

void Connection::use_write_ahead_log() const {
    Statement mode = prepare("PRAGMA journal_mode");
    const bool already = mode.step() && mode.text(0) == "wal";
    mode.reset();
    // The change needs the file for itself, and SQLite's own waiting does not cover all of it.
    const auto deadline =
        std::chrono::steady_clock::now() + std::chrono::milliseconds(busy_timeout_ms);
    while (!already) {
        const int code =
            sqlite3_exec(connection_.get(), "PRAGMA journal_mode = WAL", nullptr, nullptr, nullptr);
        if (code == SQLITE_OK) break;
        const bool busy = (code & 0xff) == SQLITE_BUSY || (code & 0xff) == SQLITE_LOCKED;
        if (!busy || std::chrono::steady_clock::now() > deadline)
            fail(code, connection_.get(), name());
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    execute("PRAGMA synchronous = FULL");
}

Statement Connection::prepare(std::string_view sql) const {
    return Statement(connection_.get(), sql, name_.get());
}

void Connection::execute(const std::string& sql) const {
    const int code = sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) fail(code, connection_.get(), *name_);
}

std::int64_t Connection::integer(std::string_view sql) const {
    Statement statement = prepare(sql);
    return statement.step() ? statement.integer(0) : 0;
}

std::int64_t Connection::last_insert_rowid() const {
    return sqlite3_last_insert_rowid(connection_.get());
}

int Connection::changes() const { return sqlite3_changes(connection_.get()); }

Transaction::Transaction(const Connection& connection) : connection_(connection) {
    connection.execute("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
    if (!open_) return;
    try {
        connection_.execute("ROLLBACK");
    } catch (const DatabaseError&) {
        // A full disk or an I/O error has already rolled back by itself.
    }
}

void Transaction::commit() {
    connection_.execute("COMMIT");
    open_ = false;
}

}  // namespace miebrdf::materials::sqlite
