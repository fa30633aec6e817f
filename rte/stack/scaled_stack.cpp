#include "rte/stack/scaled_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace miebrdf::rte {
namespace {

// What is below a coat as deep as this does not show in double precision, absorbing or not.
constexpr double deepest_coat = 1e100;

}  // namespace

ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m) {
    ScaledStack scaled;
    scaled.moments = moments;
    scaled.base = stack.base_kind;
    scaled.ground_albedo = stack.ground_albedo;
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const auto add = [&](const Optics& optics, double optical_depth) {
        ScaledOptics medium = scale_optics(optics, moments, delta_m);
        // The light through a lossless coat falls with its depth, whose square must not overflow.
        const double most = std::isinf(optical_depth) ? infinite : deepest_coat;
        const double depth = std::min(optical_depth * medium.depth_factor, most);
        ForwardPeak narrow;
        if (medium.truncated > 0.0) {
            narrow = split_forward_peak(optics.chi, medium.first_cutoff);
        }
        scaled.media.push_back({optics, std::move(medium), depth, std::move(narrow)});
    };
    if (stack.base_kind == BaseKind::half_space) add(stack.base, infinite);
    for (const Coat& coat : stack.coats) {
        if (coat.optical_depth == 0.0) continue;
        if (std::isinf(coat.optical_depth)) {
            scaled.media.clear();
            scaled.base = BaseKind::half_space;
        }
        add(coat.optics, coat.optical_depth);
    }
    return scaled;
}

}  // namespace miebrdf::rte
