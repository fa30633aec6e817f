#include "pipeline/render/cubic_taps.h"

#include <algorithm>

namespace miebrdf::render {

CubicTaps uniform_taps(double x, std::size_t count) {
    const double at = std::clamp(x, 0.0, double(count - 1));
    CubicTaps taps;
    taps.first = std::clamp<std::size_t>(std::size_t(at), 1, count - 3) - 1;
    const double t = at - double(taps.first);  // nodes at 0, 1, 2, 3
    const double a = t, b = t - 1, c = t - 2, d = t - 3;
    taps.weight = {b * c * d / -6, a * c * d / 2, a * b * d / -2, a * b * c / 6};
    return taps;
}

CubicTaps taps_at(double x, std::span<const double> nodes) {
    const double at = std::clamp(x, nodes.front(), nodes.back());
    const auto above = std::upper_bound(nodes.begin(), nodes.end(), at) - nodes.begin();
    CubicTaps taps;
    taps.first = std::clamp<std::size_t>(std::size_t(above), 2, nodes.size() - 2) - 2;
    for (std::size_t k = 0; k < 4; ++k) {
        double weight = 1.0;
        for (std::size_t j = 0; j < 4; ++j) {
            if (j == k) continue;
            const double node = nodes[taps.first + j];
            weight *= (at - node) / (nodes[taps.first + k] - node);
        }
        taps.weight[k] = weight;
    }
    return taps;
}

}  // namespace miebrdf::render
