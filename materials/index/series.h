// One series of n or k: what makes it sound, and the nine dispersion formulas of
// refractiveindex.info.
#pragma once

#include <span>
#include <string>

#include <miebrdf/index.h>

namespace miebrdf::materials {

/// The largest n and k that are accepted: far beyond all sources (metals at 1 mm have a few
/// thousand).
inline constexpr double kLargestIndex = 1e6;

/// A series must be finite, ascending in wavelength (and strictly descending in photon energy, in
/// which it will be interpolated), with n > 0 and k >= 0 wherever it is tabulated.
/// @throws InputError  naming the row
void check_series(const Series& series, char quantity);

/// Where a formula has no real value: "formula 2 has no real value at 12 of 1001 wavelengths of its
/// range, first at 420.5 nm". Empty when there is none. The samples are even in photon energy.
std::string formula_gap(const Series& series);

/// Why a formula cannot have these coefficients: a term lacks one, or there are more than it has.
/// Empty when it can. Sources leave whole terms away, never a part of one.
std::string formula_mismatch(int formula, std::span<const double> coefficients);

/// n of formula 1-9 at a vacuum wavelength in micrometres; coefficients as in the source; terms
/// that are not given are 0. With L the wavelength:
///   1  n^2 - 1 = c1 + sum c_i L^2 / (L^2 - c_{i+1}^2)    (Sellmeier)
///   2  n^2 - 1 = c1 + sum c_i L^2 / (L^2 - c_{i+1})
///   3  n^2 = c1 + sum c_i L^c_{i+1}                       (polynomial)
///   4  n^2 = c1 + c2 L^c3 / (L^2 - c4^c5) + c6 L^c7 / (L^2 - c8^c9) + sum_{i >= 10} c_i L^c_{i+1}
///   5  n = c1 + sum c_i L^c_{i+1}                         (Cauchy)
///   6  n - 1 = c1 + sum c_i / (c_{i+1} - L^-2)            (gases)
///   7  n = c1 + c2 / (L^2 - .028) + c3 / (L^2 - .028)^2 + c4 L^2 + c5 L^4 + c6 L^6  (Herzberger)
///   8  (n^2 - 1) / (n^2 + 2) = c1 + c2 L^2 / (L^2 - c3) + c4 L^2   (retro)
///   9  n^2 = c1 + c2 / (L^2 - c3) + c4 (L - c5) / ((L - c5)^2 + c6)   (exotic)
/// Not a number where the formula has no positive real value.
/// @throws UsageError  for another formula number
double dispersion_formula(int formula, std::span<const double> coefficients, double wavelength_um);

}  // namespace miebrdf::materials
