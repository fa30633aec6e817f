// Tables whose columns are wavelengths: a spectrum in each row.
#pragma once

#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {

/// Whether columns before the wavelengths hold directions.
bool has_directions(const Sheet& sheet);

/// The same numbers with a row for each wavelength: columns before the wavelengths, then
/// `wavelength_nm` and `value`.
Sheet one_value_a_line(const Sheet& sheet);

/// Columns before the wavelengths name the sample. @throws ImportError
Measurements read_spectra_in_rows(const MeasuredFile& file, const Sheet& sheet,
                                  const MeasuredOptions& options);

}  // namespace miebrdf::measured
