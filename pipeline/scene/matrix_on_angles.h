// Scattering matrices as tables over angles: between the angles, as coefficients, and whether a
// particle can have them.
#pragma once

#include <miebrdf/optics.h>

#include <array>
#include <string>
#include <vector>

namespace miebrdf {

/// A phase function at angles and, where they are known, the other elements over it.
struct MatrixOnAngles {
    static constexpr std::size_t kRatios = 5;  ///< a2, a3, a4, b1, b2

    std::vector<double> angles_deg;  ///< ascending, 0 ... 180
    std::vector<double> phase;       ///< in any unit
    std::vector<double> ratios;      ///< at all angles, one list after the other; or empty

    /// log P and the ratios are linear in the angle; P itself beside zeros.
    rte::ScatteringMatrix at(double angle_deg) const;
};

/// Optics with all moments and coefficients that are not small, and the table as exact function;
/// the mean of P becomes 1.
rte::Optics optics_of_table(MatrixOnAngles table, double albedo);

/// The smallest eigenvalue of the coherency matrix: one below 0 belongs to no particle, nor to a
/// sum of particles (Cloude 1986; Hovenier & van der Mee 1996, J. Quant. Spectrosc. Radiat.
/// Transfer 55, 649).
double lowest_eigenvalue(const rte::ScatteringMatrix& matrix);

/// Of matrices that were measured, traced by rays or printed with few digits, over a1.
inline constexpr double kMatrixNoise = 0.01;

/// What is wrong with a matrix that no particle can have, for a message; empty: nothing.
/// @param noise  of its elements, in the unit of a1
std::string impossible_matrix(const rte::ScatteringMatrix& matrix, double angle_deg, double noise);

}  // namespace miebrdf
