// The materials database: names to datasets with their sources, in SQLite.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "materials/refractive_index.h"

namespace miebrdf::materials {

/// What is known of a dataset besides its figures.
struct MaterialInfo {
    std::string name;   ///< canonical key, e.g. "AlGaAs_70"
    std::string title;  ///< e.g. "Titanium dioxide (rutile, extraordinary index)"
    std::string source;     ///< collection it came from, e.g. "SOPRA"
    std::string reference;  ///< publication or file
    std::string note;
    std::vector<std::string> aliases;
    double shortest_nm = 0.0;
    double longest_nm = 0.0;
    int rows = 0;
    bool k_known = true;
};

/// Read-only view of the embedded database, or of a file.
/// @throws DatabaseError (from std::runtime_error) when the file is no database of ours, damaged
///         or of a newer version
class Database {
  public:
    /// The tables that every build carries inside itself.
    static Database embedded();
    static Database open(const std::filesystem::path& file);

    std::vector<MaterialInfo> list() const;
    std::vector<MaterialInfo> search(const std::string& text) const;

    /// Finds a material by name, alias or normalised form (case, spaces, '_', '-' ignored).
    /// @throws UnknownMaterial  naming the nearest known names
    MaterialInfo info(const std::string& name) const;
    RefractiveIndex refractive_index(const std::string& name) const;
    // ...
};

}  // namespace miebrdf::materials
