// P on panels of scattering angles that refine themselves: as a table, or at points.
#pragma once

#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/phase_panel.h"

namespace miebrdf::mie {

struct TabulatedPhase {
    PhaseTable table;
    double moment_error = 0;  ///< absolute, of the table's moments from first_moment to last_moment
};

/// Each panel of scattering angles takes levels of sizes (PairedSizeSamples) until the two samples
/// agree within the tolerance: most panels need the first one only, interferences in step with a
/// sample's spacing and some glories two or three. Panels whose polynomial has not converged (its
/// last two Chebyshev coefficients are above the tolerance and above the noise of the sizes) are
/// halved, and the halves start anew, but for parts of P that the polynomial has, together with all
/// others of their generation.
///
/// A panel is done where its noise is within the tolerance, at the finest level of sizes, and where
/// more sizes gain nothing because the noise is what rays leave out.
class AdaptivePhase {
  public:
    /// All arguments must outlive this.
    AdaptivePhase(const Ensemble& ensemble, const PhaseGoal& goal, const Executor& run)
        : ensemble_(ensemble), goal_(goal), run_(run) {}

    /// All angles. Neighbours share the value at their common edge: that of the panel with more
    /// sizes. In single precision.
    TabulatedPhase table() const;

    /// Single angles, each from the polynomial of its panel; a single size is computed at the
    /// angles themselves. What rays cannot give within the tolerance is left to sizes.
    /// @param allowed  absolute error of P at each angle, where what it is for knows of all of
    /// them;
    ///                 empty: size_tolerance, relative to max(P, floor)
    PhaseValues at(const std::vector<double>& angles_deg, const std::vector<double>& allowed) const;

  private:
    const Ensemble& ensemble_;
    const PhaseGoal& goal_;
    const Executor& run_;
};

}  // namespace miebrdf::mie
