// Tables whose columns are wavelengths: a spectrum in each row.
#pragma once

#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {

/// Whether columns before the wavelengths hold directions.
bool has_directions(const Sheet& sheet);

/// The columns before the wavelengths, then `wavelength_nm` and `value` of each row's first value.
Sheet first_value_of_rows(const Sheet& sheet);

/// Columns before the wavelengths name the sample. @throws ImportError
Measurements read_spectra_in_rows(const MeasuredFile& file, const Sheet& sheet,
                                  const MeasuredOptions& options);

}  // namespace miebrdf::measured
