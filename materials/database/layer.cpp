#include "materials/database/layer.h"

#include <fmt/format.h>

#include <algorithm>

#include "materials/index/checksum.h"
#include "materials/index/units.h"

namespace miebrdf::materials {
namespace {

LayerMaterial read_material(const sqlite::Statement& row) {
    return {row.integer(0), row.text(1), row.text(2), row.text(3), row.text(4)};
}

std::vector<std::pair<std::string, std::string>> pairs(sqlite::Statement& statement) {
    std::vector<std::pair<std::string, std::string>> found;
    while (statement.step()) found.emplace_back(statement.text(0), statement.text(1));
    return found;
}

std::vector<std::string> texts(sqlite::Statement& statement) {
    std::vector<std::string> found;
    while (statement.step()) found.push_back(statement.text(0));
    return found;
}

Unit stored_unit(const std::string& text) {
    const std::optional<Unit> unit = parse_unit(text);
    if (!unit) throw DatabaseError(fmt::format("materials database: unknown unit '{}'", text));
    return *unit;
}

void read_series_info(DatasetInfo& info, const sqlite::Statement& row) {
    // Columns 15-19: n's formula, unit, range, rows; 20-24: the same of k. 25: when imported, 26:
    // density, 27: its source.
    info.n_known = !row.is_null(15);
    info.k_known = !row.is_null(20);
    if (info.n_known) {
        info.n_formula = static_cast<int>(row.integer(15));
        info.unit = stored_unit(row.text(16));
        info.n_shortest_nm = info.shortest_nm = row.number(17);
        info.n_longest_nm = info.longest_nm = row.number(18);
        info.rows = info.n_formula == 0 ? static_cast<int>(row.integer(19)) : 0;
    }
    if (!info.k_known) return;
    info.k_shortest_nm = row.number(22);
    info.k_longest_nm = row.number(23);
    if (info.n_known) {
        info.shortest_nm = std::max(info.shortest_nm, info.k_shortest_nm);
        info.longest_nm = std::min(info.longest_nm, info.k_longest_nm);
    } else {
        info.unit = stored_unit(row.text(21));
        info.rows = static_cast<int>(row.integer(24));
        info.shortest_nm = info.k_shortest_nm;
        info.longest_nm = info.k_longest_nm;
    }
}

DatasetInfo read_dataset(const sqlite::Statement& row) {
    DatasetInfo info;
    info.label = row.text(1);
    info.source = row.text(2);
    info.key = row.text(3);
    info.reference = row.text(4);
    info.doi = row.text(5);
    info.licence = row.text(6);
    info.ray = row.text(7);
    info.composition = row.text(8);
    info.note = row.text(9);
    info.format = row.text(10);
    info.file = row.text(11);
    info.file_sha256 = row.text(12);
    info.content_sha256 = row.text(13);
    if (!row.is_null(14)) info.temperature_k = row.number(14);
    read_series_info(info, row);
    info.imported = row.text(25);
    if (!row.is_null(26)) info.density_g_cm3 = row.number(26);
    info.density_source = row.text(27);
    return info;
}

}  // namespace

std::optional<LayerMaterial> Database::Layer::material(const std::string& asked) const {
    sqlite::Statement row = connection.prepare(
        "SELECT id, name, title, formula, default_label FROM material WHERE name = ?");
    row.bind(asked);
    if (!row.step()) return std::nullopt;
    return read_material(row);
}

std::vector<LayerMaterial> Database::Layer::materials() const {
    sqlite::Statement row = connection.prepare(
        "SELECT id, name, title, formula, default_label FROM material ORDER BY name");
    std::vector<LayerMaterial> found;
    while (row.step()) found.push_back(read_material(row));
    return found;
}

std::vector<std::string> Database::Layer::aliases(std::int64_t material_id) const {
    sqlite::Statement row =
        connection.prepare("SELECT text FROM alias WHERE material_id = ? ORDER BY text");
    return texts(row.bind(material_id));
}

std::vector<std::pair<std::string, std::string>> Database::Layer::spellings(
    const std::string& key) const {
    sqlite::Statement row = connection.prepare(
        "SELECT name, name FROM material WHERE key = ?1 UNION "
        "SELECT a.text, m.name FROM alias a JOIN material m ON m.id = a.material_id WHERE a.key = "
        "?1");
    row.bind(key);
    return pairs(row);
}

std::vector<std::pair<std::string, std::string>> Database::Layer::all_spellings() const {
    sqlite::Statement row = connection.prepare(
        "SELECT name, name FROM material UNION "
        "SELECT a.text, m.name FROM alias a JOIN material m ON m.id = a.material_id");
    return pairs(row);
}

std::vector<std::pair<std::int64_t, DatasetInfo>> Database::Layer::datasets(
    std::int64_t material_id) const {
    sqlite::Statement row = connection.prepare(
        "SELECT d.id, d.label, d.source, d.source_key, d.reference, d.doi, d.licence, d.ray, "
        "d.composition, d.note, d.format, d.file, d.file_sha256, d.content_sha256, "
        "d.temperature_k, "
        "n.formula, n.unit, n.shortest_nm, n.longest_nm, n.row_count, "
        "k.formula, k.unit, k.shortest_nm, k.longest_nm, k.row_count, d.imported, "
        "d.density_g_cm3, d.density_source "
        "FROM dataset d LEFT JOIN series n ON n.dataset_id = d.id AND n.quantity = 'n' "
        "LEFT JOIN series k ON k.dataset_id = d.id AND k.quantity = 'k' "
        "WHERE d.material_id = ? ORDER BY d.id");
    row.bind(material_id);
    sqlite::Statement corrected =
        connection.prepare("SELECT text FROM correction WHERE dataset_id = ? ORDER BY position");
    std::vector<std::pair<std::int64_t, DatasetInfo>> found;
    while (row.step()) {
        DatasetInfo info = read_dataset(row);
        info.layer = name;
        corrected.bind(row.integer(0));
        while (corrected.step()) info.corrections.push_back(corrected.text(0));
        corrected.reset();
        found.emplace_back(row.integer(0), std::move(info));
    }
    return found;
}

std::vector<std::string> Database::Layer::materials_with_key(const std::string& key) const {
    sqlite::Statement row = connection.prepare(
        "SELECT DISTINCT m.name FROM dataset d JOIN material m ON m.id = d.material_id "
        "WHERE d.source_key = ? COLLATE NOCASE");
    return texts(row.bind(key));
}

std::optional<std::string> Database::Layer::collected(const std::string& source,
                                                      const std::string& key) const {
    sqlite::Statement row =
        connection.prepare("SELECT material FROM collection WHERE source = ? AND key = ?");
    row.bind(source).bind(key);
    if (!row.step()) return std::nullopt;
    return row.text(0);
}

std::vector<std::string> Database::Layer::full_text(const std::string& query) const {
    // Weights of name, aliases, title, formula, provenance: a hit in the name counts most.
    sqlite::Statement row = connection.prepare(
        "SELECT m.name FROM material_text t JOIN material m ON m.id = t.rowid "
        "WHERE material_text MATCH ? ORDER BY bm25(material_text, 20, 10, 5, 10, 1), m.name");
    return texts(row.bind(query));
}

bool Database::Layer::indexed(std::int64_t material_id, const std::string& query) const {
    sqlite::Statement row =
        connection.prepare("SELECT 1 FROM material_text WHERE material_text MATCH ? AND rowid = ?");
    return row.bind(query).bind(material_id).step();
}

std::optional<Series> Database::Layer::series(std::int64_t dataset_id, char quantity) const {
    sqlite::Statement row = connection.prepare(
        "SELECT s.formula, s.unit, s.shortest_nm, s.longest_nm, coalesce(s.x, n.x), s.y FROM "
        "series s "
        "LEFT JOIN series n ON n.dataset_id = s.dataset_id AND n.quantity = 'n' AND s.formula = 0 "
        "WHERE s.dataset_id = ? AND s.quantity = ?");
    row.bind(dataset_id).bind(std::string(1, quantity));
    if (!row.step()) return std::nullopt;
    Series series;
    series.formula = static_cast<int>(row.integer(0));
    series.unit = stored_unit(row.text(1));
    series.shortest_nm = row.number(2);
    series.longest_nm = row.number(3);
    const std::string x = row.blob(4);
    const std::string y = row.blob(5);
    series.x = from_bytes(x.data(), x.size());
    series.y = from_bytes(y.data(), y.size());
    return series;
}

DatasetInfo describe_unstored(const Dataset& d) {
    DatasetInfo info;
    static_cast<DatasetOrigin&>(info) = d;
    info.layer = "nowhere: computed";
    info.content_sha256 = content_sha256(d);
    info.k_known = d.k.has_value();
    info.rows = static_cast<int>(d.n->x.size());
    info.n_shortest_nm = info.shortest_nm = d.n->shortest_nm;
    info.n_longest_nm = info.longest_nm = d.n->longest_nm;
    if (d.k) {
        info.k_shortest_nm = d.k->shortest_nm;
        info.k_longest_nm = d.k->longest_nm;
    }
    return info;
}

}  // namespace miebrdf::materials
