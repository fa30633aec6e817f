// Two families of sizes that sample one distribution without knowing of each other.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <miebrdf/ensemble.h>
#include "mie/ensemble/ray_columns.h"
#include "mie/ensemble/ray_weights.h"

namespace miebrdf::mie {

/// Intensities from each family, angles x 2, and what its spheres scatter; their sums are the mean
/// over both. The second family is empty where there is one size only.
struct FamilyIntensity {
    Eigen::MatrixXd intensity;
    double scattered[2] = {0, 0};
    /// Of the mean over this level and those before it: 1 where those are no longer needed.
    double share = 0.5;
};

/// Of sums over parts at many angles (an empty intensity: not that part) those at `count` of them.
std::vector<FamilyIntensity> at_some_angles(const std::vector<FamilyIntensity>& parts,
                                            Eigen::Index first, Eigen::Index count);

/// Waves of one block of sizes, once they are computed.
struct KeptWaves {
    SphereBlockOf<float> block = {};
    double scattered = 0;
    bool is_there = false;
};

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
/// By rays (ray_phase.h), P is a sum over parts, one for each group of rays. Each part has two
/// families of its own: at level 0 eight sizes each by rules for smooth integrands, then levels in
/// equal ratios with weights for what interferes at the angle (ray_weights.h). What they differ by
/// is what interference within a group leaves. Only in single precision. Without rays there is one
/// part.
///
/// Where a distribution ends sharply, rays of different ways do not average out there: what they
/// leave is the error of P by rays. With `exact_rays` each ray is weighted by RayWindow, and what
/// the window leaves of the sizes at either end is one more part, of whole spheres; far rays are
/// summed in closed form (far_rays.h). That takes longer for many angles.
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

    int part_count() const;
    /// Whether a part has rays of one number of ways through the sphere alone.
    bool is_one_ray(std::size_t part) const {
        return part < groups_.size() && groups_[part].first_way == groups_[part].last_way;
    }
    /// What part `i` may err by at some angles, by rays: its families of few sizes, which differ by
    /// so much there (in P), may agree by chance where rays interfere, and at all angles that are
    /// close together.
    double believed_of_few(std::size_t i, int level, double lower_theta, double upper_theta,
                           double difference, double value) const;
    /// One level's spheres alone, part by part.
    /// @param levels  one for each part; -1: not wanted
    std::vector<FamilyIntensity> levels(const std::vector<int>& levels,
                                        const AngularFunctionsOf<float>& angular,
                                        const Executor& run);

    /// Keeps waves in memory, as far as it goes: for those that take the same levels several times
    /// at different angles.
    void keep_waves() { keeps_waves_ = true; }

    /// Sums over one level's spheres alone, not by rays; the same bits for any executor. Scalar:
    /// float or double.
    template <typename Scalar>
    FamilyIntensity level(int level, const AngularFunctionsOf<Scalar>& angular,
                          const Executor& run);

    /// All levels so far, from those `before` and one more `level`; any number of angles.
    FamilyIntensity with_level(const FamilyIntensity& before, const FamilyIntensity& level) const;

  private:
    WeightedSizes sizes_of(int family, int level) const;
    std::vector<FamilyIntensity> levels_of_rays(const std::vector<int>& levels,
                                                const AngularFunctionsOf<float>& angular,
                                                const Executor& run);

    using Factors = AngularFunctionsOf<float>::Factors;
    struct RayPiece;
    int sizes_of_piece() const;
    void sum(RayPiece& piece, const AngularFunctionsOf<float>& angular) const;

    void add_end(int part, int level, const AngularFunctionsOf<float>& angular, const Executor& run,
                 FamilyIntensity& to);

    std::complex<double> relative_index_;
    const SizeDistribution& distribution_;
    RadiusRange range_;
    double wave_number_per_um_;
    bool rippled_;
    std::vector<RayGroup> groups_;          // none: not by rays
    std::optional<RayWindow> window_ = {};  // of rays without ends
    std::unique_ptr<const RaySizes> ray_sizes_ = {};
    std::unique_ptr<const RayInterference> interference_ = {};
    int family_count_ = 2;
    int first_counts_[2] = {32, 32};  // sizes of level 0 by family
    int last_level_ = 0, resolved_level_ = 0;

    // Where they are or may be put; null: they are not kept.
    KeptWaves* place_of(int group, int family, int level, int first_size, double bytes);

    bool keeps_waves_ = false;
    std::map<std::array<int, 4>, KeptWaves> kept_ = {};  // by group, family, level, first size
    double kept_bytes_ = 0;
};

}  // namespace miebrdf::mie
