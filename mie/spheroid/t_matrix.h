// The transition matrix of a homogeneous spheroid.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace miebrdf::mie {

/// A spheroid in its host; its size is the radius of the sphere of the same volume.
struct Spheroid {
    std::complex<double> relative_index;  ///< m = n + ik over the host's
    double size_parameter;                ///< k times the volume-equivalent radius
    double aspect;  ///< equatorial axis over the axis of rotation: above 1 oblate

    /// k times the larger semi-axis.
    double largest_x() const;
};

/// T of each azimuthal order m = 0 ... degree about the axis of rotation: scattered from incident
/// coefficients of the vector spherical functions M_mn, N_mn of Mishchenko, Travis & Lacis (2002,
/// appendix C). Order -m has the same blocks on the diagonal, and the others with the other sign.
struct TMatrix {
    int degree = 0;  ///< the largest n
    /// 2S x 2S, S = degree - max(m, 1) + 1: the S rows and columns of M come first.
    std::vector<Eigen::MatrixXcd> orders;
    double q_ext = 0, q_sca = 0;  ///< orientation averages, over pi times the radius squared
    /// Relative: the largest of the change from degree - 2 to degree of q_ext and q_sca, what
    /// breaks reciprocity in T over its largest element, and q_ext / q_sca - 1 for k = 0.
    double error_estimate = 1;
};

/// T = -P Q^-1 by the extended boundary condition method, with surface integrals in the forms of
/// Somerville, Auguie & Le Ru (2012, JQSRT 113, 524, section 3) and integrands without the parts
/// that integrate to zero (RadialProducts). The degree is raised until the estimate is within the
/// tolerance, or no longer falls.
///
/// Cost: about degree^4; milliseconds at x = 3, a tenth of a second at x = 20.
TMatrix t_matrix(const Spheroid& spheroid, double tolerance);

/// As above, of one degree.
/// @param nodes  of the surface from the pole to the equator; 0: as many as aspects of 1/4 to 4
/// want
TMatrix t_matrix_of_degree(const Spheroid& spheroid, int degree, int nodes = 0);

}  // namespace miebrdf::mie
