// Rows as a file gives them, before they are put in order.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "materials/errors.h"
#include "materials/index/dataset.h"
#include "materials/readers/readers.h"

namespace miebrdf::materials {

/// Tables longer than this are refused: no source has them, and a header may announce anything.
inline constexpr std::size_t most_rows = 1'000'000;

struct RawRow {
    double x = 0.0;  ///< in the table's unit
    double n = 0.0;
    double k = 0.0;
    int line = 0;  ///< of the file, from 1
};

struct RawTable {
    Unit unit = Unit::nanometre;
    bool has_n = true;
    bool has_k = true;
    std::vector<RawRow> rows;
};

/// Puts the rows in order of wavelength, drops repeated wavelengths (the first is kept), sets
/// slightly negative k to 0, and adds both series to the dataset; every change is recorded in its
/// corrections.
/// @throws ImportError  naming file and line of a row that is not physical
void add_table(Dataset& dataset, RawTable table, const std::string& file,
               const ReadOptions& options);

/// A finite number. @throws ImportError
double require_number(std::string_view text, const std::string& file, int line);

/// The words of a line, separated by blanks, tabs, commas or semicolons.
std::vector<std::string_view> split_words(std::string_view line,
                                          std::string_view separators = " \t,;");

}  // namespace miebrdf::materials
