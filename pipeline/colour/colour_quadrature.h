// The few wavelengths at which a spectrum should be computed when only its colour is wanted.
#pragma once

#include <vector>

#include "pipeline/colour/colour.h"

namespace miebrdf {

struct ColourQuadrature {
    std::vector<double> wavelength_nm;  ///< ascending
    ObserverWeights weights;            ///< for to_xyz
};

/// Gauss nodes of the weight function illuminant * (x + y + z): dense where the eye is sensitive.
/// X, Y and Z each get their own interpolatory weights on these nodes, exact for reflectances that
/// are polynomials of degree nodes - 1 in wavelength (X + Y + Z even to 2 nodes - 1).
///
/// @param nodes  1 to 40; 8 to 12 are plenty for smooth spectra (docs/colour.md has the errors)
/// @param shortest_nm, longest_nm  within 360 to 830 nm and at least 50 nm apart, e.g. where a
///        material is known; what the eye sees beyond counts as if it were inside: white stays
///        white
/// @throws std::invalid_argument  for arguments out of range
ColourQuadrature colour_quadrature(int nodes, Illuminant illuminant = Illuminant::d65,
                                   double shortest_nm = 380.0, double longest_nm = 780.0);

}  // namespace miebrdf
