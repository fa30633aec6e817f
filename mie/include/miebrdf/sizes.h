// How the radii of the spheres in an ensemble are distributed.
#pragma once

#include <vector>

namespace miebrdf::mie {

enum class SizeDistributionKind { power_law, gamma, log_normal, mono, tabulated };

/// A size distribution n(r) given by its two cross-section-weighted parameters (Hansen & Travis
/// 1974, eq. 2.53-2.56): effective radius <r^3>/<r^2> and effective variance.
/// power_law: n(r) ~ r^-3 on [r1, r2]; gamma: r^((1-3b)/b) exp(-r/(a b)); log_normal:
/// sigma^2 = ln(1 + b); mono: every sphere has the effective radius; tabulated: n(r) as listed.
struct SizeDistribution {
    SizeDistributionKind kind = SizeDistributionKind::power_law;
    double effective_radius_um = 50.0;  ///< > 0
    double effective_variance = 0.2;    ///< > 0, up to 10; ignored for mono
    /// For tabulated only: number density n(r) in any unit at ascending radii, linear between them
    /// and zero outside; radius and variance above are then ignored.
    std::vector<double> radii_um = {};
    std::vector<double> number_density = {};
};

/// Smallest and largest radius of a distribution, in micrometres.
struct RadiusRange {
    double smallest_um;
    double largest_um;
};

/// Ends of the power law: r1 + r2 = 2 r_eff (1 + v_eff), (r2 - r1) / ln(r2 / r1) = r_eff.
/// For gamma and log-normal: where the cross-section weighted tail falls below rounding.
///
/// @throws std::invalid_argument  for a radius or a variance that is not positive and finite
RadiusRange radius_range(const SizeDistribution& distribution);

/// The same, with gamma and log-normal cut where `tail` of the scattering is left out on either
/// side: spheres scatter as their area, but below `saturation_radius_um` (that of x = 1) as r^6,
/// where a few large ones weigh far more than their area does.
/// @param tail  in [1e-18, 0.1]
/// @param saturation_radius_um  >= 0; 0: tail of the geometric cross-section
RadiusRange radius_range(const SizeDistribution& distribution, double tail,
                         double saturation_radius_um = 0);

/// Share of the geometric cross-section within a range: below 1 for gamma and log-normal, which
/// have no ends.
double area_share_within(const SizeDistribution& distribution, const RadiusRange& range);

/// <r^3>/<r^2>: of a table its own, otherwise the parameter.
double effective_radius_of(const SizeDistribution& distribution);

}  // namespace miebrdf::mie
