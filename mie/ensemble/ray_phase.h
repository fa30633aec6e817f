// The phase function of broad distributions by rays of the Debye series.
#pragma once

#include <vector>

#include "mie/sizes/size_law.h"

namespace miebrdf::mie {

struct WeightedSizes;

/// Rays that leave after first_way ... last_way ways through the sphere, and how many sizes they
/// take at level 0, in each of two families.
struct RayGroup {
    int first_way, last_way;  ///< last_way 0: all further ones, summed with `phases` phases; 0
                              ///< phases: in closed form (far_rays.h)
    int sizes[2];
    bool is_smooth;  ///< few rays come to one angle: sizes by Gauss and Fejer rules in ln r
    int phases = 0;

    /// Both in columns: waves of both can be computed together.
    bool has_sizes_of(const RayGroup& other) const {
        return !is_closed() && !other.is_closed() && sizes[0] == other.sizes[0] &&
               sizes[1] == other.sizes[1] && is_smooth == other.is_smooth;
    }
    bool is_closed() const { return last_way == 0 && first_way > 0 && phases == 0; }
    int columns() const { return phases > 0 ? phases : is_closed() ? 1 : last_way - first_way + 1; }
};

/// Groups of rays of which P is the incoherent sum:
///     P(theta) = sum_p <|S_p(theta)|^2>.
/// Rays of many ways are summed as T R^(p-1) e^(i phi) / (1 - R e^(i phi)) with equally spaced
/// phases phi, which leaves the products of rays `phases` ways apart; the phases of the next size
/// are shifted, so that these average out, too. Counts: half a per cent of max(P, 1/2), rms over
/// the angles, for each group (docs/internals/mie-log.md).
/// @param has_ends  whether the law of sizes ends sharply
/// @param exact     far rays in closed form, and no rules for smooth integrands: sizes may be
/// weighted
///                  by a RayWindow
std::vector<RayGroup> ray_groups(double index, bool has_ends, bool exact = false);

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

/// Sizes of one family of a group at a level (SizeFamilies).
/// @param window  null: none; few sizes (but for smooth rules) miss some of the area at the ends,
///                which all then make up for, since what a ray scatters goes with the area
WeightedSizes ray_sizes(const RayGroup& group, const SizeDistribution& distribution,
                        const RadiusRange& range, double wave_number_per_um, int family, int level,
                        const RayWindow* window);

}  // namespace miebrdf::mie
