#include "mie/sizes/size_refinement.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::mie {
namespace {

constexpr int smooth_start = 16;       // nodes of the first pass where efficiencies are smooth
constexpr int smooth_limit = 256;      // more than this is for the even rule
constexpr double first_spacing = 3.4;  // of the even rule, in ripple periods

}  // namespace

double ripple_period(double index) {
    if (!(index > 1)) return 1;
    const double s = std::sqrt((index - 1) * (index + 1));
    return s > 1e-3 ? std::atan(s) / s : 1;
}

int coarsest_even_count(double index, double width) {
    const double count = width / (first_spacing * ripple_period(index));
    return static_cast<int>(std::clamp(count, 16.0, node_limit / 4.0));
}

SizeRefinement::SizeRefinement(const SizeDistribution& distribution, const RadiusRange& range,
                               std::complex<double> relative_index, double wave_number_per_um)
    : distribution_(distribution),
      range_(range),
      index_(relative_index.real()),
      width_(wave_number_per_um * (range.largest_um - range.smallest_um)) {
    if (distribution.kind == SizeDistributionKind::mono) {
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
        take(smooth_size_nodes(distribution, range, smooth_start));
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
    first_count_ = even_count_ = coarsest_even_count(index_, width_);
    take(nested_size_nodes(distribution_, range_, first_count_, 0));
}

bool SizeRefinement::refine() {
    if (rule_ == Rule::single || nodes_so_far_ >= node_limit) return false;
    ++pass_;
    if (rule_ == Rule::smooth) {
        const int count = smooth_start << pass_;
        if (count > smooth_limit) {
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
