// The source function at requested cosines: how much light each mode sends there.
#pragma once

#include <Eigen/Core>

#include "rte/fourier/transfer_modes.h"
#include "rte/phase/phase_mode.h"
#include "rte/phase/scattering_mode.h"

namespace miebrdf::rte {

/// sum_l a_l Y_l(mu) y_l^T over the degrees of one parity of l - m, requested x n: what scatters
/// into the requested cosines out of s = i_up + i_down (even) and a = i_down - i_up (odd).
struct PhaseRows {
    Eigen::MatrixXd even;
    Eigen::MatrixXd odd;
};
PhaseRows phase_rows(const ScatteringMode& medium, const PhaseMode& mode);

/// The same out of the eigenmodes, requested x K: even F^-T = even V F, and odd F.
class ModeSources {
  public:
    void find(const ScatteringMode& medium, const PhaseMode& mode, const TransferModes& modes);

    Eigen::MatrixXd even;
    Eigen::MatrixXd odd;

  private:
    math::ScratchMatrix weighted_, product_, degrees_;
};

}  // namespace miebrdf::rte
