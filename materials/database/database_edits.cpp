// What changes in a database file that holds its datasets already: names, defaults, removals.
#include "materials/database/database_writer.h"

namespace miebrdf::materials {

void DatabaseWriter::add_alias(const std::string& material, const std::string& alias) {
    sqlite::Transaction transaction(connection_);
    const std::int64_t id = material_id(material, nullptr);
    insert_alias(id, alias);
    refresh_text(id);
    transaction.commit();
}

bool DatabaseWriter::remove_alias(const std::string& alias) {
    sqlite::Transaction transaction(connection_);
    sqlite::Statement find = connection_.prepare("SELECT material_id FROM alias WHERE text = ?");
    find.bind(alias);
    if (!find.step()) return false;
    const std::int64_t material = find.integer(0);
    find.reset();
    connection_.prepare("DELETE FROM alias WHERE text = ?").bind(alias).run();
    refresh_text(material);
    drop_if_empty(material);
    transaction.commit();
    return true;
}

void DatabaseWriter::set_default(const std::string& material, const std::string& label) {
    sqlite::Transaction transaction(connection_);
    const std::int64_t id = material_id(material, nullptr);
    connection_.prepare("UPDATE material SET default_label = ? WHERE id = ?")
        .bind(label)
        .bind(id)
        .run();
    refresh_text(id);
    transaction.commit();
}

bool DatabaseWriter::remove_material(const std::string& material) {
    sqlite::Transaction transaction(connection_);
    connection_
        .prepare(
            "DELETE FROM material_text WHERE rowid IN (SELECT id FROM material WHERE name = ?)")
        .bind(material)
        .run();
    connection_.prepare("DELETE FROM material WHERE name = ?").bind(material).run();
    const bool removed = connection_.changes() > 0;
    transaction.commit();
    return removed;
}

bool DatabaseWriter::remove_dataset(const std::string& material, const std::string& label) {
    sqlite::Transaction transaction(connection_);
    sqlite::Statement find = connection_.prepare(
        "SELECT d.id, m.id FROM dataset d JOIN material m ON m.id = d.material_id "
        "WHERE m.name = ? AND d.label = ?");
    find.bind(material).bind(label);
    if (!find.step()) return false;
    const std::int64_t dataset = find.integer(0);
    const std::int64_t owner = find.integer(1);
    find.reset();
    connection_.prepare("DELETE FROM dataset WHERE id = ?").bind(dataset).run();
    connection_
        .prepare("UPDATE material SET default_label = NULL WHERE id = ? AND default_label = ?")
        .bind(owner)
        .bind(label)
        .run();
    refresh_text(owner);
    drop_if_empty(owner);
    transaction.commit();
    return true;
}

// A material that says nothing any more (no dataset, alias or default) goes.
void DatabaseWriter::drop_if_empty(std::int64_t material) {
    connection_
        .prepare(
            "DELETE FROM material WHERE id = ? AND default_label IS NULL "
            "AND NOT EXISTS (SELECT 1 FROM dataset WHERE material_id = material.id) "
            "AND NOT EXISTS (SELECT 1 FROM alias WHERE material_id = material.id)")
        .bind(material)
        .run();
    if (connection_.changes() > 0) {
        connection_.prepare("DELETE FROM material_text WHERE rowid = ?").bind(material).run();
    }
}

}  // namespace miebrdf::materials
