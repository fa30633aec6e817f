// What is averaged over sizes.
#pragma once

#include <cmath>
#include <complex>

namespace miebrdf::mie {

/// A particle without its size: averages are handed it whole and ask only what stands here, and
/// compute_spheres(), exact_extinction() and the rays of the Debye series (where has_rays()) know
/// how light meets it.
///
/// One kind so far: a homogeneous sphere.
struct Scatterer {
    // NOLINTNEXTLINE(google-explicit-constructor): an index is a sphere of it
    Scatterer(std::complex<double> index = 1.0) : relative_index(index) {}

    std::complex<double> relative_index;  ///< m = n + ik of the sphere over its host

    double n() const { return relative_index.real(); }
    bool absorbs() const { return relative_index.imag() > 0; }
    /// k x: a wave is damped by exp(-2 k x) on its way through the middle of the sphere, and its
    /// resonances are as wide as k x at least.
    double damping(double x) const { return relative_index.imag() * x; }
    /// Whether rays of the Debye series describe it (RayWaves).
    bool has_rays() const { return relative_index.real() > 1; }

    /// The distance in x after which the ripple of a transparent sphere repeats: atan(s)/s with
    /// s^2 = n^2 - 1 (Chylek 1990, J. Opt. Soc. Am. A 7, 1609, eq. 1); 1 where there is none.
    double ripple_period() const {
        if (!(n() > 1)) return 1;
        const double s = std::sqrt((n() - 1) * (n() + 1));
        return s > 1e-3 ? std::atan(s) / s : 1;
    }
};

}  // namespace miebrdf::mie
