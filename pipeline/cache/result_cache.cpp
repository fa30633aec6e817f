#include "pipeline/cache/result_cache.h"

#include <miebrdf/control.h>

#include <chrono>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <system_error>

#include <miebrdf/database.h>
#include "materials/database/sqlite.h"
#include "materials/database/user_file.h"
#include "materials/index/checksum.h"

namespace miebrdf {
namespace {

namespace fs = std::filesystem;
using materials::sqlite::Connection;

constexpr char kSchema[] =
    "PRAGMA journal_mode = WAL;"
    "PRAGMA synchronous = NORMAL;"
    "CREATE TABLE IF NOT EXISTS result ("
    "  hash TEXT PRIMARY KEY,"
    "  numbers BLOB NOT NULL,"
    "  bytes INTEGER NOT NULL,"
    "  checksum TEXT NOT NULL,"
    "  stored_at INTEGER NOT NULL"
    ");"
    // Covers the sum of sizes and the search for the oldest, so that neither reads the numbers.
    "CREATE INDEX IF NOT EXISTS result_age ON result (stored_at, bytes);";

constexpr char kSumOfBytes[] = "SELECT coalesce(sum(bytes), 0) FROM result INDEXED BY result_age";

std::int64_t now_s() {
    return std::chrono::duration_cast<std::chrono::seconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
}

/// Whether a file exists that does not begin as SQLite files do.
bool is_foreign(const fs::path& file) {
    constexpr std::string_view kMagic("SQLite format 3\0", 16);
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return false;
    std::string start(kMagic.size(), '\0');
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    return stream.gcount() > 0 && start != kMagic;
}

void remove_files(const fs::path& file) {
    std::error_code ignored;
    for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(file.string() + suffix, ignored);
}

}  // namespace

std::string checksum_of(const std::string& hash, std::string_view bytes) {
    return materials::sha256_hex(hash + std::string(bytes));
}

struct ResultCache::Database {
    explicit Database(const fs::path& file) : connection(Connection::open_read_write(file)) {
        connection.execute(kSchema);
    }
    Connection connection;
    std::int64_t stored_bytes = std::numeric_limits<std::int64_t>::max();  ///< since the last sum
};

fs::path ResultCache::default_file() {
    return materials::user_file("XDG_CACHE_HOME", ".cache", "results.sqlite");
}

ResultCache::ResultCache(const fs::path& file, std::int64_t limit_bytes)
    : file_(file), limit_bytes_(limit_bytes) {
    open();
    // A file that is no SQLite file at all holds nothing that cannot be computed again. Any other
    // failure may be another process at work: then this run goes without.
    if (!database_ && is_foreign(file_)) {
        remove_files(file_);
        open();
    }
}

void ResultCache::open() {
    std::error_code ignored;
    fs::create_directories(file_.parent_path(), ignored);
    try {
        database_ = std::make_unique<Database>(file_);
    } catch (const materials::DamagedDatabase&) {
        start_again();
    } catch (const std::exception&) {
        database_.reset();
    }
}

void ResultCache::start_again() {
    database_.reset();
    remove_files(file_);
    try {
        database_ = std::make_unique<Database>(file_);
    } catch (const std::exception&) {
        database_.reset();
    }
}

ResultCache::~ResultCache() = default;

std::optional<std::vector<double>> ResultCache::find(const std::string& hash) {
    const std::lock_guard lock(mutex_);
    if (!database_) return std::nullopt;
    try {
        auto query =
            database_->connection.prepare("SELECT numbers, checksum FROM result WHERE hash = ?");
        query.bind(hash);
        if (!query.step()) return std::nullopt;
        const std::string bytes = query.blob(0);
        if (bytes.size() % sizeof(double) != 0 || checksum_of(hash, bytes) != query.text(1)) {
            query.reset();
            database_->connection.prepare("DELETE FROM result WHERE hash = ?").bind(hash).run();
            return std::nullopt;
        }
        std::vector<double> numbers(bytes.size() / sizeof(double));
        std::memcpy(numbers.data(), bytes.data(), bytes.size());
        return numbers;
    } catch (const materials::DamagedDatabase&) {
        start_again();
        return std::nullopt;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

void ResultCache::store(const std::string& hash, std::span<const double> numbers) {
    const std::lock_guard lock(mutex_);
    if (!database_) return;
    try {
        const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()),
                                     numbers.size_bytes());
        database_->connection
            .prepare(
                "INSERT OR REPLACE INTO result (hash, numbers, bytes, checksum, "
                "stored_at) VALUES (?, ?, ?, ?, ?)")
            .bind(hash)
            .bind_blob(bytes)
            .bind(static_cast<std::int64_t>(bytes.size()))
            .bind(checksum_of(hash, bytes))
            .bind(now_s())
            .run();
        // The sum of sizes reads an entry of the index for each result (1 ms for 50,000): it is
        // taken at the first one that is stored, and again after each of so many parts of the
        // limit.
        constexpr std::int64_t kPartsOfLimit = 64;
        if (database_->stored_bytes < limit_bytes_ / kPartsOfLimit) {
            database_->stored_bytes += static_cast<std::int64_t>(bytes.size());
            return;
        }
        forget_oldest();
        database_->stored_bytes = 0;
    } catch (const materials::DamagedDatabase&) {
        start_again();
    } catch (const std::exception&) {
        // Nothing is remembered this time: the disk is full, or another process held the lock.
    }
}

void ResultCache::forget_oldest() {
    const Connection& connection = database_->connection;
    while (connection.integer(kSumOfBytes) > limit_bytes_) {
        connection.execute(
            "DELETE FROM result WHERE rowid IN "
            "(SELECT rowid FROM result ORDER BY stored_at LIMIT 16)");
    }
}

ResultCache::Info ResultCache::info() const {
    const std::lock_guard lock(mutex_);
    Info info{.file = file_, .limit_bytes = limit_bytes_};
    if (!database_) return info;
    try {
        const Connection& connection = database_->connection;
        info.entries = connection.integer("SELECT count(*) FROM result");
        info.bytes = connection.integer(kSumOfBytes);
        info.usable = true;
    } catch (const std::exception&) {
        info.usable = false;
    }
    return info;
}

std::int64_t ResultCache::clear() {
    const std::int64_t entries = info().entries;
    const std::lock_guard lock(mutex_);
    database_.reset();
    remove_files(file_);
    open();
    return entries;
}

std::shared_ptr<ResultCache> open_cache() {
    return std::make_shared<ResultCache>(ResultCache::default_file());
}

}  // namespace miebrdf
