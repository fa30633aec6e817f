// R between requested cosines from Ambartsumian's or Chandrasekhar's functions.
#pragma once

#include <Eigen/Core>

#include "rte/math/scratch.h"
#include "rte/phase/phase_mode.h"

namespace miebrdf::rte {

/// Sums of sum_l s_l phi_l(mu_out) phi_l(mu_in) with phi = first + extra, without first * first:
/// that is the first order of scattering, which is known in closed form and would cancel digits.
class PairProducts {
  public:
    /// @param strengths  s_l
    /// @param extra      at all requested cosines
    /// @param first_out  at the outgoing ones; first_in at the incident ones
    /// @param sum        out x in, added to
    void add(const Eigen::Ref<const Eigen::VectorXd>& strengths,
             const Eigen::Ref<const Eigen::MatrixXd>& extra,
             const Eigen::Ref<const Eigen::MatrixXd>& first_out,
             const Eigen::Ref<const Eigen::MatrixXd>& first_in,
             const RequestedDirections& requested, Eigen::MatrixXd& sum);

    /// Subtracts the same with `direct` * first in place of first: what light that has been
    /// weakened on its way loses. One factor for each requested cosine.
    void subtract_below(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                        const Eigen::Ref<const Eigen::MatrixXd>& extra,
                        const Eigen::Ref<const Eigen::VectorXd>& direct,
                        const Eigen::Ref<const Eigen::MatrixXd>& first_out,
                        const Eigen::Ref<const Eigen::MatrixXd>& first_in,
                        const RequestedDirections& requested, Eigen::MatrixXd& sum);

  private:
    /// Fills extra_out_, extra_in_ and weighted_ = s_l extra_in_.
    void gather(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                const Eigen::Ref<const Eigen::MatrixXd>& extra,
                const RequestedDirections& requested);

    math::ScratchMatrix extra_out_, extra_in_, weighted_, product_;
};

/// Divides by 4 (mu_out + mu_in).
void divide_by_cosines(const RequestedDirections& requested, Eigen::MatrixXd& reflection);

}  // namespace miebrdf::rte
