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
    constexpr double kPlateau = 1 / (1 - kRamp);
    const double from_end = std::min(tau, 1 - tau);
    const double u = std::min(1.0, from_end / kRamp);
    const double slope = kPlateau * u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u)));
    const double u5 = u * u * u * u * u;
    double t = kPlateau * kRamp * u5 * (7 + u * (-14 + u * (10 - 2.5 * u)));
    if (from_end > kRamp) t += kPlateau * (from_end - kRamp);
    return {tau <= 0.5 ? t : 1 - t, slope};
}

constexpr int kSmoothStart = 16;       // nodes of the first pass where efficiencies are smooth
constexpr int kSmoothLimit = 256;      // more than this is for the even rule
constexpr double kFirstSpacing = 3.4;  // of the even rule, in ripple periods
// Nodes of its first pass at most: where there are thousands of periods, ripple averages out over
// fewer sizes than one for each of them, and each pass says how far.
constexpr int kMostFirst = 256;

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
            distribution.kind.law().radius_at(distribution, range, ramped.t, spacing);
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

double ripple_period(double index) {
    if (!(index > 1)) return 1;
    const double s = std::sqrt((index - 1) * (index + 1));
    return s > 1e-3 ? std::atan(s) / s : 1;
}

int coarsest_even_count(double index, double width) {
    const double count = width / (kFirstSpacing * ripple_period(index));
    return static_cast<int>(std::clamp(count, 16.0, kNodeLimit / 4.0));
}

SizeRefinement::SizeRefinement(const SizeDistribution& distribution, const RadiusRange& range,
                               std::complex<double> relative_index, double wave_number_per_um)
    : distribution_(distribution),
      range_(range),
      index_(relative_index.real()),
      width_(wave_number_per_um * (range.largest_um - range.smallest_um)) {
    if (distribution.kind.law().single_size) {
        rule_ = Rule::single;
        take({{range.largest_um}, {1.0}});
        return;
    }
    // Resonances in size are as wide as k x at least: beyond 1, or for small spheres, nothing is
    // narrow.
    const double x_effective = wave_number_per_um * effective_radius_of(distribution);
    const bool damped = relative_index.imag() * x_effective > 1;
    const bool small = wave_number_per_um * range.largest_um < 3;
    if (damped || small) {
        rule_ = Rule::smooth;
        take(smooth_size_nodes(distribution, range, kSmoothStart));
    } else {
        start_even();
    }
}

void SizeRefinement::take(SizeNodes nodes) {
    nodes_ = std::move(nodes);
    nodes_so_far_ += static_cast<int>(nodes_.radius_um.size());
}

void SizeRefinement::start_even() {
    rule_ = Rule::even;
    pass_ = 0;
    // Halved: the spacings that the ripple likes come later in the same series.
    first_count_ = coarsest_even_count(index_, width_);
    while (first_count_ > kMostFirst) first_count_ /= 2;
    even_count_ = first_count_;
    take(nested_size_nodes(distribution_, range_, first_count_, 0));
}

bool SizeRefinement::refine() {
    if (rule_ == Rule::single || nodes_so_far_ >= kNodeLimit) return false;
    ++pass_;
    if (rule_ == Rule::smooth) {
        const int count = kSmoothStart << pass_;
        if (count > kSmoothLimit) {
            start_even();
        } else {
            take(smooth_size_nodes(distribution_, range_, count));
        }
        return true;
    }
    if (pass_ > 1) even_count_ *= 2;
    take(nested_size_nodes(distribution_, range_, first_count_, pass_));
    return true;
}

}  // namespace miebrdf::mie
