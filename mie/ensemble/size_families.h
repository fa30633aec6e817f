// Two families of sizes that sample one distribution without knowing of each other.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/family_intensity.h"
#include "mie/ensemble/ray_families.h"

namespace miebrdf::mie {

/// Where two rays interfere with a period of just one spacing, which happens at some angles, all
/// equally spaced sizes meet the same phase, and so do those halfway between them: n = 2.95,
/// r_eff = 50 um at 550 nm has points of P wrong by 50 % with 2400 sizes. The families' spacings
/// are in the ratio 1.29 : 1.21, so that this happens to one of them at a time, and half of what
/// they differ by tells the error of their mean. (In equal ratios fewer sizes meet one phase, but
/// at every angle some do: with as many sizes, errors are 3 to 5 times larger.)
///
/// Level 0 has 2.5 sizes, both families together, per 3.4 ripple periods; each further level of a
/// family lies halfway between the sizes of those before it.
///
/// Spheres that absorb their ripple converge too fast for that: their sizes, in equal ratios, are
/// one family of 64, 128, ... Its two halves are, at level 0, the sizes at even and at odd places,
/// and then all levels before and the new one.
///
/// By rays P is a sum over parts with families of their own (RayFamilies). Without rays there is
/// one part.
class SizeFamilies {
  public:
    enum class Method { sizes, rays, exact_rays };

    /// @param size_tolerance  of points of P; the finest level follows it
    SizeFamilies(std::complex<double> relative_index, const SizeDistribution& distribution,
                 const RadiusRange& range, double wave_number_per_um, double size_tolerance,
                 Method method = Method::sizes);

    int count() const { return family_count_; }  ///< 2; 1 for a single size
    /// Whether resonances narrower than any level's spacing are left.
    bool rippled() const { return rippled_; }
    /// The finest level: 0.1 in x at a tolerance of 1e-2. A bound on time, not on accuracy.
    int last_level() const { return last_level_; }

    /// Sizes of a level, of both families.
    int sizes_at(int level) const;

    /// Whether a level resolves the interference of reflected and diffracted light, exp(2i x). All
    /// levels do where there is ripple. Families of coarser sizes may agree by chance.
    bool resolves(int level) const { return level >= resolved_level_; }

    int part_count() const { return rays_ ? rays_->part_count() : 1; }
    /// Null: P is not by rays.
    const RayFamilies* rays() const { return rays_ ? &*rays_ : nullptr; }
    /// One level's spheres alone, part by part.
    /// @param levels  one for each part; -1: not wanted
    std::vector<FamilyIntensity> levels(const std::vector<int>& levels,
                                        const AngularFunctionsOf<float>& angular,
                                        const Executor& run);

    /// Keeps waves in memory, as far as it goes: for those that take the same levels several times
    /// at different angles.
    void keep_waves() { waves_.open(); }

    /// Sums over one level's spheres alone, not by rays; the same bits for any executor. Scalar:
    /// float or double.
    template <typename Scalar>
    FamilyIntensity level(int level, const AngularFunctionsOf<Scalar>& angular,
                          const Executor& run);

    /// All levels so far, from those `before` and one more `level`; any number of angles.
    FamilyIntensity with_level(const FamilyIntensity& before, const FamilyIntensity& level) const;

  private:
    WeightedSizes sizes_of(int family, int level) const;

    std::complex<double> relative_index_;
    const SizeDistribution& distribution_;
    RadiusRange range_;
    double wave_number_per_um_;
    bool rippled_;
    std::optional<RayFamilies> rays_ = {};
    int family_count_ = 2;
    int first_counts_[2] = {32, 32};  // sizes of level 0 by family
    int last_level_ = 0, resolved_level_ = 0;
    WaveStore waves_ = {};
};

}  // namespace miebrdf::mie
