// Interpolation between optics of one species.
#pragma once

#include <vector>

#include "pipeline/solve/single_scattering.h"

namespace miebrdf {

/// Optics, and the weight of Lagrange's polynomials that they have.
struct WeightedOptics {
    MediumOptics optics;
    double weight = 0.0;
    double absorption = 1.0;  ///< that 1 - albedo is relative to, > 0
};

/// Sums with weights, which add up to 1: of ln(1 - albedo), relative to the absorption, of
/// ln(q_ext), and of moments, asymmetry and phase functions as they are. The error is the largest.
/// @param absorption  of the sum
MediumOptics sum_of(const std::vector<WeightedOptics>& nodes, double absorption = 1.0);

}  // namespace miebrdf
