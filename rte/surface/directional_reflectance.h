// How much of the light from one direction a rough surface reflects.
#pragma once

#include <complex>

#include <miebrdf/surface.h>

namespace miebrdf::rte {

/// An integral and how it came about.
struct IntegralResult {
    double value = 0.0;
    double error_estimate = 0.0;  ///< absolute, from the last two doublings of the nodes
    int nodes = 0;                ///< for each of the two dimensions
    bool converged = false;       ///< error_estimate <= tolerance
};

/// rho_dt(mu_in): the integral of R_s mu_out over the outgoing hemisphere.
///
/// Taken over the slopes of the mirrors' normals instead of over mu_out, where the lobe has the
/// same shape for every roughness and incidence; with the slopes measured along the plane of
/// incidence (x, towards the light) and across it (y) and P their density,
///     rho = integral of P(x, y) (1 + x tan(theta_in)) G F dx dy,  (x - tan)^2 + y^2 < 1 / mu_in^2.
/// Gauss nodes in coordinates in which P is smooth and bounded; their number is doubled until the
/// result moves by less than the tolerance. docs/maths-surface.md derives it and has the measured
/// errors.
///
/// @param mu_in  in (0, 1]
/// @param tolerance  absolute, > 0
/// @throws std::invalid_argument  for an index, options, cosine or tolerance out of range
IntegralResult directional_reflectance(std::complex<double> refractive_index,
                                       const SurfaceOptions& options, double mu_in,
                                       double tolerance = 1e-6);

}  // namespace miebrdf::rte
