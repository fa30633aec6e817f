// Files appear whole; tables and text in markup are as they should be.
#include <miebrdf/error.h>
#include <sys/stat.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

#include "pipeline/io/atomic_file.h"
#include "pipeline/io/markup.h"
#include "pipeline/io/table.h"
#include "tests/support/catch.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

using namespace miebrdf;

namespace {

Table sample() {
    Table table;
    table.facts = {{"version", "0"}, {"source", "a"}, {"source", "b\nc"}, {"tolerance", 0.001}};
    table.columns = {"name", "value"};
    table.rows = {{"plain", 0.1}, {"with, comma \"quoted\"", 1e-300}, {Cell(), std::nan("")}};
    return table;
}

}  // namespace

TEST_CASE("a file appears whole on commit and not before", "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    const std::string path = folder / "result.csv";
    {
        AtomicFile file(path);
        file.stream() << "all of it";
        CHECK_FALSE(std::filesystem::exists(path));
        file.commit();
    }
    CHECK(support::read_file(path) == "all of it");
    CHECK(folder.count() == 1);
}

TEST_CASE("without commit the old file stays and no temporary is left", "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    const std::string path = folder.write("result.csv", "old");
    {
        AtomicFile file(path);
        file.stream() << "half of the n";
    }
    CHECK(support::read_file(path) == "old");
    CHECK(folder.count() == 1);
}

TEST_CASE("a symbolic link keeps pointing where it did", "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    const std::string real = folder.write("real.csv", "old");
    std::filesystem::create_symlink(real, folder / "link.csv");
    AtomicFile file(folder / "link.csv");
    file.stream() << "new";
    file.commit();
    CHECK(std::filesystem::is_symlink(folder / "link.csv"));
    CHECK(support::read_file(real) == "new");
}

TEST_CASE("a pipe or device is written directly", "[pipeline][atomic_file]") {
    AtomicFile file("/dev/null");
    file.stream() << "gone";
    file.commit();
    CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("a folder that is not there is named in the error", "[pipeline][atomic_file][errors]") {
    CHECK_THROWS_AS(AtomicFile("/no/such/folder/result.csv"), InputError);
    CHECK_THROWS_WITH(AtomicFile("/no/such/folder/result.csv"),
                      Catch::Contains("/no/such/folder/result.csv"));
    const support::TemporaryFolder folder;
    CHECK_THROWS_WITH(AtomicFile(folder.path()), Catch::Contains("directory"));
}

TEST_CASE("a full disk is an error and leaves nothing", "[pipeline][atomic_file][errors]") {
    // /dev/full fails on every write as a full disk does.
    AtomicFile file("/dev/full");
    file.stream() << std::string(1 << 20, 'x');
    CHECK_THROWS_WITH(file.flush(), Catch::Contains("No space left on device"));
    CHECK_THROWS_WITH(file.commit(), Catch::Contains("No space left on device"));
}

TEST_CASE("an abrupt end can remove what is unfinished, and nothing else",
          "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    AtomicFile done(folder / "done.csv");
    done.commit();
    AtomicFile unfinished(folder / "unfinished.csv");
    CHECK(folder.count() == 2);
    remove_unfinished_files();
    CHECK(folder.count() == 1);
    CHECK(std::filesystem::exists(folder / "done.csv"));
}

TEST_CASE("many threads write the same file and others: each is whole, with a new file's mode",
          "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    const mode_t before = ::umask(027);
    std::vector<std::thread> threads;
    for (int t = 0; t < 8; ++t) {
        threads.emplace_back([&, t] {
            for (int i = 0; i < 50; ++i) {
                AtomicFile common(folder / "common"), own(folder / ("own" + std::to_string(t)));
                common.stream() << std::string(5000, char('a' + t));
                own.stream() << std::string(3000, char('a' + t));
                common.commit();
                if (i % 2 == 1) own.commit();
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(::umask(before) == 027);
    CHECK(folder.count() == 9);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
        const std::string content = support::read_file(entry.path());
        CHECK(content.size() == (entry.path().filename() == "common" ? 5000 : 3000));
        CHECK(content == std::string(content.size(), content[0]));
        CHECK((int(entry.status().permissions()) & 0777) == 0640);
    }
}

TEST_CASE("more files than the list has places: only an abrupt end could leave the rest",
          "[pipeline][atomic_file]") {
    const support::TemporaryFolder folder;
    {
        std::vector<std::unique_ptr<AtomicFile>> files;
        for (int i = 0; i < 100; ++i)
            files.push_back(std::make_unique<AtomicFile>(folder / std::to_string(i)));
        remove_unfinished_files();
        CHECK(folder.count() == 36);
    }
    CHECK(folder.count() == 0);
    AtomicFile again(folder / "again");  // the places are free again
    remove_unfinished_files();
    CHECK(folder.count() == 0);
}

TEST_CASE("an abrupt end in the midst of many threads leaves whole files and no temporary ones",
          "[pipeline][atomic_file]") {
    for (int round = 0; round < 20; ++round) {
        const support::TemporaryFolder folder;
        const pid_t child = support::in_child(
            [&] {
                std::atomic<bool> ends = false;
                std::atomic<int> written = 0;
                std::vector<std::thread> threads;
                for (int t = 0; t < 4; ++t) {
                    threads.emplace_back([&, t] {
                        while (!ends) {
                            AtomicFile file(folder / std::to_string(t));
                            file.stream() << std::string(2000, 'x');
                            if (ends) break;
                            try {
                                file.commit();
                            } catch (const InputError&) {  // its temporary has been removed
                            }
                            ++written;
                        }
                    });
                }
                while (written < 20) std::this_thread::yield();
                // The threads go on, as they do under a handler; only new files must not appear
                // after the last look.
                remove_unfinished_files();
                ends = true;
                for (std::thread& thread : threads) thread.join();
            },
            [](const std::exception&) { return 1; });
        REQUIRE(support::exit_code(child) == 0);
        CHECK(folder.count() <= 4);
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
            CHECK(entry.path().filename().string().size() == 1);
            CHECK(std::filesystem::file_size(entry.path()) == 2000);
        }
    }
}

TEST_CASE("CSV has comments, one header, quoted text and empty fields for what is unknown",
          "[pipeline][table]") {
    std::ostringstream out;
    write_csv(sample(), out);
    CHECK(out.str() ==
          "# version: 0\n# source: a\n# source: b c\n# tolerance: 0.001\nname,value\nplain,0.1\n"
          "\"with, comma \"\"quoted\"\"\",1e-300\n,\n");
}

TEST_CASE("a report stands behind the table in CSV and beside it in JSON", "[pipeline][table]") {
    Table table = sample();
    table.report_columns = {"part", "error"};
    table.report = {{1.0, 0.5}, {2.0, Cell()}};
    std::ostringstream csv, text;
    write_csv(table, csv);
    CHECK(csv.str().starts_with("# version: 0\n"));
    CHECK(csv.str().ends_with("\n,\n# report: part,error\n# report: 1,0.5\n# report: 2,\n"));
    write_json(table, text);
    const auto json = nlohmann::json::parse(text.str());
    CHECK(json["report"][0]["error"] == 0.5);
    CHECK(json["report"][1]["part"] == 2.0);
    CHECK(json["report"][1]["error"].is_null());
}

TEST_CASE("numbers in CSV read back to the same double", "[pipeline][table]") {
    const double value = GENERATE(1.0 / 3.0, 6.02214076e23, 5e-324, -0.1, 123456789.123456789);
    Table table;
    table.columns = {"x"};
    table.rows = {{value}};
    std::ostringstream out;
    write_csv(table, out);
    CHECK(std::strtod(out.str().c_str() + 2, nullptr) == value);
}

TEST_CASE("JSON is valid, keeps repeated facts and has null for what is unknown",
          "[pipeline][table]") {
    std::ostringstream out;
    write_json(sample(), out);
    const auto json = nlohmann::json::parse(out.str());
    CHECK(json["facts"]["source"] == nlohmann::json::array({"a", "b\nc"}));
    CHECK(json["facts"]["tolerance"] == 0.001);
    CHECK(json["columns"] == nlohmann::json::array({"name", "value"}));
    CHECK(json["rows"][0][1] == 0.1);
    CHECK(json["rows"][2][0].is_null());
    CHECK(json["rows"][2][1].is_null());
}

TEST_CASE("rows that are made while they are written are written like stored ones",
          "[pipeline][table]") {
    const auto written = [](const Table& table) {
        std::ostringstream csv, json;
        write_csv(table, csv);
        write_json(table, json);
        return std::pair(csv.str(), json.str());
    };
    const bool has_report = GENERATE(false, true);
    Table stored = sample();
    if (has_report) {
        stored.report_columns = {"part"};
        stored.report = {{1.0}};
    }
    stored.rows.push_back({"last", Cell()});
    Table made = stored;
    made.rows.resize(1);
    made.more_rows = {stored.rows.size() - 1, [&](std::size_t index, std::vector<Cell>& row) {
                          row = stored.rows[index + 1];
                      }};
    CHECK(written(made) == written(stored));
    // As one document would be written with this indentation.
    const std::string json = written(made).second;
    CHECK(nlohmann::ordered_json::parse(json).dump(1) + "\n" == json);
    made.rows.clear();
    made.more_rows = {};
    CHECK(nlohmann::ordered_json::parse(written(made).second)["rows"].empty());
}

TEST_CASE("rows are written as they are made: they are never all in memory", "[pipeline][table]") {
    const bool as_json = GENERATE(false, true);
    constexpr std::size_t count = 100000;
    std::ostringstream out;
    std::ptrdiff_t held_back = 0;
    std::ptrdiff_t made = 0;  // at least, of the text of the rows so far
    Table table;
    table.columns = {"value"};
    table.more_rows = {count, [&](std::size_t index, std::vector<Cell>& row) {
                           held_back = std::max(held_back, made - std::ptrdiff_t(out.tellp()));
                           row = {double(index)};
                           made += 2;
                       }};
    as_json ? write_json(table, out) : write_csv(table, out);
    CHECK(made == 2 * count);
    CHECK(held_back <= 1 << 16);
}

TEST_CASE("text in markup is read back as it was, by an XML parser, in elements and attributes",
          "[pipeline][markup]") {
    const std::string text = "a <b> & \"c\" 'd' &amp; TiO\u2082\n\te";
    const std::string xml = "<t a=\"" + escape_markup(text) + "\" b='" + escape_markup(text) +
                            "'>" + escape_markup(text) + "</t>";
    pugi::xml_document document;
    // As written: XML lets parsers turn line ends and tabs of attributes into blanks.
    REQUIRE(document.load_string(xml.c_str(), pugi::parse_escapes));
    CHECK(document.child("t").child_value() == text);
    CHECK(document.child("t").attribute("a").value() == text);
    CHECK(document.child("t").attribute("b").value() == text);
}

TEST_CASE("control characters, which XML cannot have, are left out", "[pipeline][markup]") {
    CHECK(escape_markup(std::string("a\x01\x1b[31m\0b\r", 10)) == "a[31mb");
}
