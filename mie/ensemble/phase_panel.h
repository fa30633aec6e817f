// One panel of scattering angles, with P there from all sizes so far.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "mie/ensemble/paired_size_samples.h"

namespace miebrdf::mie {

/// The error of P by rays that no number of sizes removes, rms over the angles.
struct PhaseRayBias {
    /// Relative to max(P, AverageLimits::kDim). 0: P is not to be computed by rays (no RayBound).
    double everywhere = 0;
    /// The share that rays of different ways p and q leave at sharp ends of the sizes, relative to
    /// the root of the sum of P_p P_q over p != q.
    double ends = 0;

    double typical() const { return everywhere + 0.3 * ends; }
};

/// The purpose of P, as tolerances.
struct PhaseGoal {
    double interpolation_tolerance = 1e-3;  ///< relative to the largest P of each panel
    double size_tolerance = 1e-2;  ///< relative to max(P, floor), rms over the nodes of each panel
    double floor = 0;
    double least_noise = 0;         ///< that is stated
    int first_moment = 0;           ///< lowest one that will be asked of the table
    int last_moment = -1;           ///< highest one; -1: none
    double moment_tolerance = 1.0;  ///< absolute, of what each panel gives to a moment
    /// Scattering efficiency of the average times the area share of the range, when known; 0: not.
    /// Sizes that miss it have missed resonances too narrow for two samples to tell.
    double scattering_efficiency = 0;
    PhaseMethod method = PhaseMethod::sizes;
    PhaseRayBias ray_bias = {};  ///< part of the noise by rays, relative to max(P, floor)
    double most_work = std::numeric_limits<double>::infinity();  ///< EnsembleRequest::phase_work
};

/// P at the nodes of [lower, upper] from all levels of sizes so far, and how good it is.
class PhasePanel {
  public:
    PhasePanel(double lower, double upper, int generation)
        : lower_(lower), upper_(upper), generation_(generation) {}

    /// The panel from here to its middle, or from there on. Parts of P whose polynomial is as good
    /// as `smooth` (absolute) keep the values that it has there; the others begin anew.
    PhasePanel lower_half(double smooth) const { return half(lower_, middle(), smooth); }
    PhasePanel upper_half(double smooth) const { return half(middle(), upper_, smooth); }

    double lower() const { return lower_; }  ///< radians
    double upper() const { return upper_; }
    double width() const { return upper_ - lower_; }
    double middle() const { return 0.5 * (lower_ + upper_); }
    bool is_backward() const;                       ///< among glories and the second rainbow
    int generation() const { return generation_; }  ///< times that it was halved
    int level() const { return level_; }            ///< last one added; -1: none

    /// Adds the sums over the next level of sizes at the panel's nodes, part by part (an empty
    /// intensity: that part stays as it is).
    /// @param goal    of these: scattering_efficiency, floor, ray_bias
    /// @param levels  of the parts
    void add_level(const std::vector<PairedIntensity>& parts, const std::vector<int>& levels,
                   const PairedSizeSamples& sizes, const PhaseGoal& goal);
    /// Levels of each part to ask for next: at first the parts that are not there yet, then those
    /// whose noise is above `tolerance`, at least the noisiest.
    std::vector<int> next_levels(const PairedSizeSamples& sizes, double tolerance) const;

    Eigen::VectorXd values() const;
    Eigen::VectorXd values_of(int sample) const;  ///< 0 or 1, each normalised by what it scatters
    /// Error of P from its sizes relative to max(P, floor), rms over the nodes, and at the worst of
    /// them.
    double noise() const { return noise_; }
    double worst_noise() const { return worst_noise_; }
    /// The share of the noise that no number of sizes removes: what rays leave out.
    double bias() const { return bias_; }
    /// Interpolation error relative to P: last two Chebyshev coefficients. Noise shows in it too.
    double tail() const { return tail_; }
    double tail_of_noise() const { return tail_of_noise_; }

    /// The part that its noise has in Legendre moments from `first_moment` on, absolute: nodes err
    /// independently, and |P_l| <= sqrt(2 / (pi l sin)) (Bernstein) damps what lies to the sides.
    double moment_noise(int first_moment) const;
    /// The part that its polynomial leaves out of them: about half of the last two coefficients.
    double moment_tail(int first_moment) const;

  private:
    PhasePanel half(double lower, double upper, double smooth) const;
    Eigen::VectorXd part_values(const PairedIntensity& part) const;
    double solid_angle_of_moments(int first_moment) const;
    /// @param before  values that the last level has changed; those of now: it tells nothing
    void judge(const PairedSizeSamples& sizes, const PhaseGoal& goal,
               const Eigen::VectorXd& before);
    void judge_parts(const PairedSizeSamples& sizes, const Eigen::VectorXd& scale);
    Eigen::VectorXd bias_at_nodes(const PairedSizeSamples& sizes, const PhaseGoal& goal,
                                  const Eigen::VectorXd& scale) const;

    double lower_, upper_;
    int generation_;
    int level_ = -1;
    std::vector<PairedIntensity> parts_;
    std::vector<int> part_levels_;  // -1: not there yet
    std::vector<double> part_noise_;
    PairedIntensity sums_;             // over parts
    double whole_[2] = {0, 0};         // what each sample scatters: P is relative to it
    double worst_ = 0, relative_ = 0;  // half of what the samples differ: at one node, rms
    double noise_ = 0, worst_noise_ = 0, bias_ = 0;
    double tail_ = 0, tail_of_noise_ = 0;
    double rms_ = 0, largest_ = 0;  // noise, and P
};

/// Panels that are `narrowest` wide at 0, `narrowest_backward` at 180 degrees, and grow with the
/// distance from there.
std::vector<PhasePanel> graded_panels(double narrowest, double narrowest_backward);

}  // namespace miebrdf::mie
