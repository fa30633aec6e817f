// Names of materials as people write them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace miebrdf::materials {

/// Lower case (ASCII) without spaces, '_' and '-', subscript digits as plain ones: "Al Ga-As_70"
/// and "algaas70" are the same.
std::string normalised(std::string_view name);

/// The names most like `asked`, best first: those that start with it, then by edit distance
/// (insertion, deletion, substitution, swap of neighbours) of the normalised forms, up to a third
/// of the length or 2.
std::vector<std::string> nearest_names(std::string_view asked,
                                       const std::vector<std::string>& known,
                                       std::size_t at_most = 5);

}  // namespace miebrdf::materials
