// Build-time program: materials/data -> the SQLite file that the library carries inside itself.
// Usage: build_embedded DATA_FOLDER OUTPUT
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <miebrdf/database.h>
#include "materials/database/names.h"
#include "materials/database/sqlite.h"
#include "materials/index/units.h"
#include "materials/readers/text.h"

namespace {

using namespace miebrdf::materials;
using Row = std::map<std::string, std::string>;

std::string read_text(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw std::runtime_error(fmt::format("cannot read {}", file.string()));
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<Row> read_rows(const std::filesystem::path& file) {
    const std::string text = read_text(file);
    std::vector<Row> rows;
    std::vector<std::string> header;
    for (const std::string_view line : split_lines(text)) {
        if (without_blanks(line).empty() || line[0] == '#') continue;
        const std::vector<std::string> fields = split_fields(line);
        if (header.empty()) {
            header = fields;
            continue;
        }
        if (fields.size() != header.size()) {
            throw std::runtime_error(fmt::format("{}: {} fields, {} columns: {}", file.string(),
                                                 fields.size(), header.size(), line));
        }
        Row& row = rows.emplace_back();
        for (std::size_t i = 0; i < header.size(); ++i) row[header[i]] = fields[i];
    }
    return rows;
}

double number(const Row& row, const std::string& column) {
    const auto value = parse_number(row.at(column));
    if (!value)
        throw std::runtime_error(fmt::format("'{}' in {} is not a number", row.at(column), column));
    return *value;
}

// The source's own file, read as an import would read it: what the file says of its origin stays,
// and the same file from the collection has the same checksum.
Dataset read_dataset(const Row& row, const std::filesystem::path& folder) {
    Dataset dataset = read_file(folder / row.at("file"));
    dataset.material = row.at("name");
    dataset.title = row.at("title");
    dataset.label = row.at("label");
    dataset.source = row.at("source");
    dataset.key = row.at("key");
    if (!row.at("reference").empty()) dataset.reference = row.at("reference");
    if (!row.at("note").empty()) {
        dataset.note += (dataset.note.empty() ? "" : "; ") + row.at("note");
    }
    return dataset;
}

Dataset& find(std::vector<Dataset>& datasets, const std::string& material) {
    for (Dataset& dataset : datasets) {
        if (dataset.material == material) return dataset;
    }
    throw std::runtime_error(fmt::format("a table names the unknown material {}", material));
}

void add_collections(const std::filesystem::path& output, const std::vector<Row>& rows) {
    const auto connection = sqlite::Connection::open_read_write(output);
    sqlite::Transaction transaction(connection);
    for (const Row& row : rows) {
        connection.prepare("INSERT INTO collection (source, key, material) VALUES (?, ?, ?)")
            .bind(row.at("source"))
            .bind(row.at("key"))
            .bind(row.at("material"))
            .run();
    }
    transaction.commit();
}

/// Materials without a dataset: their titles say what there is instead.
void add_missing(const std::filesystem::path& output, const std::vector<Row>& rows) {
    const auto connection = sqlite::Connection::open_read_write(output);
    for (const Row& row : rows) {
        connection.prepare("INSERT INTO material (name, key, title) VALUES (?, ?, ?)")
            .bind(row.at("name"))
            .bind(normalised(row.at("name")))
            .bind(row.at("title"))
            .run();
    }
    DatabaseWriter writer(output);
    for (const Row& row : rows) {
        std::istringstream aliases(row.at("aliases"));
        for (std::string alias; std::getline(aliases, alias, ';');)
            writer.add_alias(row.at("name"), alias);
    }
}

void build(const std::filesystem::path& folder, const std::filesystem::path& output) {
    std::vector<Dataset> datasets;
    for (const Row& row : read_rows(folder / "index.csv"))
        datasets.push_back(read_dataset(row, folder));
    for (const Row& row : read_rows(folder / "aliases.csv")) {
        find(datasets, row.at("name")).aliases.push_back(row.at("alias"));
    }
    for (const Row& row : read_rows(folder / "densities.csv")) {
        Dataset& dataset = find(datasets, row.at("name"));
        dataset.density_g_cm3 = number(row, "density_g_cm3");
        dataset.density_source = row.at("source");
    }
    for (const Row& row : read_rows(folder / "formulas.csv")) {
        find(datasets, row.at("name")).formula = row.at("formula");
    }
    std::filesystem::remove(output);
    DatabaseWriter(output).add(datasets);
    add_missing(output, read_rows(folder / "missing.csv"));
    add_collections(output, read_rows(folder / "collections.csv"));
    // The embedded file is opened from memory, so it must not need a write-ahead log; VACUUM makes
    // it as small as possible.
    const auto connection = sqlite::Connection::open_read_write(output);
    connection.execute("PRAGMA journal_mode = DELETE; VACUUM");
}

}  // namespace

// The objects of the library refer to the embedded database, which this program is about to make.
miebrdf::materials::Database miebrdf::materials::Database::embedded() {
    throw std::logic_error("there is no embedded database yet");
}

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: build_embedded DATA_FOLDER OUTPUT\n");
        return 2;
    }
    try {
        build(argv[1], argv[2]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "build_embedded: {}\n", error.what());
        return 1;
    }
    return 0;
}
