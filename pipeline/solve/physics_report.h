// What physics says about a computed BRDF, as numbers: reciprocity, energy and sign.
#pragma once

#include <optional>
#include <vector>

#include "rte/stack/layered_reflection.h"

namespace miebrdf {

struct PhysicsReport {
    /// Largest |f(mu_in, mu_out) - f(mu_out, mu_in)| over the largest f, among the pairs of which
    /// both were asked for; empty when there are none. The paper's coupling to a surface (eq. 5) is
    /// not reciprocal; the layers alone are, to rounding.
    std::optional<double> reciprocity_defect;
    /// Largest share of the light that comes back, over the requested mu_in; at most 1.
    std::optional<double> largest_albedo;
    double least_value = 0.0;  ///< smallest BRDF value, 1/sr; negative values are wrong
};

/// Reciprocity and the least value of a table laid out as in rte::ReflectionTable.
/// @param values  not empty
PhysicsReport physics_of(const std::vector<double>& values, const rte::Directions& directions);

}  // namespace miebrdf
