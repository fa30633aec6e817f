// What lies on what: the scene of radiative transfer.
#pragma once

#include <vector>

#include <miebrdf/optics.h>

namespace miebrdf::rte {

/// A homogeneous layer.
struct Coat {
    Optics optics;
    double optical_depth = 0.0;  ///< of extinction, vertical, >= 0; may be infinite
};

enum class BaseKind {
    half_space,  ///< a medium without end
    lambertian,  ///< a ground that reflects `ground_albedo` of the flux alike in all directions
    none,        ///< nothing: black
};

/// A base and its coats in painting order: the last one is on top.
struct Stack {
    Optics base = {};  ///< of the half-space; ignored for the other kinds
    std::vector<Coat> coats = {};
    BaseKind base_kind = BaseKind::half_space;
    double ground_albedo = 0.0;  ///< in [0, 1], of the Lambertian ground
};

/// Checks every medium, optical depth and the ground's albedo.
/// @throws std::invalid_argument  with the value and the allowed range
void validate(const Stack& stack);

}  // namespace miebrdf::rte
