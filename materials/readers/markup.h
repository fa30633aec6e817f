// Text out of the little HTML that refractiveindex.info writes into references and names.
#pragma once

#include <string>
#include <string_view>

namespace miebrdf::materials {

/// Tags removed, the common entities resolved, runs of blanks and line ends made one blank.
std::string without_markup(std::string_view html);

/// The first DOI ("10.1103/PhysRevB.6.4370") in a text, or nothing.
std::string first_doi(std::string_view text);

}  // namespace miebrdf::materials
