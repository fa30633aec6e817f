// A phase function known at the scattering angles of one request and nowhere else.
#pragma once

#include <vector>

namespace miebrdf {

/// Hands out values computed beforehand; nothing is interpolated. Angles are matched within
/// kMatch_deg, the rounding of going from angle to cosine and back near 0 and 180 degrees.
class PhaseLookup {
  public:
    static constexpr double kMatch_deg = 2e-6;

    /// @param angles_deg  ascending, in [0, 180]; `phase` has one value for each
    PhaseLookup(std::vector<double> angles_deg, std::vector<double> phase);

    /// @throws std::logic_error  for an angle that was not in the list
    double operator()(double cos_theta) const;

  private:
    std::vector<double> angles_deg_;
    std::vector<double> phase_;
};

/// Scattering angles of all combinations of directions, ascending, those closer than kMatch_deg
/// merged. Directions as in rte::Directions.
std::vector<double> scattering_angles_deg(const std::vector<double>& mu_in,
                                          const std::vector<double>& mu_out,
                                          const std::vector<double>& azimuth_deg);

}  // namespace miebrdf
