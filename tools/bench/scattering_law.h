// A phase function that photons can be scattered by: its value and its inverse distribution.
#pragma once

#include <vector>

namespace miebrdf::bench {

/// Normalised so that the mean over the sphere is 1. A value type; owes nothing to rte/.
class ScatteringLaw {
  public:
    static ScatteringLaw isotropic();
    static ScatteringLaw rayleigh();
    /// @param asymmetry  g in (-1, 1)
    static ScatteringLaw henyey_greenstein(double asymmetry);
    /// Linear in cos Theta between the given points, normalised to mean 1.
    /// @param cos_theta  strictly ascending from -1 to 1
    /// @param value      P >= 0, not all 0
    /// @throws std::invalid_argument  for anything else
    static ScatteringLaw tabulated(std::vector<double> cos_theta, std::vector<double> value);

    double value(double cos_theta) const;

    /// cos Theta below which the fraction `u` in (0, 1) of the light is scattered.
    double sample(double u) const;

    /// Mean of cos Theta.
    double asymmetry() const;

  private:
    enum class Kind { isotropic, rayleigh, henyey_greenstein, tabulated };
    explicit ScatteringLaw(Kind kind) : kind_(kind) {}

    Kind kind_;
    double g_ = 0.0;
    std::vector<double> cos_theta_, value_, cumulative_;
};

}  // namespace miebrdf::bench
