// Databases read where nobody may write, and after writers that died: what was committed is there,
// or the answer is a clear error; never a part, never an older state in silence.
#include <unistd.h>

#include <miebrdf/database.h>
#include "materials/database/sqlite.h"
#include "tests/materials/batches.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;
using namespace miebrdf::materials::testing;
using sqlite::Connection;

namespace {

namespace fs = std::filesystem;

constexpr int wrong_count = 31;

/// Reads as a process that may not write here; root becomes nobody for it.
int read_as_nobody(const fs::path& file, std::int64_t rows) {
    return exit_code(in_child([&] {
        if (geteuid() == 0 && setuid(65534) != 0) _exit(30);
        const Connection connection = Connection::open_read_only(file);
        if (connection.integer("SELECT count(*) FROM t") != rows) _exit(wrong_count);
    }));
}

/// A folder whose files may be read, but not changed, for as long as this lives.
class Locked {
  public:
    explicit Locked(const fs::path& folder) : folder_(folder) {
        for (const auto& entry : fs::directory_iterator(folder))
            fs::permissions(entry.path(), fs::perms(0444));
        fs::permissions(folder, fs::perms(0555));
    }
    ~Locked() {
        fs::permissions(folder_, fs::perms(0755));
        for (const auto& entry : fs::directory_iterator(folder_))
            fs::permissions(entry.path(), fs::perms(0644));
    }
    Locked(const Locked&) = delete;
    Locked& operator=(const Locked&) = delete;

  private:
    fs::path folder_;
};

void create(const fs::path& file, const char* journal) {
    const Connection connection = Connection::open_read_write(file);
    connection.execute(std::string("PRAGMA journal_mode = ") + journal +
                       "; CREATE TABLE t (x); INSERT INTO t VALUES (1), (2), (3)");
}

/// Does the work and dies, with everything still open.
void die_after(const fs::path& file, const std::string& sql) {
    REQUIRE(exit_code(in_child([&] {
                const Connection connection = Connection::open_read_write(file);
                connection.execute(sql);
                _exit(0);
            })) == 0);
}

}  // namespace

TEST_CASE("databases of any name are read in folders that may not be written",
          "[materials][reliability]") {
    const support::TemporaryFolder folder;
    // All that means something in the addresses by which SQLite opens such files.
    const fs::path file = folder / GENERATE("plain.db", "a b.db", "50%25.db", "what?immutable=0.db",
                                            "a#b&c.db", "\u03bb.db");
    CAPTURE(file.string());
    create(file, GENERATE("WAL", "DELETE"));
    const Locked locked(folder.path());
    CHECK(read_as_nobody(file, 3) == 0);
    CHECK(read_as_nobody(folder / "missing.db", 3) == database_error);
}

TEST_CASE("a transaction cut off by death is rolled back by the next reader",
          "[materials][reliability]") {
    const support::TemporaryFolder folder;
    const fs::path file = folder / "old.db", journal = folder / "old.db-journal";
    create(file, "DELETE");
    // More than its cache holds: pages of the file itself are written before the end.
    die_after(file,
              "PRAGMA cache_size = 2; BEGIN; WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + "
              "1 FROM n WHERE i < 5000) INSERT INTO t SELECT randomblob(100) FROM n");
    REQUIRE(fs::exists(journal));
    REQUIRE(fs::file_size(file) > 100'000);
    {
        // Half a transaction must not be read; nobody may remove it here.
        const Locked locked(folder.path());
        CHECK(read_as_nobody(file, 3) == database_error);
    }
    CHECK(Connection::open_read_only(file).integer("SELECT count(*) FROM t") == 3);
    CHECK_FALSE(fs::exists(journal));
}

TEST_CASE("what a dead writer has committed into its log is read or missed aloud",
          "[materials][reliability]") {
    const support::TemporaryFolder folder;
    const fs::path file = folder / "new.db", log = folder / "new.db-wal";
    create(file, "WAL");
    die_after(file, "INSERT INTO t VALUES (4)");
    REQUIRE(fs::exists(log));
    fs::remove(folder / "new.db-shm");  // as in a copy of the two files
    {
        // Without a place for shared memory the log cannot be read, and the file alone has 3 rows.
        const Locked locked(folder.path());
        CHECK(read_as_nobody(file, 4) == database_error);
    }
    CHECK(Connection::open_read_only(file).integer("SELECT count(*) FROM t") == 4);
}

TEST_CASE("what is no database is refused by name", "[materials][reliability][errors]") {
    const support::TemporaryFolder folder;
    const std::string text = folder.write("notes.txt", std::string(2000, 'x'));
    CHECK_THROWS_AS(Connection::open_read_only(text), DamagedDatabase);
    CHECK_THROWS_WITH(Connection::open_read_only(text),
                      Catch::Contains("notes.txt") && Catch::Contains("not even an SQLite file"));
    CHECK_THROWS_WITH(Connection::open_read_only(folder / "missing.db"),
                      Catch::Contains("missing.db") && Catch::Contains("cannot be opened"));
    CHECK_THROWS_AS(Connection::open_read_only(folder.path()), DatabaseError);
}
