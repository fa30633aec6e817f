// Optics of a single homogeneous sphere.
// Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <complex>
#include <string>

#include "mie/sphere/amplitudes.h"

namespace miebrdf::mie {

/// Efficiencies are cross-sections over pi r^2.
struct SphereOptics {
    double q_ext = 0.0;  ///< q_sca + q_abs, both sums of positive terms
    double q_sca = 0.0;
    double q_abs = 0.0;   ///< summed, never extinction minus scattering; exactly 0 for k = 0
    double q_back = 0.0;  ///< radar backscattering, 4 |S(180)|^2 / x^2
    double asymmetry = 0.0;
    int terms = 0;          ///< partial waves summed
    double accuracy = 0.0;  ///< estimated relative error of the efficiencies from rounding
    bool reached = false;   ///< accuracy <= 1e-12
    std::string status;     ///< empty, or what was not reached and why
};

/// Lorenz-Mie theory of one sphere; the arguments of mie_coefficients.
///
/// Measured against 60-digit tables: efficiencies to 1e-12 from x = 1e-8 to 1e6; an index within
/// 1e-3 of the host's (m near 1) keeps as many digits as |m - 1| has above rounding.
///
/// @throws std::invalid_argument  index or size parameter out of range
SphereOptics scatter_by_sphere(std::complex<double> relative_index, double size_parameter);

}  // namespace miebrdf::mie
