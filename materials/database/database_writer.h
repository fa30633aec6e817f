// Adding, renaming and removing in a materials database file.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "materials/database/sqlite.h"
#include "materials/index/dataset.h"

namespace miebrdf::materials {

enum class AddOutcome { added, unchanged, replaced };

struct AddOptions {
    /// Another dataset of the same label gives way instead of being an error.
    bool replace = false;
    std::string imported{};  ///< when: UTC, ISO 8601; empty: not recorded
};

/// The only way to write. Each call is one transaction: done, or as if it had not been made, even
/// when the process is killed in the middle. Waits up to 30 s for another writer.
class DatabaseWriter {
  public:
    /// Creates the file (and its folder) when missing.
    /// @throws DatabaseError  when it cannot be written or is no database of ours
    explicit DatabaseWriter(const std::filesystem::path& file);
    /// Leaves everything in the one file, when nobody else is using it.
    ~DatabaseWriter();
    DatabaseWriter(const DatabaseWriter&) = delete;
    DatabaseWriter& operator=(const DatabaseWriter&) = delete;

    /// Adds all datasets or none. A dataset that is there already (same material, label and
    /// figures) is left alone, so adding twice changes nothing.
    /// @throws ImportError  when a label is taken by other figures and `replace` is not set
    /// @throws std::invalid_argument  for figures that are not physical
    std::vector<AddOutcome> add(std::span<const Dataset> datasets, const AddOptions& options = {});

    /// Another name for a material, which need not be in this file (the name may be in a layer
    /// below).
    /// @throws ImportError  when the alias already names another material
    void add_alias(const std::string& material, const std::string& alias);
    /// @returns false when there was none
    bool remove_alias(const std::string& alias);

    void set_default(const std::string& material, const std::string& label);
    /// A whole material, or one of its datasets. @returns false when it is not in this file
    bool remove_material(const std::string& material);
    bool remove_dataset(const std::string& material, const std::string& label);

  private:
    std::int64_t material_id(const std::string& name, const Dataset* from);
    AddOutcome add_one(const Dataset& dataset, const AddOptions& options, std::int64_t material);
    void insert(const Dataset& dataset, std::int64_t material, const std::string& imported);
    void insert_series(std::int64_t dataset_id, char quantity, const Series& series, bool own_grid);
    /// @returns false when it was there already
    bool insert_alias(std::int64_t material, const std::string& alias);
    void refresh_text(std::int64_t material);
    void drop_if_empty(std::int64_t material);

    sqlite::Connection connection_;
};

}  // namespace miebrdf::materials
