// Readers of the file formats in which optical constants circulate: text in, dataset out. They
// touch no file and no database; docs/materials.md describes each format.
#pragma once

#include <string>
#include <string_view>

#include "materials/errors.h"
#include "materials/index/dataset.h"

namespace miebrdf::materials {

struct ReadOptions {
    /// Negative k down to this is noise around 0 and set to 0; below it the file is refused. The
    /// largest in the SOPRA collection is 6e-3 (ALSB).
    double negative_k_tolerance = 1e-2;
};

/// All throw ImportError naming file and line. They fill figures, corrections, format and what the
/// file says of its origin; name and label are the importer's.
Dataset read_sopra(std::string_view text, const std::string& file, const ReadOptions& options = {});
Dataset read_tfcalc(std::string_view text, const std::string& file,
                    const ReadOptions& options = {});
Dataset read_csv(std::string_view text, const std::string& file, const ReadOptions& options = {});
/// IMD / Luxpop: ';' comments, then wavelength in Angstrom, n, k.
Dataset read_imd(std::string_view text, const std::string& file, const ReadOptions& options = {});
/// One or two files of `nm value` lines; an empty text means that there is no such file.
Dataset read_spd(std::string_view eta_text, std::string_view k_text, const std::string& file,
                 const ReadOptions& options = {});
/// A data file of refractiveindex.info.
Dataset read_rii_page(std::string_view text, const std::string& file,
                      const ReadOptions& options = {});

/// What the first lines look like. Each looks at content, never at the file's name.
bool looks_like_sopra(std::string_view text);
bool looks_like_tfcalc(std::string_view text);
bool looks_like_csv(std::string_view text);
bool looks_like_imd(std::string_view text);
bool looks_like_spd(std::string_view text);
bool looks_like_rii_page(std::string_view text);

}  // namespace miebrdf::materials
