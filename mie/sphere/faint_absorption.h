// Spheres that absorb next to nothing.
#pragma once

#include <complex>

namespace miebrdf::mie {

/// Absorption is proportional to k long before it alters a wave. What it is summed from has k as a
/// factor, and where k nears the smallest numbers no digits: the sums' terms no longer match, and
/// spheres of k = 1e-320 absorbed less than nothing. They are computed with a larger k, and absorb
/// their share of that.
struct FaintAbsorption {
    explicit FaintAbsorption(std::complex<double> relative_index) : index(relative_index) {
        // Room for both: k times x^3 of the smallest spheres, and k beside 1.
        constexpr double kLeast = 1e-150;
        const double k = relative_index.imag();
        if (!(k > 0 && k < kLeast)) return;
        index.imag(kLeast);
        share = k / kLeast;
    }

    std::complex<double> index;  ///< to compute with
    double share = 1;            ///< of what is absorbed then
};

}  // namespace miebrdf::mie
