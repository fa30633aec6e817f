// Catmull-Rom splines on uneven nodes, as pbrt-v3 and layerlab use them (core/interpolation.cpp).
#pragma once

#include <optional>
#include <span>

namespace miebrdf::exports {

/// value(x) = sum_i weight[i] f[offset + i]; entries outside the table have weight 0.
struct SplineWeights {
    int offset = 0;
    double weight[4] = {0, 0, 0, 0};
};

/// Empty outside [nodes.front(), nodes.back()].
std::optional<SplineWeights> spline_weights(std::span<const float> nodes, double x);

/// Draws x with density proportional to the spline through f, whose running integral is `cdf`.
/// @param u  in [0, 1)
double sample_spline(std::span<const float> nodes, std::span<const double> f,
                     std::span<const double> cdf, double u);

}  // namespace miebrdf::exports
