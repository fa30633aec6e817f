// Scattering matrices between the meridian planes, and media as the discrete equations see them.
#pragma once

#include <Eigen/Core>

#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

/// F turned from the plane of scattering to the meridian planes of both rays, 4 x 4: light that
/// comes down at mu_in and goes up at mu_out. Of light that goes back where it came from, and of
/// vertical rays, the limit at this azimuth.
Eigen::Matrix4d turned_to_meridians(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                                    double azimuth_deg);

/// F turned for light that comes down and goes on downwards. Of light scattered upside down, coming
/// up at mu_in, both are D M D, D = diag(1, 1, -1, -1).
Eigen::Matrix4d turned_forward(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                               double azimuth_deg);

/// The elements of intensity and Q of both, upper left 2 x 2.
/// @param half_cosine, half_sine  of half the azimuth
Eigen::Matrix2d turned_intensity(const ScatteringMatrix& matrix, double mu_in, double mu_out,
                                 double half_cosine, double half_sine);
Eigen::Matrix2d turned_forward_intensity(const ScatteringMatrix& matrix, double mu_in,
                                         double mu_out, double half_cosine, double half_sine);

/// The medium that the discrete equations see, as one whose coefficients are all of it.
Optics as_seen_by_equations(const ScaledMedium& medium);

}  // namespace miebrdf::rte
