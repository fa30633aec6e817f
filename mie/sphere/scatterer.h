// The particles that averages over sizes are taken of.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include <miebrdf/sphere.h>
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {

/// A particle without its size: averages are handed it whole and ask only what stands here, and
/// compute_spheres() and the rays of the Debye series (where has_rays()) know
/// how light meets it. It is a homogeneous sphere, or one with coatings; sizes are those of the
/// core; or a spheroid in random orientation (spheroid_average.h), whose size is that of the sphere
/// of its volume.
struct Scatterer {
    /// A coating adds `thickness` to the size parameter, the same on every core, and `share` of
    /// that of the core.
    struct Coating {
        std::complex<double> relative_index;
        double thickness = 0, share = 0;
    };

    // NOLINTNEXTLINE(google-explicit-constructor): an index is a sphere of it
    Scatterer(std::complex<double> index = 1.0) : relative_index(index) {}

    std::complex<double> relative_index;  ///< m = n + ik of the sphere or core over its host
    std::vector<Coating> coatings = {};   ///< from inside out
    double aspect = 1;                    ///< of spheroids, the equatorial axis over the polar one

    bool is_plain() const { return coatings.empty(); }
    bool absorbs() const {
        return relative_index.imag() > 0 ||
               std::any_of(coatings.begin(), coatings.end(),
                           [](const Coating& of) { return of.relative_index.imag() > 0; });
    }
    /// The largest real index of all layers: it sets the ripple.
    double n() const {
        double largest = relative_index.real();
        for (const Coating& coating : coatings)
            largest = std::max(largest, coating.relative_index.real());
        return largest;
    }
    /// k x: a wave is damped by exp(-2 k x) on its way through the middle of the sphere, and its
    /// resonances are as wide as k x at least. The clearest of layers may have some of its own.
    double damping(double x) const {
        double least = relative_index.imag();
        for (const Coating& coating : coatings)
            least = std::min(least, coating.relative_index.imag());
        return least * x;
    }
    /// Whether rays of the Debye series describe it (RayWaves).
    bool has_rays() const { return is_plain() && relative_index.real() > 1; }

    double outer_x(double x) const {
        double outer = x * std::pow(aspect, aspect < 1 ? -2.0 / 3.0 : 1.0 / 3.0);
        for (const Coating& coating : coatings) outer += coating.thickness + coating.share * x;
        return outer;
    }
    int terms(double x) const { return number_of_terms(outer_x(x)); }

    /// The distance in x after which the ripple of a transparent sphere repeats: atan(s)/s with
    /// s^2 = n^2 - 1 (Chylek 1990, J. Opt. Soc. Am. A 7, 1609, eq. 1); 1 where there is none.
    double ripple_period() const {
        if (!(n() > 1)) return 1;
        const double s = std::sqrt((n() - 1) * (n() + 1));
        return s > 1e-3 ? std::atan(s) / s : 1;
    }
};

}  // namespace miebrdf::mie
