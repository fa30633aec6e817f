// A phase function between the angles at which it was computed.
#pragma once

#include <functional>
#include <vector>

namespace miebrdf::exports {

/// Angles for a phase function that millions of directions will ask for: every 0.5 degrees, and
/// 0.05 degrees where large particles have their diffraction peak and their glory.
std::vector<double> phase_table_angles_deg();

/// Monotone cubic (PCHIP) in the angle: never negative, no overshoot beside a peak.
class PhaseTable {
  public:
    /// @param phase  asked at each of angles_deg, ascending from 0 to 180
    PhaseTable(std::vector<double> angles_deg,
               const std::function<double(double cos_theta)>& phase);

    double operator()(double cos_theta) const { return interpolate_(cos_theta); }

    /// Root mean square relative error of every second value when interpolated from its neighbours,
    /// with half the density: an upper bound of what the table misses where it is smooth.
    double error_estimate() const { return error_estimate_; }

  private:
    std::function<double(double)> interpolate_;
    double error_estimate_ = 0.0;
};

}  // namespace miebrdf::exports
