// --vary: one number of a scene, taken through several values.
#pragma once

#include <string>
#include <vector>

#include "pipeline/scene/request.h"

namespace miebrdf::program {

struct Family {
    std::string name = {};  ///< "depth", "roughness", ...; empty: nothing is varied
    std::vector<double> values = {};

    /// `values`, or a single 0 where nothing is varied.
    std::vector<double> values_or_one() const;
    /// The quantity that is varied, with its unit: "optical depth of the top layer".
    std::string label(const Request& request) const;
    /// Changes the request. @return the value in words: "optical depth 0.5"; empty: nothing varied
    /// @throws UsageError  for a scene that has no such number, and values that it cannot have
    std::string apply(double value, Request& request) const;
};

/// Reads NAME=FROM:TO:COUNT, or NAME=A,B,C, of 2 to 33 values. @throws UsageError
Family parse_family(const std::string& text);

}  // namespace miebrdf::program
