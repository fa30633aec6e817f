// Reads shapes back out of an SVG picture, with no help from the code that wrote them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace miebrdf::support {

/// Every opening tag closes in order and no stray '&' or '<' is left.
bool is_well_formed(const std::string& xml);

/// Values of an attribute, in order, of all elements of a name.
std::vector<std::string> attributes(const std::string& svg, const std::string& element,
                                    const std::string& name);

/// Contents of all <text> elements.
std::vector<std::string> texts(const std::string& svg);

/// "x,y x,y ..." of polylines and polygons.
std::vector<std::pair<double, double>> points(const std::string& list);

}  // namespace miebrdf::support
