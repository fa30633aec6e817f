// Numbers and lists of numbers as people type them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "materials/index/words.h"

namespace miebrdf {

inline std::string trimmed_text(std::string_view text) {
    return std::string(materials::without_blanks(text));
}

/// The text with blanks in place of what stands in parentheses, so that commas, `=` and ` + ` that
/// belong to a name (`formula(n=1.5,k=0)`) do not separate; as it is where parentheses do not
/// match.
std::string blank_in_parentheses(std::string_view text);

/// Reads one finite number; the whole text must be the number.
/// @param what  names the quantity in the message ("cosine of incidence")
/// @throws UsageError
double parse_number(std::string_view text, const std::string& what);

/// As parse_number(), and infinity from `inf`.
double parse_number_or_infinity(std::string_view text, const std::string& what);

/// A unit that may stand behind a number: the value is number * times / by.
struct Unit {
    std::string_view name;  ///< empty: of a number without a unit
    double times, by;
};

/// Reads a number with one of these units: `15%`, `200nm`, `1e6/cm3`.
/// @throws UsageError  for anything else, with the units that are known
double parse_quantity(std::string_view text, const std::string& what, std::span<const Unit> units);

/// Splits at commas (or another separator), blanks around the parts removed.
std::vector<std::string> split_list(std::string_view text, char separator = ',');

/// The two numbers of a refractive index, `1.5,0.01` or `1.5+0.01i`, as words.
/// @throws UsageError  for n - ik: k is positive here
std::vector<std::string> split_index(std::string_view text);

/// `a,b,c` and `first:last:step` (inclusive), which may be mixed.
/// @throws UsageError  for an empty list, a step of the wrong sign, or more than 1,000,000 numbers
std::vector<double> parse_number_list(std::string_view text, const std::string& what);

/// As above, with every number in [lowest, highest]; `lowest_open` leaves the lower end out.
std::vector<double> parse_number_list(std::string_view text, const std::string& what, double lowest,
                                      double highest, bool lowest_open = false);

/// Vacuum wavelength in nm from `550`, `550nm`, `0.55um`, `5500A`, `2.25eV`, `18182cm-1` or
/// `545THz` (materials/index/units.h).
/// @throws UsageError  for an unknown unit or a wavelength that is not positive
double parse_wavelength_nm(std::string_view text);

/// A list of wavelengths in nm; every part may carry its unit, and `rgb` is 620, 535, 480 nm. Steps
/// are in nm, or with a unit (`2eV:3eV:0.25eV`) even in that unit.
std::vector<double> parse_wavelengths_nm(std::string_view text);

}  // namespace miebrdf
