// Which options of `export` have a meaning for which format.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::program {

/// All that --format knows: BRDF files, spectra, single-scattering tables.
std::vector<std::string> all_export_formats();

/// Options (with their dashes) of the file that a format takes: grid, colour, bounds.
/// @throws UsageError  for an unknown format, with the nearest names
std::vector<std::string> file_options_of(const std::string& format);

/// Options that a format has no use for: those of other formats, and for spectra and
/// single-scattering tables parts of the scene's.
std::vector<std::string> ignored_options_of(const std::string& format);

}  // namespace miebrdf::program
