// The scattering of a medium in each degree, as the discrete equations for polarised light see it.
#pragma once

#include <Eigen/Core>

namespace miebrdf::rte {

struct ScaledMedium;

/// alpha' times the expansion coefficients of the scattering matrix after delta-M (2l + 1
/// included), and the block of I and Q in its own axes:
///     [[a1, b1], [b1, a2]] = first v v^T + second w w^T, v = (cosine, sine), w = (-sine, cosine),
/// and [[a3, -b2], [-b2, -a4]] likewise as upper and lower with the circular ones.
/// One element for each degree l = 0 ... L - 1.
struct MatrixStrengths {
    Eigen::VectorXd a3, a4, b2;
    Eigen::VectorXd first, second;
    Eigen::VectorXd cosine, sine;
    Eigen::VectorXd upper, lower;
    Eigen::VectorXd circular_cosine, circular_sine;

    /// Whether V is coupled to U.
    bool has_b2() const { return b2.size() > 0 && b2.cwiseAbs().maxCoeff() > 0.0; }
};

/// delta-M of the whole matrix: light in the forward peak is not scattered, whatever its
/// polarisation. With the cutoff of ScaledOptics, K ... L, and x_l in units of 2l + 1: of a2 and a3
/// (l >= 2) and a4 is taken away what is taken from chi_l, of b1 and b2 the share that is cut off.
MatrixStrengths matrix_strengths(const ScaledMedium& medium);

}  // namespace miebrdf::rte
