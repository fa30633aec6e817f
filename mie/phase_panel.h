// One panel of scattering angles of a phase table while it is being built.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace miebrdf::mie {

/// Intensities of two independent halves of the sizes, angles x 2, and what they scatter.
struct HalvedIntensity {
    Eigen::MatrixXd intensity;
    double scattered[2] = {0, 0};
};

/// P at the nodes of [lower, upper] from all levels of sizes so far, and how good it is.
class PhasePanel {
  public:
    PhasePanel(double lower, double upper, int generation)
        : lower_(lower), upper_(upper), generation_(generation) {}

    double lower() const { return lower_; }  ///< radians
    double upper() const { return upper_; }
    int generation() const { return generation_; }  ///< times that it was halved
    int level() const { return level_; }            ///< last one added; -1: none

    /// Adds the next level of sizes: as many as all before, between them.
    /// @param rippled  levels converge slowly, so that one of them may agree with those before by
    ///                 chance: the noise is not believed to fall by more than half
    /// @param scattering_efficiency  of the average, 0 when not known: sizes that miss it have
    ///                 missed resonances too narrow for two levels to tell
    /// @param floor  errors are relative to P where that is larger, else to this
    void add_level(const Eigen::MatrixXd& intensity, const double (&scattered)[2], bool rippled,
                   double scattering_efficiency, double floor);

    Eigen::VectorXd values() const;
    /// Error of P from its sizes relative to max(P, floor), rms over the nodes, and at the worst of
    /// them.
    double noise() const { return noise_; }
    double worst_noise() const { return worst_noise_; }
    /// Interpolation error relative to P: last two Chebyshev coefficients. Noise shows in it too.
    double tail() const { return tail_; }
    double tail_of_noise() const { return tail_of_noise_; }

    /// What its noise gives to Legendre moments from `first_moment` on, absolute: nodes err
    /// independently, and |P_l| <= sqrt(2 / (pi l sin)) (Bernstein) damps what lies to the sides.
    double moment_error(int first_moment) const;

  private:
    void judge(bool rippled, double scattering_efficiency, double floor);

    double lower_, upper_;
    int generation_;
    int level_ = -1;
    HalvedIntensity halves_;
    double worst_ = 0, relative_ = 0;  // what the last level changed: at one node, rms
    double noise_ = 0, worst_noise_ = 0, tail_ = 0, tail_of_noise_ = 0;
    double moment_noise_ = 0;  // times solid angle over 4 pi
};

/// Panels that are `narrowest` wide at both ends and grow with the distance from them.
std::vector<PhasePanel> graded_panels(double narrowest);

}  // namespace miebrdf::mie
