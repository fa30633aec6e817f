// What Radiance's BSDF files have in common, matrices and trees alike: docs/formats/radiance.md.
#pragma once

#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "pipeline/solve/rgb_source.h"

namespace miebrdf::exports {

/// Linear sRGB to CIE XYZ, none below zero.
std::array<double, 3> xyz_of(const double* rgb);

/// From the first line to the definition of directions, with the metadata as a comment.
void write_radiance_head(const RgbSource& source, const std::string& definition, std::ostream& out);

/// One WavelengthData element.
struct RadianceBand {
    const char* wavelength;
    const char* detector;
    std::vector<float> values;  ///< of a tree the first half; the rest is zero
};

/// @param basis  elements that name the angle basis
/// @param row    values of a line of a matrix; 0: a tensor tree
void write_radiance_band(const RadianceBand& band, const std::string& basis, std::size_t row,
                         std::ostream& out);

/// Closes what write_radiance_head opened.
void write_radiance_tail(std::ostream& out);

}  // namespace miebrdf::exports
