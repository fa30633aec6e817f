// Unknowns and their slots: one number for each that all wavelengths share, one
// at each wavelength for the others.
#pragma once

#include <miebrdf/fit.h>

#include <span>
#include <vector>

namespace miebrdf::fitting {

/// The number that is fitted for x, and back (Unknown::Scale).
double fitted_of(const Unknown& unknown, double x);
double number_of(const Unknown& unknown, double t);
/// dx/dt at x.
double slope(const Unknown& unknown, double x);

/// A range of fitted numbers, ascending.
struct Range {
    double low, high;
};
Range fitted_range(const Unknown& unknown);

struct Slot {
    std::size_t unknown = 0;
    std::size_t wavelength = 0;  ///< index; 0 of those that wavelengths share
};

/// In the order of unknowns, then of wavelengths.
std::vector<Slot> slots_of(const std::vector<Unknown>& unknowns, std::size_t wavelengths);

/// @throws UsageError  for bounds and starts that no fit can have
void validate(const Unknown& unknown);

}  // namespace miebrdf::fitting
