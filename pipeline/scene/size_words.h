// Sizes as people have them, from words to a distribution: medians, quantiles, Junge's law, the
// specific surface of snow, tables.
#pragma once

#include <miebrdf/scene.h>

#include <map>
#include <string>
#include <vector>

namespace miebrdf {

/// A key and its value, of the keys below.
using SizeWords = std::map<std::string, std::string>;

/// median, sigma_g, by; d10, d50, d90; junge, from, to; ssa; sizes.
const std::vector<std::string>& size_word_names();

/// Sets the sizes of the species as the words say them together.
/// @param text  the species, named in messages
/// @throws UsageError  for words that do not belong together or say too little
/// @throws InputError  for a table that is missing or wrong
void set_sizes(const SizeWords& words, Species& species, const std::string& text);

/// Radii and number densities of a CSV table: a column radius_um, radius_nm, diameter_um or
/// diameter_nm, ascending, and one of number_density (dN/dr), dn_dlnr, dv_dlnr or, for classes
/// around these sizes, number_share, area_share or volume_share. @throws InputError
void read_sizes(const std::string& file, ParticleSizes& sizes);

}  // namespace miebrdf
