#include "materials/database/sqlite.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <cctype>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>

#include <miebrdf/database.h>

namespace miebrdf::materials::sqlite {
namespace {

// How long to wait for another process that is writing.
constexpr int kBusyTimeoutMs = 30000;

// The system's message when a file could not be read or written; 0 when it said nothing.
int system_error(sqlite3* connection) {
    return connection == nullptr ? 0 : sqlite3_system_errno(connection);
}

std::string with_system_error(const std::string& text, sqlite3* connection) {
    const int error = system_error(connection);
    return error == 0 ? text : text + ": " + std::generic_category().message(error);
}

// SQLite reports a full disk as such only where it writes the database itself, not when the log or
// the shared memory beside it cannot grow.
bool no_room(int code, sqlite3* connection) {
    const int error = system_error(connection);
    const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
    return (code & 0xff) == SQLITE_FULL || ((code & 0xff) == SQLITE_IOERR && full);
}

// The codes' meaning for a materials database, in the words of its user.
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
            return fmt::format("is locked by another program (waited {} s)", kBusyTimeoutMs / 1000);
        case SQLITE_IOERR:
            return with_system_error("cannot be read or written; nothing was changed", connection);
        default:
            break;
    }
    return connection != nullptr ? sqlite3_errmsg(connection) : sqlite3_errstr(code);
}

// @param connection  may be null: then the code alone explains
// @param name  of the database, as it appears in the message
// @throws DamagedDatabase  for contents that are no database; DatabaseError for everything else
[[noreturn]] void fail(int code, sqlite3* connection, const std::string& name) {
    const std::string text =
        fmt::format("materials database {}: {}", name, reason(code, connection));
    const int primary = code & 0xff;
    if (primary == SQLITE_CORRUPT || primary == SQLITE_NOTADB) throw DamagedDatabase(text);
    throw DatabaseError(text);
}

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

// The name under which SQLite opens a file that does not change while it is read.
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

void Statement::Finalizer::operator()(sqlite3_stmt* statement) const {
    sqlite3_finalize(statement);
}

Statement::Statement(sqlite3* connection, std::string_view sql, const std::string* name)
    : connection_(connection), name_(name) {
    sqlite3_stmt* raw = nullptr;
    check(sqlite3_prepare_v2(connection, sql.data(), static_cast<int>(sql.size()), &raw, nullptr));
    statement_.reset(raw);
}

void Statement::check(int code) const {
    if (code != SQLITE_OK) fail(code, connection_, *name_);
}

Statement& Statement::bind(std::string_view text) {
    check(sqlite3_bind_text64(statement_.get(), ++bound_, text.empty() ? "" : text.data(),
                              text.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
    return *this;
}

Statement& Statement::bind(std::int64_t number) {
    check(sqlite3_bind_int64(statement_.get(), ++bound_, number));
    return *this;
}

Statement& Statement::bind(double number) {
    check(sqlite3_bind_double(statement_.get(), ++bound_, number));
    return *this;
}

Statement& Statement::bind(const std::optional<double>& number) {
    return number ? bind(*number) : bind_null();
}

Statement& Statement::bind_blob(std::string_view bytes) {
    check(sqlite3_bind_blob64(statement_.get(), ++bound_, bytes.empty() ? "" : bytes.data(),
                              bytes.size(), SQLITE_TRANSIENT));
    return *this;
}

Statement& Statement::bind_null() {
    check(sqlite3_bind_null(statement_.get(), ++bound_));
    return *this;
}

bool Statement::step() {
    const int code = sqlite3_step(statement_.get());
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) fail(sqlite3_extended_errcode(connection_), connection_, *name_);
    return false;
}

void Statement::run() {
    while (step()) {
    }
    reset();
}

void Statement::reset() {
    sqlite3_reset(statement_.get());
    sqlite3_clear_bindings(statement_.get());
    bound_ = 0;
}

std::string Statement::text(int column) const {
    const auto* bytes =
        reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
    const int size = sqlite3_column_bytes(statement_.get(), column);
    return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
}

std::string Statement::blob(int column) const {
    const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_.get(), column));
    const int size = sqlite3_column_bytes(statement_.get(), column);
    return bytes == nullptr ? std::string() : std::string(bytes, static_cast<std::size_t>(size));
}

double Statement::number(int column) const {
    return sqlite3_column_double(statement_.get(), column);
}

std::int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(statement_.get(), column);
}

bool Statement::is_null(int column) const {
    return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

void Connection::Closer::operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }

Connection::Connection(const std::string& file, const std::string& name, int flags)
    : name_(std::make_unique<std::string>(name)) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    // Opening a pipe waits until somebody writes into it.
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
        !std::filesystem::is_directory(status))
        throw DatabaseError(fmt::format("materials database {}: no ordinary file", name));
    sqlite3* raw = nullptr;
    const int code = sqlite3_open_v2(file.c_str(), &raw, flags | SQLITE_OPEN_EXRESCODE, nullptr);
    connection_.reset(raw);
    if (code != SQLITE_OK) fail(code, raw, name);
    sqlite3_busy_timeout(raw, kBusyTimeoutMs);
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
        sqlite3_serialize(connection_.get(), "main", &size, 0), sqlite3_free);
    if (bytes == nullptr) fail(SQLITE_NOMEM, nullptr, name());
    return {reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size)};
}

void Connection::use_write_ahead_log() const {
    Statement mode = prepare("PRAGMA journal_mode");
    const bool already = mode.step() && mode.text(0) == "wal";
    mode.reset();
    // The change needs an exclusive lock; SQLite's own waiting for locks does not cover all its
    // steps.
    const auto deadline =
        std::chrono::steady_clock::now() + std::chrono::milliseconds(kBusyTimeoutMs);
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

// Opens a database for reading, also in a folder without write permission or after a crashed
// writer.
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
