// Azimuths beside those asked for, by which a solution of few values is judged.
#pragma once

#include <vector>

#include "rte/stack/layered_reflection.h"

namespace miebrdf::rte {

/// Two solutions may agree by accident where few values are asked for and a peak is not resolved
/// yet (HG 0.9 at (0.05, 0.2, 0), 16 and 24 nodes: 1e-5 apart, and both 6e-4 off). Their difference
/// at azimuths beside those tells: 6e-4 at 6 degrees.
class AzimuthProbes {
  public:
    /// Up to 16 values of a stack with slowly falling moments get probes; all others none.
    AzimuthProbes(const Stack& stack, const Directions& asked, const SolverOptions& options);

    /// The directions asked for, with the probes behind the azimuths.
    const Directions& directions() const { return directions_; }
    /// Of values at directions(), those that were asked for.
    std::vector<double> without(std::vector<double> values) const;
    /// Where in those the value at `index` of directions() is, or the one that it is a probe of.
    std::size_t asked_for(std::size_t index) const;

  private:
    Directions directions_;
    std::size_t azimuths_;  ///< asked for
};

}  // namespace miebrdf::rte
