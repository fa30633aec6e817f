// The values of an axis as people write them: lists, ranges, columns of a CSV file.
#pragma once

#include <string>
#include <vector>

#include "pipeline/sweep/sweep.h"

namespace miebrdf::sweep {

/// Reads `1,2,5`, `0:1:0.1` (first:last:step), `50:1000:10 log` (first:last:count, even steps of
/// the logarithm) or `0:1:11 linear` (first:last:count).
/// @throws UsageError  for anything else, for ends that are not positive on a logarithmic axis, and
///         for counts outside 1 ... 1,000,000
Axis parse_axis(const std::string& name, const std::string& text);

/// The axis of these numbers.
Axis axis_of(const std::string& name, std::vector<double> numbers);

/// Columns of a CSV file: `#` lines, a line of names, a line for each sample. A column of which
/// every field is a number is one of numbers, any other one of texts.
/// @param columns  in this order; empty: all
/// @throws InputError  for a file that cannot be read, lines of different lengths, empty files
/// @throws UsageError  for a column that it has not
std::vector<Axis> read_columns(const std::string& file, const std::vector<std::string>& columns);

/// "um" of "radius_um"; empty where the name says none.
std::string unit_in(const std::string& name);

/// "sr-1 um-1" of "sr-1" by "um", as UDUNITS writes it; "1" and empty units are left out.
std::string quotient_of_units(const std::string& unit, const std::string& by);

/// Refuses values of a coordinate that neither ascend nor descend. @throws UsageError
void require_monotonic(const Axis& axis);

}  // namespace miebrdf::sweep
