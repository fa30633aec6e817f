// One database file (or the embedded one) as a layer of the Database; internal.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <miebrdf/database.h>
#include "materials/database/sqlite.h"

namespace miebrdf::materials {

/// A material as one layer knows it.
struct LayerMaterial {
    std::int64_t id = 0;
    std::string name, title, formula, default_label;
};

struct Database::Layer {
    std::string name;  ///< "embedded" or the file
    sqlite::Connection connection;

    std::optional<LayerMaterial> material(const std::string& name) const;
    std::vector<LayerMaterial> materials() const;
    std::vector<std::string> aliases(std::int64_t material_id) const;
    /// Pairs (spelling, material) of all names and aliases with this normalised form.
    std::vector<std::pair<std::string, std::string>> spellings(const std::string& key) const;
    std::vector<std::pair<std::string, std::string>> all_spellings() const;
    /// In the order they were added.
    std::vector<std::pair<std::int64_t, DatasetInfo>> datasets(std::int64_t material_id) const;
    std::vector<std::string> materials_with_key(const std::string& key) const;
    /// An entry of the table that says which material an entry of a collection belongs to.
    std::optional<std::string> collected(const std::string& source, const std::string& key) const;
    std::vector<std::string> full_text(const std::string& query) const;
    bool indexed(std::int64_t material_id, const std::string& query) const;
    std::optional<Series> series(std::int64_t dataset_id, char quantity) const;
};

/// Describes a dataset that no layer holds (a mixture).
DatasetInfo describe_unstored(const Dataset& dataset);

}  // namespace miebrdf::materials
