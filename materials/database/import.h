// Files of optical constants into a database.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "materials/database/database.h"
#include "materials/database/database_writer.h"

namespace miebrdf::materials {

enum class Format { sopra, tfcalc, rii, csv, imd, spd };

/// "sopra", "tfcalc", "rii", "csv", "imd", "spd".
const char* name_of(Format format);
std::optional<Format> parse_format(std::string_view name);

/// By content alone; nothing when no format fits.
std::optional<Format> recognise(std::string_view text);

struct ImportOptions {
    std::optional<Format> format{};      ///< nothing: recognised by content
    std::string material{};              ///< name of the material; empty: from the file
    std::string label{};                 ///< of the dataset; empty: from source and file
    std::string source{};                ///< collection; empty: what the format implies
    double negative_k_tolerance = 1e-2;  ///< k down to minus this is set to 0 (ReadOptions)
    bool replace = false;  ///< a dataset of the same label with other figures gives way
};

struct ImportItem {
    std::string file;
    std::string dataset;                ///< "material/label"; empty when refused
    std::optional<AddOutcome> outcome;  ///< nothing: refused
    std::string reason;                 ///< of a refusal
    std::vector<std::string> corrections;
};

/// Reads files and folders and adds what they hold to the user's database, in one transaction. The
/// database is created when it is missing, but only when there is something to add.
///
/// A file given by name must be right: otherwise nothing at all is changed. In a folder (every file
/// below it, or what its `catalog-nk.yml` / `library.yml` lists) bad files are refused one by one
/// and the rest is added; the items say which and why. `X.eta.spd` and `X.k.spd` belong together.
///
/// The material is the one named, or what the catalogue says, or the one that the file's name
/// without extension means in it or the embedded database (exactly, by alias or normalised), else a
/// new one of that name.
/// @throws ImportError  file, line and reason; DatabaseError
std::vector<ImportItem> import_files(const std::filesystem::path& database,
                                     std::span<const std::filesystem::path> files,
                                     const ImportOptions& options = {});

/// One file without a database: its figures, corrections and provenance. @throws ImportError
Dataset read_file(const std::filesystem::path& file, const ImportOptions& options = {});

}  // namespace miebrdf::materials
