// A medium as the discrete equations see it: the forward peak of its phase function, which few
// moments cannot describe, counts as light that is not scattered.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

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
/// with weights that follow half a wave of a sine. A sharp cutoff leaves a kink at l = L, which
/// rings in angle with the period 360 / L degrees and spoils directions near the forward horizon; K
/// = L (1 - 0.45 s), s the peak's strength, which rises with log f from 0 at f = 1e-4 to 1 at f =
/// 0.2 (docs/numerics.md).
///
/// @param moments  L >= 1; degrees at and above L are dropped (no delta-M) or scaled away
ScaledOptics scale_optics(const Optics& optics, int moments, bool delta_m);
/// @param scaled  overwritten; its memory is used again
/// @param like    null, or scaled optics whose cutoffs are taken, as of moments a little different
void scale_optics(const Optics& optics, int moments, bool delta_m, ScaledOptics& scaled,
                  const ScaledOptics* like = nullptr);

/// Moments chi_l, l >= L, split into the smooth forward peak F_l and the structure N_l (glory,
/// rainbows).
///
/// delta-M treats light in the peak as not scattered, so first-order light of TMS carries the full
/// glory of transparent spheres, although most of it was diffracted by an angle wider than the
/// glory before or after. Narrow features of degree l are only fed by what stays narrow at that
/// degree: they get 1 / (1 - alpha F_l) in place of 1 / (1 - alpha f).
struct ForwardPeak {
    int first_degree = 0;           ///< L
    std::vector<double> peak;       ///< F_l, l = L, L + 1, ...
    std::vector<double> structure;  ///< N_l = chi_l - F_l; empty when there is nothing to correct
};

/// F_l is the running Gaussian mean of chi over l, sigma 12 degrees; geometric where chi is
/// positive throughout the window, which makes it exact for Henyey-Greenstein, and arithmetic from
/// the first degree on where it is not; one turns into the other over 97 degrees.
///
/// @param chi      all moments
/// @param moments  L, the first degree that is split
/// @param cutoff   the first that delta-M cuts off, if that is another
ForwardPeak split_forward_peak(std::span<const double> chi, int moments, int cutoff = 0);

inline constexpr int kResolvedAngles = 33;

/// One medium of a stack, its phase function exact and as the discrete equations see it.
struct ScaledMedium {
    Optics exact;
    ScaledOptics scaled;
    double scaled_optical_depth = 0.0;  ///< tau', by delta-M; infinite for a half-space
    /// Degrees that delta-M cuts off: the forward peak, and narrow structure (glory, bows) if any.
    ForwardPeak narrow = {};
    double index = 1.0;  ///< refractive index as far as boundaries see it: 1 where there is none
    /// Shares of degrees that the nodes do not resolve near retro-reflection, [degree][angle of
    /// zenith, kResolvedAngles in equal steps to the horizon]; none: whatever moments describe, or
    /// `narrow` has no structure.
    std::vector<double> unresolved_shares = {};
};

}  // namespace miebrdf::rte
