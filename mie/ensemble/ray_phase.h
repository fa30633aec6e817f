// The phase function of broad distributions by rays of the Debye series.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/size_sums.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {

/// The sizes of one level of a group, in each of two samples: Gauss and Radau rules for the area
/// of the distribution, or a nested series in equal ratios.
struct RaySizeRule {
    int counts[2];
    int nested_level;  ///< of the series; -1: Gauss and Radau

    bool is_smooth() const { return nested_level < 0; }
    bool operator==(const RaySizeRule&) const = default;
};

/// Rays that leave after first_way ... last_way ways through the sphere.
struct RayGroup {
    int first_way, last_way;  ///< last_way 0: all further ones, summed with `phases` phases; 0
                              ///< phases: in closed form (far_rays.h)
    int phases = 0;

    RaySizeRule sizes_at(int level) const;
    bool is_closed() const { return last_way == 0 && first_way > 0 && phases == 0; }
    /// Whether each column has rays of one number of ways.
    bool is_way_by_way() const { return phases == 0 && !is_closed(); }
    int columns() const { return phases > 0 ? phases : is_closed() ? 1 : last_way - first_way + 1; }
};

/// Groups of rays of which P is the incoherent sum:
///     P(theta) = sum_p <|S_p(theta)|^2>.
/// Rays of many ways are summed as T R^(p-1) e^(i phi) / (1 - R e^(i phi)) with equally spaced
/// phases phi, which leaves the products of rays `phases` ways apart; the phases of the next size
/// are shifted, so that these average out, too.
///
/// Where one ray of a number of ways comes to an angle, its intensity is smooth in size, and eight
/// sizes of a Gauss rule give it to 1e-5 or better: that is so at most angles for most groups
/// (docs/internals/mie-log.md). Where several come and interfere, more sizes in equal ratios are
/// weighted angle by angle (ray_weights.h).
/// @param exact  far rays in closed form
std::vector<RayGroup> ray_groups(bool exact = false);

/// A weight of sizes that falls from 1 to 0 at both ends of a range, with its first three
/// derivatives: the product of two rays whose phases differ by 2 (n - 1) x or more averages out to
/// below 1e-4 under it.
class RayWindow {
  public:
    RayWindow(double index, double smallest_x, double largest_x);

    double at(double x) const;
    double width() const { return width_; }  ///< in x, of each fall

  private:
    double smallest_, largest_, width_;
};

/// The sizes that rays are averaged over (PairedRaySamples).
class RaySizes {
  public:
    /// @param ensemble  must outlive this
    RaySizes(const Ensemble& ensemble, const std::optional<RayWindow>& window);

    /// Few sizes of a nested series miss some of the area at the ends, which all then make up for,
    /// since what a ray scatters goes with the area.
    WeightedSizes of(const RaySizeRule& rule, int sample) const;
    double smallest_x() const { return ensemble_.smallest_x(); }
    double largest_x() const { return ensemble_.largest_x(); }
    /// The area of the sizes about x, per x, under the window.
    double area_at(double x) const;

  private:
    const Ensemble& ensemble_;
    std::optional<RayWindow> window_;
    std::unique_ptr<const AreaDensity> density_;
    math::Quadrature area_;  // of all sizes, under the window, over ln r
    double whole_area_ = 0;
};

}  // namespace miebrdf::mie
