// The radius of polar charts: a value's distance from the centre, and the circles with numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/plot/axis.h"
#include "pipeline/plot/picture.h"

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
    /// Circles with a number, without the centre.
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

// BRDF lobes in the plane of incidence.

/// One curve over the plane of incidence.
struct LobeCurve {
    std::string label;
    /// From the normal: positive on the mirror side (azimuth 0), negative on the source's side
    /// (azimuth 180); ascending, in [-90, 90].
    std::vector<double> angle_deg;
    std::vector<double> value;         ///< one for each angle, >= 0
    double incidence_deg = 0.0;        ///< of the light, in [0, 90); drawn as a ray from the left
    std::optional<double> shade = {};  ///< of the members of a family (panel.h)
};

struct LobeOptions {
    std::string value_label = "BRDF [1/sr]";  ///< or e.g. "BRDF cos \u03b8 [1/sr]"
    bool logarithmic = false;
    int decades = 3;  ///< of a logarithmic radius, 1 to 12
};

/// A half disk: the radius is the value, from 0 or logarithmic over some decades. The source is on
/// the left, the mirror direction on the right.
/// @throws std::invalid_argument  no curve, lengths that differ, angles out of range, nothing
/// positive
Picture draw_lobe(const std::vector<LobeCurve>& curves, const LobeOptions& options,
                  const Caption& caption);

}  // namespace miebrdf::plot
