// The materials database: names to optical constants with their sources, in SQLite, and the files
// that they come from.
#pragma once

#include <miebrdf/error.h>
#include <miebrdf/index.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf::materials {

namespace sqlite {
class Connection;
}

/// The file is no database of ours, damaged, of another version, locked, or cannot be written.
class DatabaseError : public InputError {
    using InputError::InputError;
};

/// The file's bytes are no database, or no longer a whole one: trying again cannot help.
class DamagedDatabase : public DatabaseError {
    using DatabaseError::DatabaseError;
};

/// No material has the name, or several do; `candidates` are the names that would have been known.
class UnknownMaterial : public InputError {
  public:
    UnknownMaterial(const std::string& message, std::string asked,
                    std::vector<std::string> candidate_names)
        : InputError(message), name(std::move(asked)), candidates(std::move(candidate_names)) {}

    std::string name;                     ///< as it was asked for
    std::vector<std::string> candidates;  ///< nearest first; may be empty
};

/// A file of optical constants that cannot be read or accepted.
class ImportError : public InputError {
  public:
    /// @param line  counted from 1; 0 when the reason concerns the whole file
    ImportError(const std::string& file, int line, const std::string& reason)
        : InputError(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + reason),
          line_(line),
          reason_(reason) {}

    int line() const { return line_; }                     ///< counted from 1; 0: the whole file
    const std::string& reason() const { return reason_; }  ///< without file and line

  private:
    int line_;
    std::string reason_;
};

/// All that is known of one dataset besides its figures.
struct DatasetInfo : DatasetOrigin {
    std::string layer;            ///< "embedded", or the file it is stored in
    std::string content_sha256;   ///< of its figures
    std::string imported;         ///< when: UTC, ISO 8601; empty: not known
    bool n_known = true;          ///< false: the source gives k only
    bool k_known = true;          ///< false: k was not measured
    int n_formula = 0;            ///< 0: a table
    int rows = 0;                 ///< of n's table, or k's when n is unknown; 0 for formulas
    Unit unit = Unit::nanometre;  ///< of the stored table
    double n_shortest_nm = 0.0, n_longest_nm = 0.0;  ///< where n is known
    double k_shortest_nm = 0.0, k_longest_nm = 0.0;  ///< where k is known
    /// Where n + ik is known; shortest > longest when n and k do not overlap.
    double shortest_nm = 0.0, longest_nm = 0.0;  ///< vacuum
};

/// A material, seen through its default dataset.
struct MaterialInfo {
    std::string name;                  ///< canonical key, e.g. "AlGaAs_70"
    std::string title;                 ///< e.g. "Titanium dioxide (rutile, extraordinary index)"
    std::string formula;               ///< chemical, may be empty
    std::string source;                ///< collection it came from, e.g. "SOPRA"
    std::string reference;             ///< publication or file
    std::string note;                  ///< from the source; may be empty
    std::vector<std::string> aliases;  ///< other names
    double shortest_nm = 0.0;          ///< vacuum; of the dataset described
    double longest_nm = 0.0;           ///< as shortest_nm
    int rows = 0;                      ///< of its table; 0: a formula
    bool k_known = true;               ///< false: k was not measured
    std::string default_dataset;  ///< label of the dataset described; empty when a material has
                                  ///< aliases only
    int datasets = 0;             ///< how many there are
    /// The density of the dataset described, else that of the first of the material's that has one:
    /// a density belongs to the substance more than to its table.
    std::optional<double> density_g_cm3;
    std::string density_source;  ///< where the density is from
};

/// A word that names no material of the database, such as snow or milk.
struct CommonWord {
    std::string word = {};
    std::vector<std::string> materials = {};  ///< of the embedded database, that stand for it
    std::string meaning = {};  ///< why they do and in which words of a medium, or what is lacking
};
/// Nothing for other words.
std::optional<CommonWord> common_word(const std::string& text);

/// Conditions on a material; all conditions hold together.
struct SearchFilter {
    std::string
        text;  ///< words, all of which must occur (as beginnings of words); empty: everything
    std::optional<double> covers_from_nm{}, covers_to_nm{};  ///< some dataset covers all of it
    bool needs_k = false;                                    ///< ... with known k
};

/// Whether a dataset covers what the filter asks for; its text is not looked at.
bool fits(const DatasetInfo& dataset, const SearchFilter& filter);

/// Read-only view of the embedded database, of a file, or of a user's file laid over the embedded
/// one. Adding data never changes what a name meant before: of two layers the lower one is asked
/// first for names and keys, datasets of both are seen, and the default dataset of a material is
/// the one the upper layer chose explicitly, else the lower layer's.
/// A Database may be used from several threads.
class Database {
  public:
    /// The tables that every build carries inside itself.
    static Database embedded();
    /// @throws DatabaseError  when the file is missing, no database of ours, damaged or of another
    ///         version
    static Database open(const std::filesystem::path& file);
    /// The user's file over the embedded database; a file that does not exist yet is no error.
    static Database layered(const std::filesystem::path& user_file);

    /// Every material of both layers, by name.
    std::vector<MaterialInfo> list() const;
    /// Best match first; every word must occur in name, alias, title, formula or provenance.
    std::vector<MaterialInfo> search(const std::string& text) const;
    /// Materials that fit a filter.
    std::vector<MaterialInfo> search(const SearchFilter& filter) const;

    /// Finds a material by name, alias or normalised form (case, spaces, '_', '-' ignored). An
    /// exact name comes before an exact alias, before a normalised form that fits one material
    /// only. A mixture is a material too: "bruggeman(TiO2:30%,SiO2)", and likewise maxwell-garnett
    /// (the host comes last), looyenga, volume and average; average(o,e) of the ordinary and
    /// extraordinary ray of a crystal is that of its powder, (2 o + e) / 3. So are models
    /// (drude(...), lorentz(...), tauc-lorentz(...), cody-lorentz(...), oscillators(...)), formulas
    /// (formula(n=...,k=...)) and temperature(NAME,350K), between two datasets of one material.
    /// "material/label", "source:key" and the address of a page of refractiveindex.info name
    /// one dataset.
    /// @throws UnknownMaterial  naming the nearest known names, or all that fit
    MaterialInfo info(const std::string& name) const;
    /// All datasets of a material, the default first.
    std::vector<DatasetInfo> datasets(const std::string& material) const;
    /// Describes the dataset that a name stands for, without its figures. @throws UnknownMaterial
    DatasetInfo dataset_info(const std::string& name) const;
    /// With its figures. @throws DatabaseError  when they do not fit their checksum
    Dataset dataset(const std::string& name) const;

    /// @throws UnknownMaterial, DatabaseError; InputError when n is unknown, or n and k have no
    ///         wavelength in common
    RefractiveIndex refractive_index(const std::string& name,
                                     const IndexOptions& options = {}) const;

    /// The material whose name or alias is spelled exactly so.
    std::optional<std::string> resolve_exactly(const std::string& name) const;
    /// The canonical names of all materials that the name could mean; one when it is exact.
    std::vector<std::string> resolve(const std::string& name) const;
    /// As resolve(), by the normalised form alone, for names whose case means nothing.
    std::vector<std::string> resolve_normalised(const std::string& name) const;

    /// The material to which the embedded table says that an entry of a collection belongs.
    std::optional<std::string> collected_material(const std::string& source,
                                                  const std::string& key) const;

    /// Lists the faults that SQLite itself finds (PRAGMA integrity_check, foreign keys) and
    /// materials that the search index does not find; empty when sound.
    std::vector<std::string> integrity_problems() const;

  private:
    struct Layer;
    explicit Database(std::vector<std::shared_ptr<const Layer>> layers);
    static std::shared_ptr<const Layer> open_layer(const std::filesystem::path& file,
                                                   bool may_be_empty);
    std::vector<DatasetInfo> labelled(const std::string& material, const std::string& label) const;
    std::vector<DatasetInfo> from_source(const std::string& source, const std::string& key) const;
    /// The dataset of a mixing rule; nothing when the name is none.
    std::optional<Dataset> mixture(const std::string& name) const;
    /// A material that is computed and not stored: its description, with n and k sampled, and the
    /// index itself.
    struct Computed {
        Dataset dataset;
        RefractiveIndex index;
    };
    /// Models, formulas and interpolation in temperature; nothing when the name is none.
    std::optional<Computed> computed(const std::string& name,
                                     const IndexOptions& options = {}) const;
    /// Mixtures and what is computed.
    std::optional<Dataset> unstored(const std::string& name) const;
    static std::vector<std::string> not_indexed(const Layer& layer);
    std::string canonical_name(const std::string& name) const;
    [[noreturn]] void throw_unknown(const std::string& name) const;
    std::vector<std::string> all_names() const;

    std::vector<std::shared_ptr<const Layer>> layers_;  ///< upper first
};

/// Where a user's own materials are kept: $MIEBRDF_DATABASE, else
/// $XDG_DATA_HOME/miebrdf/materials.sqlite, else ~/.local/share/miebrdf/materials.sqlite.
std::filesystem::path default_user_database();

enum class AddOutcome { added, unchanged, replaced };

/// How DatabaseWriter::add treats what is there already.
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
    /// @throws InputError  for figures that are not physical
    std::vector<AddOutcome> add(std::span<const Dataset> datasets, const AddOptions& options = {});

    /// Another name for a material, which need not be in this file (the name may be in a layer
    /// below).
    /// @throws ImportError  when the alias already names another material
    void add_alias(const std::string& material, const std::string& alias);
    /// @returns false when there was none
    bool remove_alias(const std::string& alias);

    /// The dataset that the name alone stands for. @throws UnknownMaterial
    void set_default(const std::string& material, const std::string& label);
    /// A whole material, or one of its datasets. @returns false when it is not in this file
    bool remove_material(const std::string& material);
    /// @returns false when it is not in this file
    bool remove_dataset(const std::string& material, const std::string& label);

  private:
    std::unique_ptr<const sqlite::Connection> connection_;
};

/// A format of files of optical constants.
struct MaterialFormat {
    std::string name;                  ///< "sopra"
    std::string other_name;            ///< "nk"; empty: none
    std::string title;                 ///< "SOPRA"
    std::vector<std::string> endings;  ///< of the files that are written; two: they come in pairs
    bool read = false, written = false;
};
/// All formats, in the order in which their contents are tried.
std::vector<MaterialFormat> material_formats();

/// How files are read; everything may be left as it is.
struct ImportOptions {
    std::string format{};                ///< by name; empty: recognised by content
    std::string material{};              ///< name of the material; empty: from the file
    std::string label{};                 ///< of the dataset; empty: from source and file
    std::string source{};                ///< collection; empty: what the format implies
    double negative_k_tolerance = 1e-2;  ///< k down to minus this is set to 0: noise
    bool replace = false;        ///< a dataset of the same label with other figures gives way
    std::optional<Unit> unit{};  ///< of the first column where the file does not say; bare columns
                                 ///< (wavelength, n and perhaps k) are read when it is given
    /// Rows that are no numbers or not physical are left out and recorded, up to a tenth of all.
    bool skip_bad_rows = false;
};

/// The outcome for one file.
struct ImportItem {
    std::string file;                      ///< as it was given or found
    std::string dataset;                   ///< "material/label"; empty when refused
    std::optional<AddOutcome> outcome;     ///< nothing: refused
    std::string reason;                    ///< of a refusal
    std::vector<std::string> corrections;  ///< what the reader changed, in words
};

/// Reads files and folders and adds what they hold to the user's database, in one transaction. The
/// database is created when it is missing, but only when there is something to add.
///
/// A file given by name must be right: otherwise nothing at all is changed. In a folder (every file
/// below it, or what its `catalog-nk.yml` / `library.yml` lists) bad files are refused one by one
/// and the rest is added; the items say which and why. `X.eta.spd` and `X.k.spd` belong together.
///
/// The material is the one named, or the one to which materials/data/collections.csv assigns the
/// entry of the collection, else: for a page of refractiveindex.info its book; for other files the
/// one whose name or alias is exactly the file's name without extension, else a new one of that
/// name. What else is in the database makes no difference, so the order of imports makes none.
/// @throws ImportError  file, line and reason; DatabaseError
std::vector<ImportItem> import_files(const std::filesystem::path& database,
                                     std::span<const std::filesystem::path> files,
                                     const ImportOptions& options = {});

/// One file without a database: its figures, corrections and provenance. @throws ImportError
Dataset read_file(const std::filesystem::path& file, const ImportOptions& options = {});

/// How datasets are written as files.
struct ExportOptions {
    /// Formats that need k write 0 for an unknown one instead of refusing.
    /// The file, read back, then has a known k = 0.
    bool unknown_k_as_zero = false;
};

/// One file that an export consists of.
struct ExportFile {
    std::string suffix;  ///< put after the file's base name: ".nk", ".eta.spd", ".k.spd"
    std::string text;    ///< of the whole file
};

/// The dataset in a format, figures in the shortest decimals that read back to the same doubles.
///
/// CSV keeps the native unit and n and k on grids of their own; YAML keeps formulas. Both keep the
/// provenance. A format in another unit than the dataset's keeps n and k bit for bit and
/// wavelengths to the rounding of the conversion (one unit in the last place); SOPRA, which states
/// only the ends of its grid, to four times the rounding of the last. spd gives two files.
/// @param format  name of a format
/// @throws InputError  naming what the format cannot express: formulas (all but YAML), n and k on
///         different grids (SOPRA, TFCalc, IMD), a grid that is not uniform (SOPRA), no n
/// @throws UsageError  for an unknown format
std::vector<ExportFile> export_dataset(const Dataset& dataset, std::string_view format,
                                       const ExportOptions& options = {});

/// Something that verification noticed.
struct Finding {
    enum class Severity { note, warning, error };
    Severity severity = Severity::note;  ///< how bad it is
    std::string dataset;                 ///< "material/label"; empty when it concerns the database
    std::string text;                    ///< one sentence
};

/// Checks of the figures alone: order, signs and finiteness (errors); values far off both
/// neighbours and formulas without a real value (warnings); agreement of n and k with the
/// Kramers-Kronig relation and k that is 0 throughout (notes).
std::vector<Finding> verify(const Dataset& dataset);

/// One dataset of a database, or (empty name) all of it: its integrity, checksums and every
/// dataset.
std::vector<Finding> verify(const Database& database, const std::string& name = {});

/// How well n follows from k by the Kramers-Kronig relation
///   n(E) = 1 + (2/pi) P integral of E' k(E') / (E'^2 - E^2) dE'
/// when absorption outside the table is allowed to add A + B E^2 + C / E^2 (the leading terms of
/// resonances above and below it), fitted by least squares: root mean square of what is left,
/// relative to that of n - mean(n). Small is consistent; near 1, k explains nothing of n's
/// dispersion. Evaluated on the middle 80 % of the range in energy.
/// Not a number when there are fewer than 10 rows, k is 0 throughout, n hardly varies (less than
/// 1e-3), or n or k is no table.
double kramers_kronig_residual(const Dataset& dataset);

}  // namespace miebrdf::materials
#pragma GCC visibility pop
