// The reflectance of a rough surface once more: from the textbook, and by another method.
#pragma once

#include <complex>

namespace miebrdf::bench {

/// Integral over the hemisphere of D G F / (4 mu_in mu_out) mu_out: Beckmann's distribution,
/// Smith's height-correlated masking (Heitz 2014, eq. 99), Fresnel's amplitudes in complex
/// arithmetic. Adaptive Gauss-Kronrod quadrature (Boost) in azimuth within mu_out, to 1e-11; no
/// code of rte/.
/// @param alpha  Beckmann slope parameter
double textbook_reflectance(double alpha, std::complex<double> index, double mu_in);

}  // namespace miebrdf::bench
