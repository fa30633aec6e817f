#include "mie/sizes/size_nodes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

struct Ramp {
    double t;
    double slope;  // dt/dtau
};

// t(tau): slope rising from 0 over the first `width` of tau, constant, falling at the end. The rise
// is the smoothstep u^4 (35 - 84 u + 70 u^2 - 20 u^3), whose first three derivatives vanish at both
// ends.
Ramp ramp(double tau) {
    constexpr double kRamp = 0.05;  // more nodes are lost to a wider ramp, smoothness to a narrower
    constexpr double plateau = 1 / (1 - kRamp);
    const double from_end = std::min(tau, 1 - tau);
    const double u = std::min(1.0, from_end / kRamp);
    const double slope = plateau * u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u)));
    const double u5 = u * u * u * u * u;
    double t = plateau * kRamp * u5 * (7 + u * (-14 + u * (10 - 2.5 * u)));
    if (from_end > kRamp) t += plateau * (from_end - kRamp);
    return {tau <= 0.5 ? t : 1 - t, slope};
}

}  // namespace

SizeNodes smooth_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int count) {
    const math::Quadrature rule =
        math::gauss_legendre(count, std::log(range.smallest_um), std::log(range.largest_um));
    const std::unique_ptr<const AreaDensity> density = area_density(distribution);
    SizeNodes nodes;
    for (int i = 0; i < count; ++i) {
        const double radius = std::exp(rule.nodes[i]);
        nodes.radius_um.push_back(radius);
        nodes.area_share.push_back(rule.weights[i] * radius * density->at(radius));
    }
    return nodes;
}

SizeNodes even_size_nodes(const SizeDistribution& distribution, const RadiusRange& range, int count,
                          double offset, SizeSpacing spacing) {
    const std::unique_ptr<const AreaDensity> density = area_density(distribution);
    SizeNodes nodes;
    for (int i = 0; i < count; ++i) {
        const double tau = (i + offset) / count;
        const Ramp ramped = ramp(tau);
        if (!(ramped.slope > 0)) continue;  // the very end carries no weight
        const MappedRadius mapped =
            SizeLaw::of(distribution.kind).radius_at(distribution, range, ramped.t, spacing);
        nodes.radius_um.push_back(mapped.radius_um);
        nodes.area_share.push_back(mapped.slope * ramped.slope / count *
                                   density->at(mapped.radius_um));
    }
    return nodes;
}

SizeNodes nested_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int first_count, int level, SizeSpacing spacing) {
    if (level == 0) return even_size_nodes(distribution, range, first_count, 1.0, spacing);
    return even_size_nodes(distribution, range, first_count << (level - 1), 0.5, spacing);
}

}  // namespace miebrdf::mie
