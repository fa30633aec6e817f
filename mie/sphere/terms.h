// How many partial waves a sphere needs.
#pragma once

namespace miebrdf::mie {

/// Number of terms after which a_n and b_n of a sphere of this size are below rounding:
/// x + 8 x^(1/3) + 12. (Wiscombe 1980, Appl. Opt. 19, 1505, stops at x + 4.05 x^(1/3) + 2, where
/// amplitudes away from the forward peak keep only 7 to 10 digits.)
int number_of_terms(double size_parameter);

}  // namespace miebrdf::mie
