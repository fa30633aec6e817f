// One panel of scattering angles of a phase table while it is being built.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mie/ensemble/phase_tabulation.h"
#include "mie/ensemble/size_families.h"

namespace miebrdf::mie {

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
    double middle() const { return 0.5 * (lower_ + upper_); }
    bool is_backward() const;                       ///< among glories and the second rainbow
    int generation() const { return generation_; }  ///< times that it was halved
    int level() const { return level_; }            ///< last one added; -1: none

    /// Adds the sums over the next level of sizes at the panel's nodes, part by part (an empty
    /// intensity: that part stays as it is). With ripple, levels
    /// converge slowly, so that families may agree by chance: the noise is not believed to fall by
    /// more than half.
    /// @param options  of these: scattering_efficiency (sizes that miss it have missed resonances
    ///                 too narrow for two families to tell), floor, ray_bias
    /// @param levels  of the parts
    void add_level(const std::vector<FamilyIntensity>& parts, const std::vector<int>& levels,
                   const SizeFamilies& sizes, const PhaseTabulationOptions& options);
    /// Levels of each part to ask for next: at first the parts that are not there yet, then those
    /// whose noise is above `tolerance`, at least the noisiest.
    std::vector<int> next_levels(const SizeFamilies& sizes, double tolerance) const;

    Eigen::VectorXd values() const;
    Eigen::VectorXd values_of(int family) const;  ///< 0 or 1, each normalised by what it scatters
    /// Error of P from its sizes relative to max(P, floor), rms over the nodes, and at the worst of
    /// them.
    double noise() const { return noise_; }
    double worst_noise() const { return worst_noise_; }
    /// The first with what the polynomial leaves out: what a table states.
    double stated_noise() const { return stated_noise_; }
    /// Interpolation error relative to P: last two Chebyshev coefficients. Noise shows in it too.
    double tail() const { return tail_; }
    double tail_of_noise() const { return tail_of_noise_; }

    /// What its noise gives to Legendre moments from `first_moment` on, absolute: nodes err
    /// independently, and |P_l| <= sqrt(2 / (pi l sin)) (Bernstein) damps what lies to the sides.
    double moment_noise(int first_moment) const;
    /// The same from what its polynomial leaves out, about half of the last two coefficients.
    double moment_tail(int first_moment) const;

  private:
    PhasePanel half(double lower, double upper, double smooth) const;
    Eigen::VectorXd part_values(const FamilyIntensity& part) const;
    double solid_angle_of_moments(int first_moment) const;
    /// @param before  values that the last level has changed; those of now: it tells nothing
    void judge(const SizeFamilies& sizes, const PhaseTabulationOptions& options,
               const Eigen::VectorXd& before);

    double lower_, upper_;
    int generation_;
    int level_ = -1;
    bool starts_anew_ = false;  // the last level, for some part
    std::vector<FamilyIntensity> parts_;
    std::vector<int> part_levels_;  // -1: not there yet
    std::vector<double> part_noise_;
    FamilyIntensity sums_;             // over parts
    double whole_[2] = {0, 0};         // what each family scatters: P is relative to it
    double worst_ = 0, relative_ = 0;  // half of what the families differ: at one node, rms
    double noise_ = 0, stated_noise_ = 0, worst_noise_ = 0, tail_ = 0, tail_of_noise_ = 0;
    double rms_ = 0, largest_ = 0;  // noise, and P
};

/// Panels that are `narrowest` wide at 0, `narrowest_backward` at 180 degrees, and grow with the
/// distance from there.
std::vector<PhasePanel> graded_panels(double narrowest, double narrowest_backward);

}  // namespace miebrdf::mie
