// A medium whose b2 couples V to U: its equations are no longer symmetric, and what the eigenmodes
// are to the others, a matrix close to their rates is to this one.
#pragma once

#include <Eigen/Core>

#include "rte/fourier/eigenmodes.h"
#include "rte/stokes/stokes_mode.h"

namespace miebrdf::rte {

/// With J = diag(1, 1, 1, -1): U^T = J U J, V^T = J V J, and Z V Z = U still has the wanted
/// solution, J Z symmetric. In the eigenmodes of the symmetric parts, F = diag(F_l, F_c) (l: the
/// rows of I, Q and U, c: those of V),
///     F^T V F = I + [[0, w], [-w^T, 0]],  F^-1 U F^-T = k^2 + [[0, u], [-u^T, 0]],
///     F^-1 Z F^-T = [[S, K], [-K^T, T]], S and T symmetric,
/// found by Newton's method with the derivative of b2 = 0: dZ_ij = (U - Z V Z)_ij / (k_i + k_j).
class CoupledModes {
  public:
    /// @param block  ends with V
    /// @param grid, requested  once each
    /// @param tolerance  of the changes, relative
    /// @return false where the equations have no physical solution or the steps do not converge
    bool find(const StokesTables& tables, const StokesBlock& block, const MatrixStrengths& medium,
              double one_minus_albedo, const ZenithGrid& grid, const RequestedDirections& requested,
              double tolerance);

    const Eigenmodes& linear() const { return linear_.eigenmodes(); }
    const Eigenmodes& circular() const { return circular_.eigenmodes(); }
    /// S, K, T of F^-1 Z F^-T.
    Eigen::MatrixXd S, K, T;
    /// F^T V Z F^-T: the field s inside a half-space, F^T V a elsewhere, is exp(-rates tau) of that
    /// on top. Close to diag(k).
    Eigen::MatrixXd rates;
    /// F^-T = V F of the symmetric parts.
    Eigen::MatrixXd inverse_linear, inverse_circular;
    int steps = 0;

  private:
    void form_couplings(const StokesTables& tables, const StokesBlock& block,
                        const MatrixStrengths& medium, const ZenithGrid& grid);
    bool iterate(double tolerance);

    EigenmodeSolver linear_, circular_;
    FourierMode linear_mode_, circular_mode_;
    FourierMedium linear_medium_, circular_medium_;
    Eigen::MatrixXd omega_, upsilon_;  ///< w, u
    Eigen::MatrixXd R11_, R12_, R22_, SW_, KW_;
};

}  // namespace miebrdf::rte
