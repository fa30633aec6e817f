// A curve in one line of text.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::program {

/// Lowest and highest value around up to 48 block characters, evenly spaced in x; x ascends.
std::string sparkline(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace miebrdf::program
