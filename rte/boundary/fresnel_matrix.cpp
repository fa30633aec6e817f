#include "rte/boundary/fresnel_matrix.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::rte {
namespace {

// With m = beyond / here, c the cosine and q = (m^2 - sin^2)^(1/2) in the first quadrant:
//     r_s = (c - q) / (c + q),   r_p = (m^2 c - q) / (m^2 c + q),
// with the factor m^2 - 1 taken out as in rte/surface/fresnel.cpp.
FresnelMatrix reflection_from(std::complex<double> m, double c) {
    const std::complex<double> contrast = (m - 1.0) * (m + 1.0), m2 = m * m;
    if (contrast == 0.0) return {};
    const double sin2 = (1.0 - c) * (1.0 + c);
    const std::complex<double> q =
        std::sqrt(std::norm(contrast) < 0.25 ? contrast + c * c : m2 - sin2);
    const std::complex<double> s = c + q, p = m2 * c + q;
    const std::complex<double> across = -contrast / (s * s);
    const std::complex<double> parallel = contrast * (m2 * (c * c) - sin2) / (p * p);
    return {std::norm(parallel), std::norm(across), parallel * std::conj(across)};
}

}  // namespace

Eigen::Matrix4d mueller_of(const FresnelMatrix& matrix) {
    Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
    M(0, 0) = M(1, 1) = matrix.unpolarised();
    M(0, 1) = M(1, 0) = 0.5 * (matrix.parallel - matrix.across);
    M(2, 2) = M(3, 3) = matrix.cross.real();
    M(2, 3) = matrix.cross.imag();
    M(3, 2) = -matrix.cross.imag();
    return M;
}

FresnelMatrix total_reflection(double here, double beyond, double mu) {
    const double m = beyond / here;
    const double beyond_critical = std::max(0.0, (1.0 - m) * (1.0 + m) - mu * mu);
    const double tangent = mu * std::sqrt(beyond_critical) / ((1.0 - mu) * (1.0 + mu));
    const double norm = 1.0 + tangent * tangent;
    return {1.0, 1.0, {(1.0 - tangent) * (1.0 + tangent) / norm, -2.0 * tangent / norm}};
}

FresnelMatrix fresnel_reflection(double here, std::complex<double> beyond, double mu) {
    if (beyond.imag() != 0.0 || here <= beyond.real()) return reflection_from(beyond / here, mu);
    // From the side of the smaller index, where every angle is refracted: both amplitudes change
    // their sign.
    const double ratio = here / beyond.real();
    const double mu2 = 1.0 - ratio * ratio * (1.0 - mu) * (1.0 + mu);
    if (mu2 > 0.0) return reflection_from(ratio, std::sqrt(mu2));
    return total_reflection(here, beyond.real(), mu);
}

FresnelMatrix passing(const FresnelMatrix& reflection) {
    const double parallel = 1.0 - reflection.parallel, across = 1.0 - reflection.across;
    return {parallel, across, std::sqrt(std::max(0.0, parallel) * std::max(0.0, across))};
}

}  // namespace miebrdf::rte
