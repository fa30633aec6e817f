// Databases of older and of newer versions than this program's.
#include <fmt/format.h>
#include <signal.h>
#include <sqlite3.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <random>
#include <thread>

#include "materials/database/database.h"
#include "materials/database/database_writer.h"
#include "materials/database/schema.h"
#include "materials/database/sqlite.h"
#include "tests/materials/batches.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;
using namespace miebrdf::materials::testing;

namespace {

namespace fs = std::filesystem;

constexpr int materials_in_it = 50;

// What version 0.1 left on a user's disk: its tables, in write-ahead mode, closed properly.
fs::path version_1_file(const support::TemporaryFolder& folder) {
    const fs::path file = folder.path() / "old.sqlite";
    const auto c = sqlite::Connection::open_read_write(file);
    c.execute(support::read_file(MIEBRDF_MATERIALS_SCHEMAS "/version_1.sql"));
    c.execute(
        fmt::format("PRAGMA application_id = {}; PRAGMA user_version = 1; "
                    "PRAGMA journal_mode = WAL",
                    database_application_id));
    sqlite::Transaction transaction(c);
    std::vector<Dataset> datasets = batch("Old");
    datasets.resize(materials_in_it);
    for (const Dataset& d : datasets) {
        c.prepare("INSERT INTO material (name, key, title) VALUES (?, ?, 'An old one')")
            .bind(d.material)
            .bind(fmt::format("old{}", d.material.substr(4)))
            .run();
        const auto id = c.last_insert_rowid();
        c.prepare("INSERT INTO alias VALUES (?, ?, ?)")
            .bind(d.material + " too")
            .bind(fmt::format("old{}too", d.material.substr(4)))
            .bind(id)
            .run();
        c.prepare(
             "INSERT INTO dataset (material_id, label, source, ray, content_sha256, "
             "temperature_k) VALUES (?, 'x', 'Old', 'o', ?, 293)")
            .bind(id)
            .bind(content_sha256(d))
            .run();
        c.prepare("INSERT INTO series VALUES (?, 'n', 0, 'nm', 400, 439, 40, ?, ?)")
            .bind(c.last_insert_rowid())
            .bind_blob(to_bytes(d.n->x))
            .bind_blob(to_bytes(d.n->y))
            .run();
        c.prepare("INSERT INTO correction SELECT max(id), 0, 'sorted' FROM dataset").run();
        c.prepare("INSERT INTO material_text (rowid, name, title) VALUES (?, ?, 'An old one')")
            .bind(id)
            .bind(d.material)
            .run();
    }
    transaction.commit();
    return file;
}

int version_of(const fs::path& file) {
    return static_cast<int>(
        sqlite::Connection::open_read_only(file).integer("PRAGMA user_version"));
}

void check_content(const fs::path& file) {
    const Database database = Database::open(file);
    REQUIRE(database.list().size() == materials_in_it);
    for (int i = 0; i < materials_in_it; ++i) {
        const Dataset d = database.dataset(fmt::format("old-{}-too", i));
        CHECK(d.n->y.front() == 1.5 + 1e-3 * i);
        CHECK(d.ray == "o");
        CHECK(d.temperature_k == 293.0);
        CHECK(d.corrections == std::vector<std::string>{"sorted"});
    }
    CHECK(database.search("old").size() == materials_in_it);
    CHECK(database.dataset_info("Old-7").imported.empty());
    CHECK(database.integrity_problems().empty());
}

// Columns and indices of every table; the text of a table that was altered is spelled otherwise.
std::vector<std::string> shape_of(const fs::path& file) {
    const auto c = sqlite::Connection::open_read_only(file);
    std::vector<std::string> shape;
    for (const char* sql :
         {"SELECT m.name || '.' || c.name || ' ' || c.type || ' ' || c.\"notnull\" || ' ' || "
          "coalesce(c.dflt_value, '-') || ' ' || c.pk FROM sqlite_schema m, "
          "pragma_table_xinfo(m.name) c WHERE m.type = 'table' ORDER BY m.name, c.cid",
          "SELECT m.name || ' ' || i.name || ' ' || i.\"unique\" FROM sqlite_schema m, "
          "pragma_index_list(m.name) i WHERE m.type = 'table' ORDER BY 1",
          "SELECT m.name || ' ' || f.\"table\" || ' ' || f.on_delete FROM sqlite_schema m, "
          "pragma_foreign_key_list(m.name) f WHERE m.type = 'table' ORDER BY 1"}) {
        auto row = c.prepare(sql);
        while (row.step()) shape.push_back(row.text(0));
    }
    return shape;
}

}  // namespace

TEST_CASE("a database of version 1 is read without changing a byte of it",
          "[materials][migration]") {
    const support::TemporaryFolder folder;
    const fs::path file = version_1_file(folder);
    const std::string bytes = support::read_file(file);
    check_content(file);
    CHECK(Database::layered(file).refractive_index("Old-3").at(420).real() == 1.503);
    CHECK(Database::layered(file).refractive_index("SiO2").at(550).real() > 1.4);
    CHECK(support::read_file(file) == bytes);
    CHECK(version_of(file) == 1);
}

TEST_CASE("the first writer brings a database of version 1 up to date", "[materials][migration]") {
    const support::TemporaryFolder folder;
    const fs::path file = version_1_file(folder);
    { const DatabaseWriter opened(file); }
    CHECK(version_of(file) == database_version);
    check_content(file);

    const fs::path fresh = folder.path() / "fresh.sqlite";
    { const DatabaseWriter opened(fresh); }
    const auto shape = shape_of(file);
    CHECK(shape.size() > 50);
    CHECK(shape == shape_of(fresh));

    DatabaseWriter(file).add(batch("New"), {.imported = "2026-01-02T03:04:05Z"});
    CHECK(Database::open(file).dataset_info("New-1").imported == "2026-01-02T03:04:05Z");
    CHECK(count_of(file, "New") == batch_size);
}

TEST_CASE("many writers and readers find a database of version 1 at once",
          "[materials][migration]") {
    const support::TemporaryFolder folder;
    const fs::path file = version_1_file(folder);
    support::StartingGate gate;
    std::vector<pid_t> children;
    for (int i = 0; i < 16; ++i) {
        children.push_back(in_child([&] {
            gate.wait();
            if (i % 2 == 0) DatabaseWriter(file).add_alias("SiO2", fmt::format("glass {}", i));
            for (int j = 0; j < 5; ++j) {
                if (Database::layered(file).dataset("Old-7").n->y.front() != 1.507) _exit(20);
            }
        }));
    }
    gate.open();
    for (const pid_t child : children) CHECK(exit_code(child) == 0);
    CHECK(version_of(file) == database_version);
    CHECK(Database::layered(file).info("glass 14").name == "SiO2");
}

TEST_CASE("a migration killed at any moment leaves version 1 or the new one",
          "[materials][migration]") {
    const support::TemporaryFolder folder;
    std::mt19937 random(5);
    int old_ones = 0, new_ones = 0;
    for (int i = 0; i < 30; ++i) {
        const support::TemporaryFolder inner;
        const fs::path file = version_1_file(inner);
        const pid_t child = in_child([&] { const DatabaseWriter opened(file); });
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 8000));
        kill(child, SIGKILL);
        exit_code(child);
        const int version = version_of(file);
        CHECK((version == 1 || version == database_version));
        (version == 1 ? old_ones : new_ones)++;
        check_content(file);
        CHECK_NOTHROW(DatabaseWriter(file));
        CHECK(version_of(file) == database_version);
    }
    std::printf("killed migrations: as before %d, as after %d\n", old_ones, new_ones);
}

TEST_CASE("a database of a newer version is refused and left as it is", "[materials][migration]") {
    const support::TemporaryFolder folder;
    const fs::path file = version_1_file(folder);
    const int newer = database_version + 1;
    sqlite::Connection::open_read_write(file).execute(
        fmt::format("CREATE TABLE invention (x); PRAGMA user_version = {}", newer));
    const std::string bytes = support::read_file(file);
    for (const auto& open : std::vector<std::function<void()>>{[&] { Database::open(file); },
                                                               [&] { Database::layered(file); },
                                                               [&] { DatabaseWriter{file}; }}) {
        CHECK_THROWS_WITH(open(), Catch::Contains("old.sqlite") &&
                                      Catch::Contains(fmt::format("version {}", newer)) &&
                                      Catch::Contains(fmt::format("the {}", database_version)));
    }
    CHECK(support::read_file(file) == bytes);
}
