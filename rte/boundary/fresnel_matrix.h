// Smooth boundaries and mirrors for polarised light: Fresnel's Mueller matrices between the
// meridian planes, which are the plane of incidence.
#pragma once

#include <Eigen/Core>
#include <complex>

namespace miebrdf::rte {

/// A Mueller matrix with the axes of the plane of incidence: shares of light polarised parallel to
/// it and across it, and what happens to E_parallel E_across*,
///     [[A, B, 0, 0], [B, A, 0, 0], [0, 0, Re c, Im c], [0, 0, -Im c, Re c]],
/// A = (parallel + across) / 2, B = (parallel - across) / 2, c = cross. Sums, products and inverses
/// of such matrices are those of the three numbers: they commute.
struct FresnelMatrix {
    double parallel = 0.0, across = 0.0;
    std::complex<double> cross = 0.0;

    FresnelMatrix operator+(const FresnelMatrix& other) const {
        return {parallel + other.parallel, across + other.across, cross + other.cross};
    }
    FresnelMatrix operator-(const FresnelMatrix& other) const {
        return {parallel - other.parallel, across - other.across, cross - other.cross};
    }
    FresnelMatrix operator*(const FresnelMatrix& other) const {
        return {parallel * other.parallel, across * other.across, cross * other.cross};
    }
    FresnelMatrix operator*(double factor) const {
        return {parallel * factor, across * factor, cross * factor};
    }
    FresnelMatrix operator/(const FresnelMatrix& other) const {
        return {parallel / other.parallel, across / other.across, cross / other.cross};
    }
    /// Share of unpolarised light.
    double unpolarised() const { return 0.5 * (parallel + across); }

    static FresnelMatrix identity() { return {1.0, 1.0, 1.0}; }
};

/// The matrix as it acts on (I, Q, U, V).
Eigen::Matrix4d mueller_of(const FresnelMatrix& matrix);

/// Reflection in a medium of index `here` of light that meets `beyond`: |r_p|^2, |r_s|^2 and r_p
/// r_s* with r_p = -r_s at normal incidence, where U and V change their sign: Stokes vectors refer
/// to the meridian plane of each ray, as everywhere. Beyond the critical angle both shares are
/// exactly 1, and the phase is that of exp(-i omega t): tan of half of it is mu (mu_c^2 -
/// mu^2)^(1/2) / (1 - mu^2).
///
/// @param here    real, positive
/// @param beyond  n + ik
/// @param mu      cosine of incidence in [0, 1]
FresnelMatrix fresnel_reflection(double here, std::complex<double> beyond, double mu);

/// The reflection of light known to be totally reflected, whatever rounding says of its angle.
FresnelMatrix total_reflection(double here, double beyond, double mu);

/// The share of the same light that passes between two transparent media: 1 - r; U and V keep (t_p
/// t_s) of their flux. The same in both directions.
FresnelMatrix passing(const FresnelMatrix& reflection);

}  // namespace miebrdf::rte
