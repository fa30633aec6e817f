// Adding, renaming and removing in a database file.
#include <fmt/format.h>

#include <set>

#include <miebrdf/database.h>
#include "materials/database/names.h"
#include "materials/database/schema.h"
#include "materials/database/sqlite.h"
#include "materials/index/checksum.h"
#include "materials/index/series.h"
#include "materials/readers/text.h"

namespace miebrdf::materials {
namespace {

sqlite::Connection open_for_writing(const std::filesystem::path& file) {
    if (file.has_parent_path()) {
        std::error_code error;
        std::filesystem::create_directories(file.parent_path(), error);
        if (error) {
            throw DatabaseError(fmt::format("materials database {}: cannot create its folder: {}",
                                            file.string(), error.message()));
        }
    }
    create_database_file(file);
    sqlite::Connection connection = sqlite::Connection::open_read_write(file);
    // First: this refuses files that are no materials database before anything in them changes.
    create_schema(connection);
    connection.use_write_ahead_log();
    return connection;
}

void check_dataset(const Dataset& dataset) {
    const std::string name = dataset.material + "/" + dataset.label;
    try {
        if (dataset.material.empty() || dataset.label.empty()) {
            throw InputError("a dataset needs the name of its material and a label");
        }
        if (!is_utf8(name)) throw InputError("the names of material and dataset must be UTF-8");
        if (!dataset.n && !dataset.k) throw InputError("neither n nor k");
        const double density = dataset.density_g_cm3.value_or(1.0);
        if (!(density > 0 && density < 100)) {
            throw InputError(fmt::format("density {} g/cm3; allowed: between 0 and 100", density));
        }
        if (dataset.n) check_series(*dataset.n, 'n');
        if (dataset.k) check_series(*dataset.k, 'k');
    } catch (const InputError& error) {
        throw InputError(name + ": " + error.what());
    }
}

std::int64_t material_id(const sqlite::Connection& c, const std::string& name,
                         const Dataset* from) {
    sqlite::Statement find = c.prepare("SELECT id FROM material WHERE name = ?");
    find.bind(name);
    if (find.step()) {
        const std::int64_t id = find.integer(0);
        find.reset();
        if (from == nullptr) return id;
        // Title and formula come from the first dataset that has them, in whatever order they are
        // added.
        c.prepare(
             "UPDATE material SET title = iif(title = '', ?1, title), "
             "formula = iif(formula = '', ?2, formula) WHERE id = ?3 "
             "AND ((title = '' AND ?1 <> '') OR (formula = '' AND ?2 <> ''))")
            .bind(from->title)
            .bind(from->formula)
            .bind(id)
            .run();
        return id;
    }
    c.prepare("INSERT INTO material (name, key, title, formula) VALUES (?, ?, ?, ?)")
        .bind(name)
        .bind(normalised(name))
        .bind(from != nullptr ? from->title : "")
        .bind(from != nullptr ? from->formula : "")
        .run();
    return c.last_insert_rowid();
}

void refresh_text(const sqlite::Connection& c, std::int64_t material) {
    c.prepare("DELETE FROM material_text WHERE rowid = ?").bind(material).run();
    c.prepare(
         "INSERT INTO material_text (rowid, name, aliases, title, formula, provenance) "
         "SELECT id, name, "
         "(SELECT coalesce(group_concat(text, ' ; '), '') FROM alias WHERE material_id = m.id), "
         "title, formula, "
         "(SELECT coalesce(group_concat(label || ' ' || source || ' ' || source_key || ' ' || "
         "reference || ' ' || doi || ' ' || composition || ' ' || note, ' ; '), '') "
         "FROM dataset WHERE material_id = m.id) FROM material m WHERE id = ?")
        .bind(material)
        .run();
}

// Removes a material that has no dataset, alias or default left.
void drop_if_empty(const sqlite::Connection& c, std::int64_t material) {
    c.prepare(
         "DELETE FROM material WHERE id = ? AND default_label IS NULL "
         "AND NOT EXISTS (SELECT 1 FROM dataset WHERE material_id = material.id) "
         "AND NOT EXISTS (SELECT 1 FROM alias WHERE material_id = material.id)")
        .bind(material)
        .run();
    if (c.changes() > 0) {
        c.prepare("DELETE FROM material_text WHERE rowid = ?").bind(material).run();
    }
}

bool insert_alias(const sqlite::Connection& c, std::int64_t material, const std::string& alias) {
    sqlite::Statement taken = c.prepare(
        "SELECT m.id, m.name FROM alias a JOIN material m ON m.id = a.material_id "
        "WHERE a.text = ?");
    taken.bind(alias);
    if (taken.step()) {
        if (taken.integer(0) == material) return false;
        throw ImportError(c.name(), 0,
                          fmt::format("the alias '{}' already names {}", alias, taken.text(1)));
    }
    c.prepare("INSERT INTO alias (text, key, material_id) VALUES (?, ?, ?)")
        .bind(alias)
        .bind(normalised(alias))
        .bind(material)
        .run();
    return true;
}

void insert_series(const sqlite::Connection& c, std::int64_t dataset_id, char quantity,
                   const Series& series, bool own_grid) {
    sqlite::Statement statement = c.prepare(
        "INSERT INTO series (dataset_id, quantity, formula, unit, shortest_nm, longest_nm, "
        "row_count, x, y) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)");
    statement.bind(dataset_id).bind(std::string(1, quantity)).bind(series.formula);
    statement.bind(name_of(series.unit)).bind(series.shortest_nm).bind(series.longest_nm);
    statement.bind(static_cast<std::int64_t>(series.y.size()));
    if (series.tabulated() && own_grid) {
        statement.bind_blob(to_bytes(series.x));
    } else {
        statement.bind_null();
    }
    statement.bind_blob(to_bytes(series.y)).run();
}

void insert(const sqlite::Connection& c, const Dataset& d, std::int64_t material,
            const std::string& imported) {
    sqlite::Statement statement = c.prepare(
        "INSERT INTO dataset (material_id, label, source, source_key, reference, doi, licence, "
        "ray, composition, note, format, file, file_sha256, content_sha256, temperature_k, "
        "density_g_cm3, density_source, imported) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    statement.bind(material).bind(d.label).bind(d.source).bind(d.key).bind(d.reference).bind(d.doi);
    statement.bind(d.licence).bind(d.ray).bind(d.composition).bind(d.note).bind(d.format);
    statement.bind(d.file).bind(d.file_sha256).bind(content_sha256(d)).bind(d.temperature_k);
    statement.bind(d.density_g_cm3).bind(d.density_source).bind(imported).run();
    const std::int64_t id = c.last_insert_rowid();
    if (d.n) insert_series(c, id, 'n', *d.n, true);
    if (d.k) {
        const bool shared = d.n && d.n->tabulated() && d.k->tabulated() && d.n->unit == d.k->unit &&
                            d.n->x == d.k->x;
        insert_series(c, id, 'k', *d.k, !shared);
    }
    for (std::size_t i = 0; i < d.corrections.size(); ++i) {
        c.prepare("INSERT INTO correction (dataset_id, position, text) VALUES (?, ?, ?)")
            .bind(id)
            .bind(static_cast<std::int64_t>(i))
            .bind(d.corrections[i])
            .run();
    }
}

AddOutcome add_one(const sqlite::Connection& c, const Dataset& dataset, const AddOptions& options,
                   std::int64_t material) {
    sqlite::Statement same =
        c.prepare("SELECT id, content_sha256 FROM dataset WHERE material_id = ? AND label = ?");
    same.bind(material).bind(dataset.label);
    if (!same.step()) {
        insert(c, dataset, material, options.imported);
        return AddOutcome::added;
    }
    if (same.text(1) == content_sha256(dataset)) return AddOutcome::unchanged;
    if (!options.replace) {
        throw ImportError(
            dataset.file.empty() ? dataset.material : dataset.file, 0,
            fmt::format("{}/{} is already in {} with other figures; give another label "
                        "or ask to replace it",
                        dataset.material, dataset.label, c.name()));
    }
    c.prepare("DELETE FROM dataset WHERE id = ?").bind(same.integer(0)).run();
    insert(c, dataset, material, options.imported);
    return AddOutcome::replaced;
}

}  // namespace

DatabaseWriter::DatabaseWriter(const std::filesystem::path& file)
    : connection_(std::make_unique<const sqlite::Connection>(open_for_writing(file))) {}

DatabaseWriter::~DatabaseWriter() {
    try {
        connection_->execute("PRAGMA busy_timeout = 100; PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const DatabaseError&) {
        // Somebody else is using the file: the write-ahead log stays beside it, and the next writer
        // merges it.
    }
}

std::vector<AddOutcome> DatabaseWriter::add(std::span<const Dataset> datasets,
                                            const AddOptions& options) {
    for (const Dataset& dataset : datasets) check_dataset(dataset);
    std::vector<AddOutcome> outcomes;
    std::set<std::int64_t> touched;
    sqlite::Transaction transaction(*connection_);
    for (const Dataset& dataset : datasets) {
        const std::int64_t material = material_id(*connection_, dataset.material, &dataset);
        outcomes.push_back(add_one(*connection_, dataset, options, material));
        if (outcomes.back() != AddOutcome::unchanged) touched.insert(material);
        for (const std::string& alias : dataset.aliases) {
            if (insert_alias(*connection_, material, alias)) touched.insert(material);
        }
    }
    if (touched.empty()) return outcomes;  // the file is not written to
    for (const std::int64_t material : touched) refresh_text(*connection_, material);
    transaction.commit();
    return outcomes;
}

void DatabaseWriter::add_alias(const std::string& material, const std::string& alias) {
    sqlite::Transaction transaction(*connection_);
    const std::int64_t id = material_id(*connection_, material, nullptr);
    insert_alias(*connection_, id, alias);
    refresh_text(*connection_, id);
    transaction.commit();
}

bool DatabaseWriter::remove_alias(const std::string& alias) {
    sqlite::Transaction transaction(*connection_);
    sqlite::Statement find = connection_->prepare("SELECT material_id FROM alias WHERE text = ?");
    find.bind(alias);
    if (!find.step()) return false;
    const std::int64_t material = find.integer(0);
    find.reset();
    connection_->prepare("DELETE FROM alias WHERE text = ?").bind(alias).run();
    refresh_text(*connection_, material);
    drop_if_empty(*connection_, material);
    transaction.commit();
    return true;
}

void DatabaseWriter::set_default(const std::string& material, const std::string& label) {
    sqlite::Transaction transaction(*connection_);
    const std::int64_t id = material_id(*connection_, material, nullptr);
    connection_->prepare("UPDATE material SET default_label = ? WHERE id = ?")
        .bind(label)
        .bind(id)
        .run();
    refresh_text(*connection_, id);
    transaction.commit();
}

bool DatabaseWriter::remove_material(const std::string& material) {
    sqlite::Transaction transaction(*connection_);
    connection_
        ->prepare(
            "DELETE FROM material_text WHERE rowid IN (SELECT id FROM material WHERE name = ?)")
        .bind(material)
        .run();
    connection_->prepare("DELETE FROM material WHERE name = ?").bind(material).run();
    const bool removed = connection_->changes() > 0;
    transaction.commit();
    return removed;
}

bool DatabaseWriter::remove_dataset(const std::string& material, const std::string& label) {
    sqlite::Transaction transaction(*connection_);
    sqlite::Statement find = connection_->prepare(
        "SELECT d.id, m.id FROM dataset d JOIN material m ON m.id = d.material_id "
        "WHERE m.name = ? AND d.label = ?");
    find.bind(material).bind(label);
    if (!find.step()) return false;
    const std::int64_t dataset = find.integer(0);
    const std::int64_t owner = find.integer(1);
    find.reset();
    connection_->prepare("DELETE FROM dataset WHERE id = ?").bind(dataset).run();
    connection_
        ->prepare("UPDATE material SET default_label = NULL WHERE id = ? AND default_label = ?")
        .bind(owner)
        .bind(label)
        .run();
    refresh_text(*connection_, owner);
    drop_if_empty(*connection_, owner);
    transaction.commit();
    return true;
}

}  // namespace miebrdf::materials
