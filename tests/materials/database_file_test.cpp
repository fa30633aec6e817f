// Files that are no database, damaged, foreign or newer; what a writer does to a good one.
#include <fmt/format.h>
#include <sqlite3.h>

#include <filesystem>
#include <functional>

#include <miebrdf/database.h>
#include "materials/database/schema.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;
using namespace miebrdf::materials;

namespace {

Dataset dataset(const std::string& material, const std::string& label, double n) {
    Dataset d;
    d.material = material;
    d.label = label;
    d.source = "test";
    d.n = make_table(Unit::micrometre, {0.4, 0.5, 0.6, 0.7}, {n, n, n, n});
    d.k = make_table(Unit::micrometre, {0.4, 0.5, 0.6, 0.7}, {0.1, 0.0, 0.0, 0.1});
    return d;
}

std::filesystem::path good_file(const support::TemporaryFolder& folder) {
    const auto file = folder.path() / "good.sqlite";
    DatabaseWriter writer(file);
    std::vector<Dataset> many;
    for (int i = 0; i < 200; ++i)
        many.push_back(dataset(fmt::format("M{}", i), "a", 1.5 + i * 1e-3));
    writer.add(many);
    return file;
}

void run_sql(const std::filesystem::path& file, const std::string& sql) {
    sqlite3* handle = nullptr;
    REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
    REQUIRE(sqlite3_exec(handle, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK);
    sqlite3_close(handle);
}

// Everything a reader could ask; throws DatabaseError when anything is wrong.
void read_all(const std::filesystem::path& file) {
    const Database database = Database::open(file);
    for (const MaterialInfo& material : database.list())
        database.refractive_index(material.name).at(500);
    database.search("test");
    const auto problems = database.integrity_problems();
    if (!problems.empty()) throw DatabaseError(problems.front());
}

}  // namespace

TEST_CASE("what was written comes back", "[materials][writer]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "deep" / "er" / "user.sqlite";
    Dataset d = dataset("MyOxide", "me-2024", 1.7);
    d.title = "My oxide";
    d.aliases = {"house paint"};
    d.doi = "10.1000/1";
    d.ray = "o";
    d.temperature_k = 293.15;
    d.corrections = {"row 3 dropped"};
    DatabaseWriter(file).add(std::vector{d});

    const Dataset back = Database::open(file).dataset("house-paint");
    CHECK(back.material == "MyOxide");
    CHECK(back.title == "My oxide");
    CHECK(back.doi == d.doi);
    CHECK(back.temperature_k == d.temperature_k);
    CHECK(back.corrections == d.corrections);
    CHECK(back.n == d.n);
    CHECK(back.k == d.k);
}

TEST_CASE("adding twice changes nothing, other figures under the same label are refused",
          "[materials][writer]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    DatabaseWriter writer(file);
    const std::vector<Dataset> one{dataset("A", "x", 1.5)};
    CHECK(writer.add(one) == std::vector{AddOutcome::added});
    CHECK(writer.add(one) == std::vector{AddOutcome::unchanged});
    // The second of two fails: the first must not stay.
    const std::vector<Dataset> clash{dataset("B", "x", 1.5), dataset("A", "x", 1.6)};
    CHECK_THROWS_WITH(writer.add(clash),
                      Catch::Contains("A/x") && Catch::Contains("other figures"));
    CHECK(Database::open(file).list().size() == 1);
    CHECK(writer.add(clash, {.replace = true}) ==
          std::vector{AddOutcome::added, AddOutcome::replaced});
    CHECK(Database::open(file).refractive_index("A").at(500).real() == 1.6);
}

TEST_CASE("a user's file lies over the embedded database without changing what names meant",
          "[materials][layers]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    const double before = Database::layered(file).refractive_index("GaP").at(550).real();
    {
        DatabaseWriter writer(file);
        writer.add(std::vector{dataset("GaP", "mine", 9.0), dataset("Kryptonite", "mine", 2.0)});
        writer.add_alias("TiO2", "my white");
    }
    const Database database = Database::layered(file);
    CHECK(database.list().size() == 110);
    CHECK(database.refractive_index("GaP").at(550).real() == before);
    CHECK(database.refractive_index("GaP/mine").at(550).real() == 9.0);
    CHECK(database.datasets("GaP").size() == 2);
    CHECK(database.info("My White").name == "TiO2");
    CHECK(database.info("kryptonite").default_dataset == "mine");

    DatabaseWriter(file).set_default("GaP", "mine");
    CHECK(Database::layered(file).refractive_index("gap").at(550).real() == 9.0);
    CHECK(DatabaseWriter(file).remove_dataset("GaP", "mine"));
    CHECK(Database::layered(file).refractive_index("gap").at(550).real() == before);
    CHECK(DatabaseWriter(file).remove_alias("my white"));
    CHECK(DatabaseWriter(file).remove_material("Kryptonite"));
    CHECK_FALSE(DatabaseWriter(file).remove_material("Kryptonite"));
    CHECK(Database::open(file).list().empty());
}

TEST_CASE("names that differ in case only must be written exactly", "[materials][names]") {
    const support::TemporaryFolder folder;
    const auto file = folder.path() / "user.sqlite";
    DatabaseWriter(file).add(std::vector{dataset("CO", "gas", 1.0003)});
    const Database database = Database::layered(file);
    CHECK(database.info("Co").title == "Cobalt (bulk)");
    CHECK(database.info("CO").name == "CO");
    CHECK(database.info("co").name == "Co");  // as before CO was added
    DatabaseWriter(file).add(std::vector{dataset("Xy", "a", 1.5), dataset("XY", "b", 1.6)});
    CHECK_THROWS_WITH(Database::layered(file).info("xy"), Catch::Contains("XY, Xy"));
}

TEST_CASE("files that are no materials database are refused with the reason",
          "[materials][errors]") {
    const support::TemporaryFolder folder;
    CHECK_THROWS_WITH(Database::open(folder.path() / "missing"), Catch::Contains("no such file"));
    CHECK_THROWS_AS(Database::open(folder.path()), DatabaseError);
    CHECK_THROWS_WITH(Database::open(folder.write("empty", "")), Catch::Contains("is empty"));
    CHECK_THROWS_WITH(Database::open(folder.write("text", std::string(5000, 'x'))),
                      Catch::Contains("is not a materials database"));
    const auto foreign = folder.path() / "foreign";
    run_sql(foreign, "CREATE TABLE t (x); PRAGMA user_version = 1");
    CHECK_THROWS_WITH(Database::open(foreign), Catch::Contains("another program"));
    CHECK_THROWS_WITH(DatabaseWriter(foreign), Catch::Contains("another program"));
}

TEST_CASE("a database of another version is refused and left as it is", "[materials][errors]") {
    const support::TemporaryFolder folder;
    const auto file = good_file(folder);
    const int version = GENERATE(0, 1, kDatabaseVersion + 1, 99);
    run_sql(file, fmt::format("CREATE TABLE invention (x); PRAGMA user_version = {}", version));
    const std::string bytes = support::read_file(file);
    for (const auto& open : std::vector<std::function<void()>>{[&] { Database::open(file); },
                                                               [&] { Database::layered(file); },
                                                               [&] { DatabaseWriter{file}; }}) {
        CHECK_THROWS_WITH(open(), Catch::Contains("good.sqlite") &&
                                      Catch::Contains(fmt::format("version {}", version)) &&
                                      Catch::Contains(fmt::format("the {}", kDatabaseVersion)) &&
                                      Catch::Contains(version > 2 ? "newer" : "older"));
    }
    CHECK(support::read_file(file) == bytes);
}

TEST_CASE("a file cut short anywhere is noticed", "[materials][errors]") {
    const support::TemporaryFolder folder;
    const auto file = good_file(folder);
    CHECK_NOTHROW(read_all(file));
    const std::string whole = support::read_file(file);
    for (std::size_t size = 1; size < whole.size(); size += 1511) {
        const auto cut = folder.write("cut", whole.substr(0, size));
        CAPTURE(size, whole.size());
        CHECK_THROWS_AS(read_all(cut), DatabaseError);
    }
}

TEST_CASE("changed figures do not pass their checksum", "[materials][errors]") {
    const support::TemporaryFolder folder;
    const auto file = good_file(folder);
    run_sql(file, "UPDATE series SET y = zeroblob(32) WHERE quantity = 'k' AND dataset_id = 1");
    CHECK_THROWS_WITH(Database::open(file).refractive_index("M0"), Catch::Contains("checksum"));
    CHECK_NOTHROW(Database::open(file).refractive_index("M1"));
}

TEST_CASE("the constraints of the schema hold", "[materials][schema]") {
    const support::TemporaryFolder folder;
    const auto file = good_file(folder);
    sqlite3* handle = nullptr;
    REQUIRE(sqlite3_open(file.c_str(), &handle) == SQLITE_OK);
    for (const char* sql :
         {"INSERT INTO material (name, key) VALUES ('M0', 'm0')", "UPDATE series SET row_count = 3",
          "UPDATE series SET shortest_nm = 0", "UPDATE series SET unit = 'furlong'",
          "UPDATE dataset SET ray = 'x'", "UPDATE dataset SET content_sha256 = 'abc'",
          "UPDATE dataset SET temperature_k = -1"}) {
        CAPTURE(sql);
        CHECK(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr) == SQLITE_CONSTRAINT);
    }
    sqlite3_close(handle);
}
