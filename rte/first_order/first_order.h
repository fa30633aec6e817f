// Light scattered exactly once: known in closed form for any phase function and any layers, and
// summed at all directions of a request.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

/// cos Theta = -mu_in mu_out + sqrt(1-mu_in^2) sqrt(1-mu_out^2) cos(azimuth), kept in [-1, 1].
double cos_scattering_angle(double mu_in, double mu_out, double cos_azimuth);

/// P(cos Theta) of the medium: its own function if it has one, else the sum of all its moments.
double exact_phase(const Optics& optics, double cos_theta);

/// alpha P / (1 - alpha f) of one medium: what light that reaches it scatters once.
/// @param exact  as of single_scattering
double first_order_strength(const ScaledMedium& medium, bool exact, double cos_theta);

/// How much the strength of each medium counts at a pair of cosines; the same at every azimuth.
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

/// Whether light comes back within 5 degrees of where it came from.
/// Order: [(in * mu_out.size() + out) * azimuth_deg.size() + azimuth]
std::vector<bool> near_retro_reflection(const Directions& directions);

/// Adds what is scattered once to reflection functions: exactly (TMS), or as the discrete equations
/// see it, by SolverOptions::single_scattering_correction.
///
/// Exact phase functions do not depend on the number of nodes, nor does what their narrow features
/// scatter from degrees on that delta-M cuts off: both are evaluated once, at the first call, and
/// kept (8 bytes for each direction, and as many for each medium).
class FirstOrderSum {
  public:
    /// @param directions  must outlive this
    FirstOrderSum(const Directions& directions, const SolverOptions& options);

    /// @param media       of the same stack at every call; delta-M may differ
    /// @param reflection  [(in * mu_out.size() + out) * azimuth_deg.size() + azimuth], added to
    /// @param unresolved  null, or set to the part of narrow features that the nodes do not
    /// resolve,
    ///                    known but roughly; empty: there is none
    void add_to(std::vector<double>& reflection, const std::vector<ScaledMedium>& media,
                std::vector<double>* unresolved = nullptr);

  private:
    /// Of degrees that depend on the nodes.
    void add_narrow_features(std::vector<double>& reflection,
                             const std::vector<ScaledMedium>& media,
                             std::vector<double>* unresolved) const;
    /// Whether these media, too, have what is kept.
    bool has_kept(const std::vector<ScaledMedium>& media) const;
    void keep(const std::vector<ScaledMedium>& media);
    void keep_narrow_features(const std::vector<ScaledMedium>& media);

    const Directions& directions_;
    SolverOptions options_;
    std::vector<double> cos_azimuth_;
    double mu_least_ = 1.0;
    /// Narrow features from this degree on are kept.
    int first_kept_ = std::numeric_limits<int>::max();
    std::vector<ForwardPeak> kept_;  ///< of each medium, from that degree on
    std::vector<double> narrow_;     ///< what they scatter, at each direction; none: empty
    /// Exact P of each medium but for them: phase_[medium * directions + direction].
    std::vector<double> phase_;
};

}  // namespace miebrdf::rte
