// How the radii of the spheres in an ensemble are distributed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <miebrdf/language.h>

#pragma GCC visibility push(default)
namespace miebrdf::mie {

struct SizeLaw;  // private

/// Which law a size distribution follows: one of size_distribution_forms(), Junge's or a table.
/// Cheap to copy and to compare.
class SizeDistributionKind {
  public:
    static const SizeDistributionKind power_law, gamma, log_normal, mono, junge, tabulated;
    bool operator==(const SizeDistributionKind&) const = default;

  private:
    friend struct SizeLaw;
    explicit constexpr SizeDistributionKind(const SizeLaw& law) : law_(&law) {}

    const SizeLaw* law_;
};

/// The law of this name: "power-law", "gamma", ... A table has no name to ask for.
/// @throws UsageError  naming all that are known
SizeDistributionKind parse_size_distribution(std::string_view name);
std::string name_of(SizeDistributionKind kind);
/// Whether the effective variance means anything to the law.
bool has_variance(SizeDistributionKind kind);

/// How a law is asked for by name, and what it is.
struct SizeDistributionForm {
    std::string name, help;
};
/// All laws but Junge's and the table, which have numbers of their own.
std::vector<SizeDistributionForm> size_distribution_forms();

/// A size distribution n(r) given by its two cross-section-weighted parameters (Hansen & Travis
/// 1974, eq. 2.53-2.56): effective radius <r^3>/<r^2> and effective variance. Each law is written
/// down in docs/maths-mie.md.
struct SizeDistribution {
    SizeDistributionKind kind = SizeDistributionKind::power_law;
    double effective_radius_um = 50.0;  ///< > 0
    double effective_variance = 0.2;    ///< > 0, up to 10; ignored where has_variance() is false
    /// For tabulated only: number density n(r) in any unit at ascending radii, linear between them
    /// and zero outside; radius and variance above are then ignored. Of junge the two limits.
    std::vector<double> radii_um = {};
    std::vector<double> number_density = {};  ///< any unit, >= 0
    double exponent = 4.0;                    ///< of junge: n(r) ~ r^-exponent, 0 to 10
};

/// Smallest and largest radius of a distribution, in micrometres.
struct RadiusRange {
    double smallest_um;
    double largest_um;
};

/// The ends of a distribution; where a law has none, where its cross-section weighted tail falls
/// below rounding.
///
/// @throws UsageError  for a radius or a variance out of range, or a table that is none
RadiusRange radius_range(const SizeDistribution& distribution);

/// The ends, with laws that have none cut where `tail` of the scattering is left out on either
/// side: spheres scatter as their area, but below `saturation_radius_um` (that of x = 1) as r^6,
/// where a few large ones weigh far more than their area does.
/// @param tail  in [1e-18, 0.1]
/// @param saturation_radius_um  >= 0; 0: tail of the geometric cross-section
RadiusRange radius_range(const SizeDistribution& distribution, double tail,
                         double saturation_radius_um = 0);

/// Share of the geometric cross-section within a range: below 1 for laws that have no ends.
double area_share_within(const SizeDistribution& distribution, const RadiusRange& range);

/// <r^power>, the mean over the number of particles, in powers of um.
/// @throws UsageError  for distributions whose number of small particles has no limit
double mean_radius_power(const SizeDistribution& distribution, int power);

/// <pi r^2>, the mean over the number of particles.
/// @throws UsageError  for distributions whose number of small particles has no limit
double mean_cross_section_um2(const SizeDistribution& distribution);

/// <r^3>/<r^2>: of a table its own, otherwise the parameter.
double effective_radius_of(const SizeDistribution& distribution);

}  // namespace miebrdf::mie
#pragma GCC visibility pop
