// A table of text and numbers: the line that names the columns, and the rows below it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/measured/columns.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {

struct SheetCell {
    std::string text;
    std::optional<double> number = {};  ///< nothing: text, or no value (empty, "NaN", "n/a")
    bool is_missing = false;
    bool is_percent = false;  ///< "45 %", which is .45
};

struct SheetRow {
    int line = 0;
    std::vector<SheetCell> cells = {};  ///< one for each name
};

struct Sheet {
    std::vector<std::string> names;  ///< empty where the file names no columns
    int names_line = 0;
    std::vector<SheetRow> rows;
    std::vector<std::string> remarks;    ///< comments, and lines above the names and below the rows
    std::vector<std::string> above;      ///< the fields of the line above the names
    bool names_are_wavelengths = false;  ///< from `first_wavelength` on: spectra in rows
    int lines_below = 0, first_below = 0;  ///< words below the rows: how many, and from which line

    /// Whether a remark says so of the values: "in percent", "[%]".
    bool says_percent() const;
    /// What a remark says of values without a name of their own: "Y Axis: Absorbance".
    ValueMeaning meaning() const;
};

/// Percent in a name: "reflectance (%)".
bool says_percent(std::string_view name);

/// The wavelength that names a column of a table with spectra in rows, in nm: "400", "400 nm",
/// "R400", "SPECTRAL_NM400".
std::optional<double> wavelength_in_name(std::string_view name);

/// The name of a column without its unit: "Theta_i (deg)" -> "theta_i".
std::string bare_name(std::string_view name);

/// @throws ImportError  for rows of other lengths than the line of names, and decimal points mixed
///         with decimal commas
Sheet read_sheet(const MeasuredFile& file);
/// The line of names alone; empty where there is none.
std::vector<std::string> sheet_names(const MeasuredFile& file);

}  // namespace miebrdf::measured
