// Mie coefficients of one sphere, laid out for sums over orders.
#pragma once

#include <complex>
#include <vector>

#include "mie/sphere/lanes.h"

namespace miebrdf::mie {

/// a_n, b_n and what they absorb (Coefficients), real and imaginary parts apart: entry n holds
/// order n. Zero at 0 and beyond `terms`, up to whole vectors.
struct PartialWaves {
    explicit PartialWaves(int terms);
    int vectors() const { return (terms + lane_count - 1) / lane_count; }

    int terms;
    std::vector<double> a_re, a_im, b_re, b_im, absorbed;
};

/// Eight orders at once where psi_n(mx) can be taken upward, otherwise by mie_coefficients.
///
/// Cost at x = 1000: docs/maths-mie.md.
/// @throws std::invalid_argument  as mie_coefficients
PartialWaves partial_waves(std::complex<double> relative_index, double size_parameter);

}  // namespace miebrdf::mie
