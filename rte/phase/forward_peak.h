// The part of a phase function that delta-M cannot see: what is narrow, but not forward.
#pragma once

#include <span>
#include <vector>

namespace miebrdf::rte {

/// Moments chi_l, l >= L, split into the smooth forward peak F_l and the rest N_l (glory,
/// rainbows).
///
/// delta-M treats light in the peak as not scattered, so first-order light of TMS carries the full
/// glory of transparent spheres, although most of it was diffracted by an angle wider than the
/// glory before or after. Narrow features of degree l are only fed by what stays narrow at that
/// degree: they get 1 / (1 - alpha F_l) in place of 1 / (1 - alpha f).
struct ForwardPeak {
    int first_degree = 0;      ///< L
    std::vector<double> peak;  ///< F_l, l = L, L + 1, ...
    std::vector<double> rest;  ///< N_l = chi_l - F_l; empty when there is nothing to correct
};

/// F_l is the running Gaussian mean of chi over l, sigma 12 degrees; geometric where chi is
/// positive throughout the window, which makes it exact for Henyey-Greenstein.
///
/// @param chi      all moments
/// @param moments  L
ForwardPeak split_forward_peak(std::span<const double> chi, int moments);

}  // namespace miebrdf::rte
