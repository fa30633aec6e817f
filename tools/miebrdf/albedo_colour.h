// Colours of albedos, for `miebrdf albedo --colour`.
#pragma once

#include <string>

#include <miebrdf/colour.h>
#include "pipeline/io/table.h"
#include "pipeline/solve/brdf.h"

namespace miebrdf::program {

/// Reads d65, a or e. @throws UsageError
Illuminant parse_illuminant(const std::string& name);

/// Sorts the wavelengths and refuses those that no colour can be told from: fewer than eight, or
/// not from 430 nm or less to 650 nm or more. @throws UsageError
void prepare_for_colour(Request& request);

/// Columns quantity, mu_in, XYZ, Lab, encoded sRGB: a row for the plane albedo at each mu_in and
/// one for the spherical albedo, to six decimals.
/// @param result  at ascending wavelengths
void add_colours(Table& table, const AlbedoResult& result, const std::vector<double>& mu_in,
                 Illuminant illuminant);

}  // namespace miebrdf::program
