// Radiance's BSDF XML: what a tensor tree and a matrix of patches have in common.
#pragma once

#include <array>
#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "pipeline/formats/common/export_job.h"

namespace miebrdf {

FormatReader radiance_reader();  ///< reader.cpp, of both kinds

/// X, Y and Z of Radiance's own R, G and B; none below zero.
std::array<double, 3> radiance_xyz(const double* rgb);

/// From the first line to the definition of directions, with the metadata as a comment.
void write_radiance_head(const RgbSource& source, const std::string& definition, std::ostream& out);

/// One WavelengthData element.
struct RadianceBand {
    const char* wavelength;
    const char* detector;
    std::vector<float> values;  ///< of a tree the first half; the rest is zero
    /// The names are those of a window seen from inside: Radiance's front is its back.
    const char* direction = "Reflection Back";
};

/// @param basis  elements that name the angle basis
/// @param row    values of a line of a matrix; 0: a tensor tree
void write_radiance_band(const RadianceBand& band, const std::string& basis, std::size_t row,
                         std::ostream& out);

/// Closes what write_radiance_head opened.
void write_radiance_tail(std::ostream& out);

}  // namespace miebrdf
