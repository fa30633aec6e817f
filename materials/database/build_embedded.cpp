// Build-time program: materials/data -> the SQLite file that the library carries inside itself.
// Usage: build_embedded DATA_FOLDER OUTPUT
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <miebrdf/database.h>
#include "materials/database/sqlite.h"
#include "materials/index/checksum.h"
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
        throw std::runtime_error(fmt::format("'{}' in {} is no number", row.at(column), column));
    return *value;
}

void read_figures(Dataset& dataset, const std::filesystem::path& file, bool k_known) {
    std::vector<double> wavelength_um, n, k;
    for (const Row& row : read_rows(file)) {
        wavelength_um.push_back(number(row, "wavelength_um"));
        n.push_back(number(row, "n"));
        k.push_back(number(row, "k"));
    }
    dataset.n = make_table(Unit::micrometre, wavelength_um, n);
    if (k_known) dataset.k = make_table(Unit::micrometre, wavelength_um, k);
    dataset.file = file.filename().string();
    dataset.file_sha256 = sha256_hex(read_text(file));
}

// "SOPRA n&k database, GAP.NK; agrees ..." -> "GAP": the name in that collection.
std::string sopra_key(const std::string& reference) {
    const auto end = reference.find(".NK");
    if (end == std::string::npos) return "";
    const auto start = reference.rfind(' ', end);
    return reference.substr(start + 1, end - start - 1);
}

Dataset read_dataset(const Row& row, const std::filesystem::path& folder) {
    Dataset dataset;
    dataset.material = row.at("name");
    dataset.title = row.at("title");
    dataset.label = "visible";
    dataset.source = row.at("origin").starts_with("SOPRA") ? "SOPRA" : "refractiveindex.info";
    dataset.licence = dataset.source == "SOPRA" ? "" : "CC0-1.0";
    dataset.reference = row.at("reference");
    dataset.key = dataset.source == "SOPRA" ? sopra_key(dataset.reference) : "";
    dataset.format = "csv";
    dataset.note = row.at("note");
    // The collection of refractiveindex.info says where nobody gave k; SOPRA writes 0 for it, which
    // is kept as it stands, with its note.
    const bool k_known = dataset.note.find("no k") == std::string::npos;
    read_figures(dataset, folder / "visible" / (dataset.material + ".csv"), k_known);
    return dataset;
}

Dataset& find(std::vector<Dataset>& datasets, const std::string& material) {
    for (Dataset& dataset : datasets) {
        if (dataset.material == material) return dataset;
    }
    throw std::runtime_error(fmt::format("a table speaks of the unknown material {}", material));
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
    // An image is opened without files beside it, so no write-ahead log; and as small as it gets.
    const auto connection = sqlite::Connection::open_read_write(output);
    connection.execute("PRAGMA journal_mode = DELETE; VACUUM");
}

}  // namespace

// The library calls it, but there is none yet.
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
