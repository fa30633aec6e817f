// Two samples of the sizes of one distribution that know nothing of each other.
#pragma once

#include <optional>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/paired_intensity.h"
#include "mie/ensemble/paired_ray_samples.h"
#include "mie/ensemble/size_refinement.h"

namespace miebrdf::mie {

/// By which sums P is found: over whole spheres, or over rays (PairedRaySamples), these with or
/// without what rays of different ways leave at sharp ends of the sizes.
enum class PhaseMethod { sizes, rays, exact_rays };

/// Where two rays interfere with a period of just one spacing, which happens at some angles, all
/// equally spaced sizes meet the same phase, and so do those halfway between them: n = 2.95,
/// r_eff = 50 um at 550 nm has points of P wrong by 50 % with 2400 sizes. The samples' spacings
/// are in the ratio 1.29 : 1.21, so that this happens to one of them at a time, and half of what
/// they differ by tells the error of their mean. (In equal ratios fewer sizes meet one phase, but
/// at every angle some do: with as many sizes, errors are 3 to 5 times larger.)
///
/// At level 0 the sizes of each sample are some two in x apart; each further level lies halfway
/// between the sizes of those before it.
///
/// Spheres that absorb their ripple converge too fast for that: their sizes, in equal ratios, are
/// one sample of 64, 128, ... Its two halves are, at level 0, the sizes at even and at odd places,
/// and then all levels before and the new one.
///
/// By rays P is a sum over parts with samples of their own (PairedRaySamples). Without rays there
/// is one part.
class PairedSizeSamples {
  public:
    /// @param ensemble  must outlive this
    explicit PairedSizeSamples(const Ensemble& ensemble, PhaseMethod method = PhaseMethod::sizes);

    int count() const { return sample_count_; }  ///< 2; 1 for a single size
    /// Whether resonances narrower than any level's spacing are left.
    bool rippled() const { return rippled_; }
    /// The finest level, of SizeRule::kMostEven sizes: a bound on time, not on accuracy.
    int last_level() const { return last_level_; }

    /// Sizes of a level, of both samples.
    int sizes_at(int level) const;

    /// Whether a level resolves the interference of reflected and diffracted light, exp(2i x). All
    /// levels do where there is ripple. Samples of coarser sizes may agree by chance.
    bool resolves(int level) const { return level >= resolved_level_; }

    int part_count() const { return rays_ ? rays_->part_count() : 1; }
    /// Null: P is not by rays.
    const PairedRaySamples* rays() const { return rays_ ? &*rays_ : nullptr; }

    /// The intensities of one level's spheres alone, part by part; the same bits for any executor.
    /// Waves are kept for the next angles, as far as memory goes, and many angles go in blocks.
    /// @param levels         one for each part; -1: not wanted
    /// @param in_double      precision of sums by sizes; 1e-5 of P at worst in single precision, in
    ///                       half the time. Rays have single precision only.
    std::vector<PairedIntensity> levels(const std::vector<int>& levels,
                                        const std::vector<double>& angles_deg, bool in_double,
                                        const Executor& run);

    /// All levels so far, from those `before` and one more `level`; any number of angles.
    PairedIntensity with_level(const PairedIntensity& before, const PairedIntensity& level) const;

  private:
    WeightedSizes sizes_of(int sample, int level) const;
    template <typename Scalar>
    PairedIntensity level(int level, const AngularFunctionsOf<Scalar>& angular,
                          const Executor& run);

    const Ensemble& ensemble_;
    bool rippled_;
    std::optional<PairedRaySamples> rays_ = {};
    int sample_count_ = 2;
    int first_counts_[2] = {1, 0};  // sizes of level 0 by sample
    int last_level_ = 0, resolved_level_ = 0;
    WaveStore waves_ = {};
};

}  // namespace miebrdf::mie
