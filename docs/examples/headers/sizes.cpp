#include <miebrdf/sizes.h>

#include <iostream>

void show_sizes() {
    using namespace miebrdf::mie;
    SizeDistribution droplets;
    droplets.kind = parse_size_distribution("gamma");
    droplets.effective_radius_um = 5;
    droplets.effective_variance = 0.1;
    const RadiusRange whole = radius_range(droplets), most = radius_range(droplets, 1e-3);
    std::cout << name_of(droplets.kind) << (has_variance(droplets.kind) ? " of a variance" : "")
              << " up to " << whole.largest_um << " um; " << area_share_within(droplets, most)
              << " of the area within " << most.smallest_um << " to " << most.largest_um << " um\n";
    std::cout << "mean radius " << mean_radius_power(droplets, 1) << " um, cross-section "
              << mean_cross_section_um2(droplets) << " um2, effective radius "
              << effective_radius_of(droplets) << " um\n";
    for (const SizeDistributionForm& law : size_distribution_forms()) std::cout << law.name << ' ';
    std::cout << '\n';
    const SizeDistributionKind counted = SizeDistributionKind::tabulated;  // n(r) of one's own
    const SizeDistribution table{
        .kind = counted, .radii_um = {1, 2, 3}, .number_density = {0, 1, 0}};
    std::cout << effective_radius_of(table) << " um\n";
}
