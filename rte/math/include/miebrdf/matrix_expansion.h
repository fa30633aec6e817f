// The scattering matrix as a series, but for the phase function.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <miebrdf/language.h>

#pragma GCC visibility push(default)
namespace miebrdf {

/// The scattering matrix of particles without preferred direction
///     F = [[a1, b1, 0, 0], [b1, a2, 0, 0], [0, 0, a3, b2], [0, 0, -b2, a4]]
/// all elements but the phase function a1 = sum (2l + 1) chi_l P_l, in Wigner's functions
/// d^l_mn(Theta) (Legendre's P_l = d^l_00):
///     a4 = sum a4_l d^l_00, a2 + a3 = sum (a2_l + a3_l) d^l_22,
///     a2 - a3 = sum (a2_l - a3_l) d^l_2,-2, b1 = sum b1_l d^l_02, b2 = sum b2_l d^l_02,
/// so that all coefficients contain 2l + 1 (docs/maths-polarisation.md). Each list starts at l = 0;
/// a2, a3, b1, b2 are 0 for l < 2. Lists may be of different lengths: beyond their end they are 0.
struct MatrixExpansion {
    std::vector<double> a2, a3, a4, b1, b2;

    bool operator==(const MatrixExpansion&) const = default;
};

/// Its lists by name.
inline constexpr std::array<std::pair<const char*, std::vector<double> MatrixExpansion::*>, 5>
    kMatrixLists = {{{"a2", &MatrixExpansion::a2},
                     {"a3", &MatrixExpansion::a3},
                     {"a4", &MatrixExpansion::a4},
                     {"b1", &MatrixExpansion::b1},
                     {"b2", &MatrixExpansion::b2}}};

}  // namespace miebrdf
#pragma GCC visibility pop
