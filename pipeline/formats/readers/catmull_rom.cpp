#include "pipeline/formats/readers/catmull_rom.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::exports {
namespace {

/// Values and slopes (times the width) of a spline at both ends of an interval.
struct Segment {
    double f0, f1, d0, d1;

    /// From 0 to t.
    double integral(double t) const {
        return t * (f0 + t * (d0 / 2 + t * ((-2 * d0 - d1) / 3 + f1 - f0 +
                                            t * ((d0 + d1) / 4 + (f0 - f1) / 2))));
    }
};

Segment segment_of(std::span<const float> x, std::span<const double> f, std::size_t i) {
    const double width = double(x[i + 1]) - x[i];
    Segment s{f[i], f[i + 1], f[i + 1] - f[i], f[i + 1] - f[i]};
    if (i > 0) s.d0 = width * (f[i + 1] - f[i - 1]) / (double(x[i + 1]) - x[i - 1]);
    if (i + 2 < x.size()) s.d1 = width * (f[i + 2] - f[i]) / (double(x[i + 2]) - x[i]);
    return s;
}

}  // namespace

std::optional<SplineWeights> spline_weights(std::span<const float> nodes, double x) {
    const std::size_t n = nodes.size();
    if (n < 2 || !(x >= nodes.front() && x <= nodes.back())) return {};
    const auto above = std::upper_bound(nodes.begin(), nodes.end(), x);
    const std::size_t i = std::min<std::size_t>(
        n - 2, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, above - nodes.begin() - 1)));
    const double x0 = nodes[i], x1 = nodes[i + 1], width = x1 - x0;
    if (!(width > 0)) return {};
    const double t = (x - x0) / width, t2 = t * t, t3 = t2 * t;
    SplineWeights w;
    w.offset = static_cast<int>(i) - 1;
    w.weight[1] = 2 * t3 - 3 * t2 + 1;
    w.weight[2] = -2 * t3 + 3 * t2;
    double slope = t3 - 2 * t2 + t;
    if (i > 0) {
        slope *= width / (x1 - nodes[i - 1]);
        w.weight[0] = -slope;
    } else {
        w.weight[1] -= slope;
    }
    w.weight[2] += slope;
    slope = t3 - t2;
    if (i + 2 < n) {
        slope *= width / (nodes[i + 2] - x0);
        w.weight[3] = slope;
    } else {
        w.weight[2] += slope;
    }
    w.weight[1] -= slope;
    return w;
}

double sample_spline(std::span<const float> nodes, std::span<const double> f,
                     std::span<const double> cdf, double u) {
    const double target = u * cdf.back();
    const auto above = std::upper_bound(cdf.begin(), cdf.end(), target);
    const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        above - cdf.begin() - 1, 0, static_cast<std::ptrdiff_t>(cdf.size()) - 2));
    const double width = double(nodes[i + 1]) - nodes[i];
    const Segment segment = segment_of(nodes, f, i);
    const double wanted = width > 0 ? (target - cdf[i]) / width : 0.0;
    // The integral rises with t wherever the spline is positive: bisection cannot run away.
    double low = 0.0, high = 1.0;
    for (int step = 0; step < 50; ++step) {
        const double middle = (low + high) / 2;
        (segment.integral(middle) < wanted ? low : high) = middle;
    }
    return nodes[i] + width * (low + high) / 2;
}

}  // namespace miebrdf::exports
