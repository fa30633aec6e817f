// A format of files of optical constants: what it is called, how it is recognised, read and
// written. A new one is a file that fills in a FileFormat, and its name in the list of
// file_formats.cpp; docs/materials.md describes each.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/database.h>
#include "materials/readers/raw_table.h"

namespace miebrdf::materials {

/// A file, or a pair of files, as a format reads it.
struct SourceFile {
    std::filesystem::path path;
    std::string text;         ///< of a second file without its first: empty
    std::string second_text;  ///< of a pair's second file
    std::string sha256 = {};  ///< of the bytes of both
};

struct FileFormat {
    const char* name;             ///< "sopra"
    const char* other_name = "";  ///< "nk"; empty: none
    const char* title;            ///< "SOPRA", in messages
    const char* endings[2] = {};  ///< of the files that are written; two: they come in pairs
    /// File names that ignore case (DOS): CO.NK is cobalt.
    bool caseless_names = false;

    /// Looks at content, never at the file's name.
    bool (*looks_like)(std::string_view text);
    /// Fills figures, corrections, format and what the file says of its origin; name and label are
    /// the importer's. @throws ImportError  naming file and line
    Dataset (*read)(const SourceFile& source, const ReadOptions& options);
    /// @throws InputError  by refuse_export; null: the format is not written
    std::vector<ExportFile> (*write)(const Dataset& dataset,
                                     const ExportOptions& options) = nullptr;
    /// Takes material, label and key from the path; null: the path says nothing.
    void (*read_path)(Dataset& dataset, const std::filesystem::path& path) = nullptr;
};

/// By either name. @throws UsageError  naming all that are known
const FileFormat& format_named(std::string_view name);
/// By content alone; null when no format fits.
const FileFormat* recognise(std::string_view text);

SourceFile read_source(const std::filesystem::path& file);
/// "dir/X.eta.spd" and "dir/X.k.spd" -> "dir/X"; any other path unchanged.
std::filesystem::path pair_base(const std::filesystem::path& file);

/// File, checksum, key, label and material, as far as the file itself did not say them; what the
/// options give comes first.
void fill_origin(Dataset& dataset, const SourceFile& source, const FileFormat& format,
                 const ImportOptions& options);

ReadOptions read_options(const ImportOptions& options);

struct ReadFile {
    Dataset dataset;
    const FileFormat& format;
};
/// One file with its origin. @throws ImportError
ReadFile read_recognised(const std::filesystem::path& file, const ImportOptions& options);

/// "GaP/SOPRA-GAP cannot be written as sopra: ..." @throws InputError
[[noreturn]] void refuse_export(const Dataset& dataset, const char* format,
                                const std::string& reason);

/// n and k on one grid, k = 0 where that is allowed to stand for unknown.
struct JointTable {
    const Series& n;
    std::vector<double> k;
};
/// @throws InputError  when the dataset has no such table
JointTable joint_table(const Dataset& dataset, const char* format, const ExportOptions& options);

/// The wavelength of a row in another unit, in the shortest decimals that read back to it.
std::string in_unit(const Series& series, std::size_t row, Unit unit);

/// Rows of wavelength, n and k, as read_bare_columns() reads them.
std::string bare_columns(const JointTable& table, Unit unit);

/// The dataset's provenance, each line after `comment`.
std::string remarks(const Dataset& dataset, std::string_view comment);

}  // namespace miebrdf::materials
