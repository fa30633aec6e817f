// A BRDF at every combination of three lists of directions, for the formats that are plain tables.
#pragma once

#include <vector>

#include "pipeline/formats/common/export_job.h"

namespace miebrdf {

/// `intervals` cosines sin^2(pi k / 2 intervals), k >= 1: dense at the horizon and at the normal.
std::vector<double> sine_squared_cosines(int intervals);

/// `count` equally spaced numbers from first to last, both included.
std::vector<double> equally_spaced(double first, double last, int count);

/// Those of the options; lists that are empty there have `resolution` cosines, and three azimuths
/// more, over half a turn.
/// @throws UsageError  for directions out of range
rte::Directions table_directions(const ExportOptions& options);

/// How many combinations there are.
std::size_t size_of(const rte::Directions& directions);

/// [wavelength][mu_in][mu_out][azimuth], azimuth fastest. @throws Cancelled
std::vector<double> tabulate(const BrdfSource& source, const rte::Directions& directions,
                             const Control& control);

/// Mueller matrices in the same order, [...][row][column] with the components of the source; empty
/// where only its BRDF is known. @throws Cancelled
std::vector<double> tabulate_mueller(const BrdfSource& source, const rte::Directions& directions,
                                     const Control& control);

/// m11, m12, ..., row by row.
std::vector<std::string> mueller_names(int components);

/// The entry that all plain tables share in the list of formats.
Format table_format(const char* name, const char* readers, const char* ending,
                    void (*write)(const ExportJob& job, std::ostream& out),
                    const FormatReader& reader);

}  // namespace miebrdf
