// Moments and P of spheres with few partial waves, from the same sizes: P is a polynomial, known
// everywhere by its values at Gauss nodes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/size_sums.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {

/// Moments from the intensity at Gauss nodes in cos(angle), for ensembles whose bands of products
/// would be as wide as they are long. P has the degree 2 * terms, so that nothing but rounding is
/// lost. Each size takes as many multiply-adds as 8 * terms * nodes, where a band with all moments
/// has twice as few, but takes terms^3 after each pass.
class GaussMoments {
  public:
    /// @param terms           partial waves of the largest sphere
    /// @param highest_moment  0 to 2 * terms
    GaussMoments(int terms, int highest_moment, bool single_precision, const Executor& run);

    const AngularTables& angles() const { return angles_; }
    Eigen::Map<const Eigen::ArrayXd> cosines() const {
        return {rule_.nodes.data(), Eigen::Index(rule_.nodes.size())};
    }
    /// chi_0 ... chi_highest from what the angles have summed, times an unknown factor.
    std::vector<double> of(const Eigen::VectorXd& intensity) const;

  private:
    int highest_;
    math::Quadrature rule_;
    AngularTables angles_;
};

/// Whether all moments and P cost about as much as the spheres themselves.
bool has_phase_series(const Ensemble& ensemble);

/// Efficiencies, moments and the table of P.
EnsembleOptics average_phase_series(const EnsembleRequest& request, const Ensemble& ensemble,
                                    const Executor& run);

/// P at single angles, from as many sizes as all nodes around these angles need.
PhaseValues phase_series_at_angles(const EnsembleRequest& request, const Ensemble& ensemble,
                                   const Executor& run);

}  // namespace miebrdf::mie
