// A law of size distributions tells averages this much. A new law is a file that fills
// in a SizeLaw, and its name in the list of size_laws.cpp.
#pragma once

#include <memory>

#include <miebrdf/sizes.h>

namespace miebrdf::mie {

/// How the geometric cross-section of an ensemble is shared out over the radii.
class AreaDensity {
  public:
    virtual ~AreaDensity() = default;
    /// Share per micrometre of radius: n(r) r^2 over its integral, inside the law's range.
    virtual double at(double radius_um) const = 0;
};

/// A radius as a function of t, which runs from 0 to 1 over the range of radii.
struct MappedRadius {
    double radius_um;
    double slope;  ///< dr/dt
};

/// How the sizes of a law that leaves it open are spread: equally, as ripple wants it (all
/// resonances of one family are met alike), or in equal ratios, as averages that are smooth in size
/// want it.
enum class SizeSpacing { equal, geometric };

void require_radius_and_variance(const SizeDistribution& distribution);
MappedRadius evenly_spread(const SizeDistribution& distribution, const RadiusRange& range, double t,
                           SizeSpacing spacing);

/// The functions are called with distributions that `validate` has accepted.
struct SizeLaw {
    static const SizeLaw& of(SizeDistributionKind kind) { return *kind.law_; }
    constexpr SizeDistributionKind kind() const { return SizeDistributionKind(*this); }

    const char* name;  ///< "log-normal"
    const char* help;  ///< n(r), in a line

    bool has_variance = true;  ///< false: the effective variance is ignored
    bool single_size = false;  ///< all spheres have the effective radius: no density is asked for
    bool has_ends = true;      ///< false: averages choose how much of the tails they leave out
    /// False: bends of the density leave something of the interference of rays.
    bool is_without_bends = true;

    /// @throws UsageError
    void (*validate)(const SizeDistribution&) = require_radius_and_variance;
    /// Works as radius_range() does; laws that have ends ignore tail and saturation radius.
    RadiusRange (*range)(const SizeDistribution&, double tail, double saturation_radius_um);
    std::unique_ptr<const AreaDensity> (*area_density)(const SizeDistribution&) = nullptr;
    double (*area_share_within)(const SizeDistribution&, const RadiusRange&) =
        [](const SizeDistribution&, const RadiusRange&) { return 1.0; };
    double (*effective_radius_um)(const SizeDistribution&) = [](const SizeDistribution& d) {
        return d.effective_radius_um;
    };
    /// The radius beyond which spheres have this share of the light diffracted straight on, which
    /// goes with n r^4. Laws with ends leave nothing out.
    double (*forward_radius_um)(const SizeDistribution&, double share) = [](const SizeDistribution&,
                                                                            double) { return 0.0; };
    /// Where even rules put their sizes. For laws without ends the density of sizes follows the
    /// cube root of the area density: the least error of a rule whose error goes with the square of
    /// the spacing.
    MappedRadius (*radius_at)(const SizeDistribution&, const RadiusRange&, double t,
                              SizeSpacing) = evenly_spread;
};

/// @throws UsageError  as radius_range; and for a single size, which has no density
std::unique_ptr<const AreaDensity> area_density(const SizeDistribution& distribution);

}  // namespace miebrdf::mie
