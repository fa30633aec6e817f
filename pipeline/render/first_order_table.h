// Light scattered once in a stack of layers, at any directions, for all wavelengths at once.
#pragma once

#include <span>
#include <vector>

#include "rte/single_scattering.h"

namespace miebrdf::render {

/// rte::single_scattering with the exact phase functions read from tables over the scattering
/// angle: nodes 0.03 degrees apart at 0 and 180, 0.6 degrees in the middle. Glories, rainbows and forward peaks live here: what is scattered more than once is smooth.
class FirstOrderTable {
  public:
    /// @param stacks  for each wavelength the media from the bottom up
    explicit FirstOrderTable(const std::vector<std::vector<rte::ScaledMedium>>& stacks);

    /// Adds to R at each wavelength.
    void add(double mu_in, double mu_out, double cos_azimuth, std::span<double> reflection) const;

  private:
    struct Layer {
        double optical_depth;  ///< tau', infinite for a half-space
        std::size_t row;       ///< of phase_: alpha / (1 - alpha f) P
    };
    std::vector<double> angles_deg_;
    std::vector<std::vector<Layer>> stacks_;  ///< for each wavelength, from the top down
    std::vector<std::vector<double>> phase_;
};

}  // namespace miebrdf::render
