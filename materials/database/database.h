// The materials database: names to datasets with their sources, in SQLite.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "materials/errors.h"
#include "materials/index/dataset.h"
#include "materials/index/refractive_index.h"

namespace miebrdf::materials {

/// What is known of one dataset besides its figures.
struct DatasetInfo {
    std::string material;
    std::string label;      ///< "material/label" names it
    std::string layer;      ///< "embedded", or the file it is stored in
    std::string source;     ///< collection it came from, e.g. "SOPRA"
    std::string key;        ///< its name there; "source:key" finds it too
    std::string reference;  ///< publication or file
    std::string doi;
    std::string licence;
    std::string ray;  ///< "o", "e" or empty
    std::string composition;
    std::string note;
    std::string format;
    std::string file;
    std::string file_sha256;
    std::string content_sha256;
    std::string imported;  ///< when: UTC, ISO 8601; empty: not known
    std::optional<double> temperature_k;
    std::vector<std::string> corrections;  ///< what was changed while it was read
    bool n_known = true;
    bool k_known = true;
    int n_formula = 0;  ///< 0: a table
    int rows = 0;       ///< of n's table, or k's when n is unknown; 0 for formulas
    Unit unit = Unit::nanometre;
    double n_shortest_nm = 0.0, n_longest_nm = 0.0;
    double k_shortest_nm = 0.0, k_longest_nm = 0.0;
    /// Where n + ik is known; shortest > longest when n and k do not overlap.
    double shortest_nm = 0.0, longest_nm = 0.0;
};

/// A material, seen through its default dataset.
struct MaterialInfo {
    std::string name;       ///< canonical key, e.g. "AlGaAs_70"
    std::string title;      ///< e.g. "Titanium dioxide (rutile, extraordinary index)"
    std::string formula;    ///< chemical, may be empty
    std::string source;     ///< collection it came from, e.g. "SOPRA"
    std::string reference;  ///< publication or file
    std::string note;
    std::vector<std::string> aliases;
    double shortest_nm = 0.0;
    double longest_nm = 0.0;
    int rows = 0;
    bool k_known = true;
    std::string default_dataset;  ///< label of the dataset described; empty when a material has
                                  ///< aliases only
    int datasets = 0;
};

struct SearchFilter {
    std::string
        text;  ///< words, all of which must occur (as beginnings of words); empty: everything
    std::optional<double> covers_from_nm{}, covers_to_nm{};  ///< some dataset covers all of it
    bool needs_k = false;                                    ///< ... with known k
};

/// Read-only view of the embedded database, of a file, or of a user's file laid over the embedded
/// one. Of two layers the upper one is asked first for names; datasets of both are seen; the
/// default dataset of a material is the one the upper layer chose explicitly, else the lower
/// layer's: adding data never changes what a name meant before.
/// A Database may be used from several threads.
class Database {
  public:
    /// The tables that every build carries inside itself.
    static Database embedded();
    /// @throws DatabaseError  when the file is missing, no database of ours, damaged or newer
    static Database open(const std::filesystem::path& file);
    /// The user's file over the embedded database; a file that does not exist yet is no error.
    static Database layered(const std::filesystem::path& user_file);

    /// Every material of both layers, by name.
    std::vector<MaterialInfo> list() const;
    /// Best match first; every word must occur in name, alias, title, formula or provenance.
    std::vector<MaterialInfo> search(const std::string& text) const;
    std::vector<MaterialInfo> search(const SearchFilter& filter) const;

    /// Finds a material by name, alias or normalised form (case, spaces, '_', '-' ignored). An
    /// exact name comes before an exact alias, before a normalised form that fits one material
    /// only. "material/label" and "source:key" name one dataset.
    /// @throws UnknownMaterial  naming the nearest known names, or all that fit
    MaterialInfo info(const std::string& name) const;
    /// All datasets of a material, the default first.
    std::vector<DatasetInfo> datasets(const std::string& material) const;
    /// Of the dataset that a name stands for, without its figures. @throws UnknownMaterial
    DatasetInfo dataset_info(const std::string& name) const;
    /// With its figures. @throws DatabaseError  when they do not fit their checksum
    Dataset dataset(const std::string& name) const;

    /// @throws UnknownMaterial, DatabaseError; std::invalid_argument when n is unknown, or n and k
    ///         have no wavelength in common
    RefractiveIndex refractive_index(const std::string& name,
                                     const IndexOptions& options = {}) const;

    /// The material whose name or alias is spelled exactly so.
    std::optional<std::string> resolve_exactly(const std::string& name) const;
    /// The canonical names of all materials that the name could mean; one when it is exact.
    std::vector<std::string> resolve(const std::string& name) const;
    /// The same by the normalised form alone, for names whose case means nothing.
    std::vector<std::string> resolve_normalised(const std::string& name) const;

    /// What SQLite itself finds wrong (PRAGMA integrity_check, foreign keys); empty when sound.
    std::vector<std::string> integrity_problems() const;

  private:
    struct Layer;
    explicit Database(std::vector<std::shared_ptr<const Layer>> layers);
    static std::shared_ptr<const Layer> open_layer(const std::filesystem::path& file,
                                                   bool may_be_empty);
    std::vector<DatasetInfo> labelled(const std::string& material, const std::string& label) const;
    std::vector<DatasetInfo> from_source(const std::string& source, const std::string& key) const;
    std::string canonical_name(const std::string& name) const;
    [[noreturn]] void throw_unknown(const std::string& name) const;
    std::vector<std::string> all_names() const;

    std::vector<std::shared_ptr<const Layer>> layers_;  ///< upper first
};

/// Where a user's own materials are kept: $MIEBRDF_DATABASE, else
/// $XDG_DATA_HOME/miebrdf/materials.sqlite, else ~/.local/share/miebrdf/materials.sqlite.
std::filesystem::path default_user_database();

}  // namespace miebrdf::materials
