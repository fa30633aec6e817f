// Radii at which averages are differenced: one choice for all numbers.
#pragma once

#include <miebrdf/ensemble.h>

#include <vector>

#include "mie/ensemble/changed_sums.h"
#include "mie/ensemble/particle_ensemble.h"

namespace miebrdf::mie {

struct RadiiRule {
    /// Moments and phase functions settle later than efficiencies, and slopes, which move
    /// resonances, later still: with all of the tolerance in place of the least error that is
    /// stated one by n was off by 42 %, by the variance 3 % (n 2.3 to 2.5, k .001).
    static constexpr int kTimesAsManySizes = 2;
    /// Sizes at most; where there are angles, as many as take about a second.
    static constexpr int kMostSizes = 8192;
    /// A sharp end is spread over a period of interference, or so many of ripple, to both sides,
    /// but over no more than this share of its radius.
    static constexpr double kPeriods = 4, kSizesPerPeriod = 2.5, kWidest = 0.01;
};

/// Radii, and the length of radius that each stands for.
struct Radii {
    std::vector<double> radius_um, length_um;
    bool is_even = false;  ///< equally spaced, because spheres have narrow resonances
};

/// As many as efficiencies need.
/// @param most  sizes
Radii radii_of(const EnsembleRequest& request, double most, const Executor& run);

/// The spheres of all requests at the same radii, and what laws gain at their ends.
class FixedRadii {
  public:
    FixedRadii(const EnsembleRequest& middle, const Radii& radii);

    std::vector<double> radius_um() const;
    SpheresAtRadii spheres(const EnsembleRequest& request) const;
    SpheresChange change(const EnsembleChange& of) const;
    const Ensemble& ensemble() const { return ensemble_; }

  private:
    struct Place {
        double radius_um, length_um, of_smallest, of_largest;
    };

    /// The same optics at another scale of sizes and wavelength, at which n x of every sphere is
    /// that of the middle: where n changes, resonances stay between the same radii, and laws weigh
    /// them otherwise.
    EnsembleRequest with_resonances(EnsembleRequest side) const;

    Ensemble ensemble_;
    double n_;
    const Radii& radii_;
    bool has_ends_;
    std::vector<Place> places_ = {};
};

}  // namespace miebrdf::mie
