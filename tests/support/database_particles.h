// Spheres as databases of single scattering list particles.
#pragma once

#include <miebrdf/optics.h>
#include <miebrdf/sphere.h>

#include <cmath>
#include <complex>
#include <vector>

namespace miebrdf::support {

/// 0 ... 180 in steps of `step` degrees.
inline std::vector<double> even_angles(double step) {
    std::vector<double> angles;
    for (int i = 0; i * step <= 180.0; ++i) angles.push_back(i * step);
    return angles;
}

/// One sphere: efficiencies, and its scattering matrix at angles, the mean of a1 = 1.
struct DatabaseSphere {
    mie::SphereOptics sphere;
    std::vector<rte::ScatteringMatrix> matrix;
};

inline DatabaseSphere database_sphere(std::complex<double> index, double x,
                                      const std::vector<double>& angles) {
    DatabaseSphere result{mie::scatter_by_sphere(index, x), {}};
    const auto s = mie::scattering_amplitudes(index, x, angles);
    for (std::size_t a = 0; a < angles.size(); ++a) {
        const double scale = 4.0 / (x * x * result.sphere.q_sca);
        const double one = std::norm(s.s1[a]), two = std::norm(s.s2[a]);
        const std::complex<double> cross = s.s2[a] * std::conj(s.s1[a]);
        result.matrix.push_back({.a1 = scale * 0.5 * (one + two),
                                 .a2 = scale * 0.5 * (one + two),
                                 .a3 = scale * cross.real(),
                                 .a4 = scale * cross.real(),
                                 .b1 = scale * 0.5 * (two - one),
                                 .b2 = scale * cross.imag()});
    }
    return result;
}

}  // namespace miebrdf::support
