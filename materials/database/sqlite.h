// SQLite with C++ lifetimes and our errors: only sqlite.cpp calls it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace miebrdf::materials::sqlite {

/// One prepared statement. Parameters are bound in order, then step() until it returns false.
class Statement {
  public:
    Statement& bind(std::string_view text);
    Statement& bind(const char* text) { return bind(std::string_view(text)); }
    Statement& bind(std::int64_t number);
    Statement& bind(int number) { return bind(static_cast<std::int64_t>(number)); }
    Statement& bind(double number);
    Statement& bind(const std::optional<double>& number);
    Statement& bind_blob(std::string_view bytes);
    Statement& bind_null();

    /// True when there is a row to read. @throws DatabaseError
    bool step();
    /// For statements without rows: runs once and makes it ready for the next parameters.
    void run();
    void reset();

    std::string text(int column) const;
    std::string blob(int column) const;
    double number(int column) const;
    std::int64_t integer(int column) const;
    bool is_null(int column) const;

  private:
    friend class Connection;
    struct Finalizer {
        void operator()(sqlite3_stmt* statement) const;
    };
    Statement(sqlite3* connection, std::string_view sql, const std::string* name);
    void check(int code) const;

    sqlite3* connection_;
    const std::string* name_;
    std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
    int bound_ = 0;
};

class Connection {
  public:
    /// Never writes to the database. A crashed writer's leftovers are rolled back first if the
    /// folder allows it. @throws DatabaseError
    static Connection open_read_only(const std::filesystem::path& file);
    /// Creates the file when it is missing. @throws DatabaseError
    static Connection open_read_write(const std::filesystem::path& file);
    /// A database image in memory, which must outlive the connection and is not copied.
    static Connection open_image(std::span<const unsigned char> image);

    /// A new database in memory.
    static Connection open_memory();
    /// The bytes that this database has as a file.
    std::string image() const;
    /// Readers go on reading while somebody writes, and a commit that was reported survives a power
    /// cut. Waits for others as long as a statement does.
    void use_write_ahead_log() const;

    Statement prepare(std::string_view sql) const;
    /// One or more statements without results.
    void execute(const std::string& sql) const;
    std::int64_t integer(std::string_view sql) const;
    std::int64_t last_insert_rowid() const;
    int changes() const;

    /// The file's name, as it appears in messages.
    const std::string& name() const { return *name_; }

  private:
    struct Closer {
        void operator()(sqlite3* connection) const;
    };
    Connection(const std::string& file, const std::string& name, int flags);

    std::unique_ptr<std::string> name_;
    std::unique_ptr<sqlite3, Closer> connection_;
};

/// BEGIN IMMEDIATE now; rolls back at the end of its life unless committed.
class Transaction {
  public:
    explicit Transaction(const Connection& connection);
    ~Transaction();
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    void commit();

  private:
    const Connection& connection_;
    bool open_ = true;
};

}  // namespace miebrdf::materials::sqlite
