// A fuzzer feeds each reader; some things must hold whatever the bytes are.
#pragma once

#include <string>
#include <string_view>

namespace miebrdf::materials::fuzz {

/// Names: "sopra", "tfcalc", "rii", "csv", "imd", "spd", "catalogue", "wavelength", "recognise".
/// A reader either refuses the bytes with ImportError or gives a dataset whose series are in order,
/// which can be evaluated, and which survives a round trip through every format that accepts it.
/// Anything else ends the program (abort).
void check(std::string_view reader, std::string_view bytes);

}  // namespace miebrdf::materials::fuzz
