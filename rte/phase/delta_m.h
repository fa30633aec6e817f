// Separates the forward peak of a phase function, so that few moments describe the rest.
#pragma once

#include <Eigen/Core>

#include <miebrdf/optics.h>

namespace miebrdf::rte {

/// A medium as the discrete equations see it: finitely many moments, light scattered into the
/// forward peak counted as not scattered.
struct ScaledOptics {
    double albedo = 0.0;            ///< alpha' = 1 - one_minus_albedo
    double one_minus_albedo = 1.0;  ///< (1 - alpha) / (1 - alpha f)
    Eigen::VectorXd chi;            ///< chi'_0 = 1 ... chi'_{L-1}
    double truncated = 0.0;         ///< f, the fraction of scattering in the forward peak
    double depth_factor = 1.0;      ///< tau' / tau = 1 - alpha f
    int first_cutoff = 0;           ///< K; the cutoffs averaged over are K ... L, K = L: one only

    /// The share of chi_l that is scaled away with the peak: 0 below K, 1 from L on.
    double share_scaled_away(int degree) const;

    /// alpha' (2l+1) chi'_l, the strength of each degree in the phase matrices.
    Eigen::VectorXd strengths() const;
};

/// delta-M (Wiscombe 1977) with L moments: f = chi_L, chi' = (chi - f) / (1 - f),
/// 1 - alpha' = (1 - alpha) / (1 - alpha f). f is taken as 0 where chi_L is no tail of a forward
/// peak: negative, or not below its neighbours (a backward peak alternates in sign).
///
/// Where a peak is left, the cutoff is soft: f and (1 - f) chi' are means over the cutoffs K ... L,
/// with weights that follow half a wave of a sine.
/// A sharp one leaves a kink at l = L, which rings in angle with the period 360 / L degrees and
/// spoils directions near the forward horizon; K = L (1 - 0.45 s), s the peak's strength, which
/// rises with log f from 0 at f = 1e-4 to 1 at f = 0.2 (docs/numerics.md).
///
/// @param moments  L >= 1; degrees at and above L are dropped (no delta-M) or scaled away
ScaledOptics scale_optics(const Optics& optics, int moments, bool delta_m);

}  // namespace miebrdf::rte
