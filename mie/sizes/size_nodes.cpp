#include "mie/sizes/size_nodes.h"

#include <algorithm>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/lognormal.hpp>
#include <cmath>

#include "mie/sizes/area_density.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

struct MappedRadius {
    double radius_um;
    double slope;  // dr/dt
};

// r(t), t from 0 to 1 over the range, for one distribution; nodes even in t are spread in r as the
// distribution wants them.
template <typename NodeDensity>
class QuantileMap {
  public:
    QuantileMap(NodeDensity density, const RadiusRange& range)
        : density_(density),
          below_(cdf(density, range.smallest_um)),
          share_(cdf(density, range.largest_um) - below_) {}

    MappedRadius operator()(double t) const {
        const double radius = quantile(density_, below_ + t * share_);
        return {radius, share_ / pdf(density_, radius)};
    }

  private:
    NodeDensity density_;
    double below_, share_;
};

// The cube root of a gamma density (shape s, scale c) is one of shape (s + 2)/3 and scale 3 c.
MappedRadius map_gamma(const SizeDistribution& d, const RadiusRange& range, double t) {
    const double shape = 1 / d.effective_variance;
    const boost::math::gamma_distribution<> density(
        (shape + 2) / 3, 3 * d.effective_radius_um * d.effective_variance);
    return QuantileMap(density, range)(t);
}

// The cube root of a log-normal density (location u, variance s) is one of location u + 2 s and
// variance 3 s.
MappedRadius map_log_normal(const SizeDistribution& d, const RadiusRange& range, double t) {
    const double variance = std::log1p(d.effective_variance);
    const boost::math::lognormal_distribution<> density(
        std::log(d.effective_radius_um) + 1.5 * variance, std::sqrt(3 * variance));
    return QuantileMap(density, range)(t);
}

MappedRadius map_radius(const SizeDistribution& d, const RadiusRange& range, double t,
                        SizeSpacing spacing) {
    switch (d.kind) {
        case SizeDistributionKind::gamma:
            return map_gamma(d, range, t);
        case SizeDistributionKind::log_normal:
            return map_log_normal(d, range, t);
        default: {
            if (spacing == SizeSpacing::geometric) {
                const double log_ratio = std::log(range.largest_um / range.smallest_um);
                const double radius = range.smallest_um * std::exp(t * log_ratio);
                return {radius, radius * log_ratio};
            }
            const double width = range.largest_um - range.smallest_um;
            return {range.smallest_um + t * width, width};
        }
    }
}

struct Ramp {
    double t;
    double slope;  // dt/dtau
};

// t(tau): slope rising from 0 over the first `width` of tau, constant, falling at the end. The rise
// is the smoothstep u^4 (35 - 84 u + 70 u^2 - 20 u^3), whose first three derivatives vanish at both
// ends.
Ramp ramp(double tau) {
    constexpr double width = 0.05;  // more nodes are lost to a wider ramp, smoothness to a narrower
    constexpr double plateau = 1 / (1 - width);
    const double from_end = std::min(tau, 1 - tau);
    const double u = std::min(1.0, from_end / width);
    const double slope = plateau * u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u)));
    const double u5 = u * u * u * u * u;
    double t = plateau * width * u5 * (7 + u * (-14 + u * (10 - 2.5 * u)));
    if (from_end > width) t += plateau * (from_end - width);
    return {tau <= 0.5 ? t : 1 - t, slope};
}

}  // namespace

SizeNodes smooth_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int count) {
    const math::Quadrature rule =
        math::gauss_legendre(count, std::log(range.smallest_um), std::log(range.largest_um));
    const AreaDensity area_density(distribution);
    SizeNodes nodes;
    for (int i = 0; i < count; ++i) {
        const double radius = std::exp(rule.nodes[i]);
        nodes.radius_um.push_back(radius);
        nodes.area_share.push_back(rule.weights[i] * radius * area_density(radius));
    }
    return nodes;
}

SizeNodes even_size_nodes(const SizeDistribution& distribution, const RadiusRange& range, int count,
                          double offset, SizeSpacing spacing) {
    const AreaDensity area_density(distribution);
    SizeNodes nodes;
    for (int i = 0; i < count; ++i) {
        const double tau = (i + offset) / count;
        const Ramp ramped = ramp(tau);
        if (!(ramped.slope > 0)) continue;  // the very end carries no weight
        const MappedRadius mapped = map_radius(distribution, range, ramped.t, spacing);
        nodes.radius_um.push_back(mapped.radius_um);
        nodes.area_share.push_back(mapped.slope * ramped.slope / count *
                                   area_density(mapped.radius_um));
    }
    return nodes;
}

SizeNodes nested_size_nodes(const SizeDistribution& distribution, const RadiusRange& range,
                            int first_count, int level, SizeSpacing spacing) {
    if (level == 0) return even_size_nodes(distribution, range, first_count, 1.0, spacing);
    return even_size_nodes(distribution, range, first_count << (level - 1), 0.5, spacing);
}

}  // namespace miebrdf::mie
