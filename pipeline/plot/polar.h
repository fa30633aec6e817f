// The radius of polar charts: a value's distance from the centre, and the circles with numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/plot/axis.h"

namespace miebrdf::plot {

/// Maps values to [0, 1]; smaller ones than the scale shows lie in the centre.
class RadialScale {
  public:
    RadialScale(const AxisOptions& options, const std::vector<double>& values)
        : axis_(options, values) {}

    double radius(double value) const {
        const double position = axis_.position(value);
        return std::isfinite(position) ? std::clamp(position, 0.0, 1.0) : 0.0;
    }
    /// Those with a number, without the centre.
    std::vector<Tick> circles() const {
        std::vector<Tick> circles;
        for (const Tick& tick : axis_.ticks()) {
            if (!tick.label.empty() && axis_.position(tick.value) > 0.05) circles.push_back(tick);
        }
        return circles;
    }

  private:
    Axis axis_;
};

/// Options of a radius from 0, or over `decades` below the power of ten above the largest value.
inline AxisOptions radial_options(const std::string& label, bool logarithmic, int decades,
                                  double largest) {
    if (!logarithmic) return {label, Scale::linear, 0.0};
    const double top = std::pow(10.0, std::ceil(std::log10(largest) - 1e-9));
    return {label, Scale::logarithmic, top * std::pow(10.0, -decades), top};
}

}  // namespace miebrdf::plot
