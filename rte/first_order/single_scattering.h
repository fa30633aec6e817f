// Light scattered exactly once: known in closed form for any phase function and any layers.
#pragma once

#include <span>
#include <vector>

#include <miebrdf/optics.h>
#include "rte/phase/delta_m.h"
#include "rte/phase/forward_peak.h"

namespace miebrdf::rte {

/// One medium of a stack, its phase function exact and as the discrete equations see it.
struct ScaledMedium {
    Optics exact;
    ScaledOptics scaled;
    double optical_depth = 0.0;  ///< tau', scaled by delta-M; infinite for a half-space
    ForwardPeak narrow = {};     ///< degrees beyond delta-M; without a rest where it does not apply
};

/// cos Theta = -mu_in mu_out + sqrt(1-mu_in^2) sqrt(1-mu_out^2) cos(azimuth), kept in [-1, 1].
double cos_scattering_angle(double mu_in, double mu_out, double cos_azimuth);

/// P(cos Theta) of the medium: its own function if it has one, else the sum of all its moments.
double exact_phase(const Optics& optics, double cos_theta);

/// alpha P / (1 - alpha f) of one medium: what light that reaches it scatters once.
/// @param exact  as below
double first_order_strength(const ScaledMedium& medium, bool exact, double cos_theta);

/// What the strength of each medium counts at a pair of cosines, whatever the azimuth.
/// @param weights  one for each medium
void first_order_weights(const std::vector<ScaledMedium>& media, double mu_in, double mu_out,
                         std::span<double> weights);

/// First order of a stack of media, listed from the bottom up (the lowest may be infinitely deep):
/// sum of alpha P / (1 - alpha f) (1 - exp(-tau' q)) / (4 (mu_in + mu_out)) weakened by what lies
/// above, q = 1/mu_in + 1/mu_out.
/// @param exact  true: the exact phase function (Nakajima & Tanaka 1988, TMS); false: the moments
///               that the discrete equations use
double single_scattering(const std::vector<ScaledMedium>& media, bool exact, double mu_in,
                         double mu_out, double cos_azimuth);

}  // namespace miebrdf::rte
