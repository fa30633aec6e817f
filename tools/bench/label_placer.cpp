#include "tools/bench/label_placer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace miebrdf::bench {
namespace {

/// Of letters of 8.5 units.
constexpr double kLetterWidth = 4.7, kHeight = 9;
/// A label beyond the edge costs as much as one that covers this area.
constexpr double kOutside = 50;

}  // namespace

double Box::overlap(const Box& other) const {
    const double w = std::min(right, other.right) - std::max(left, other.left);
    const double h = std::min(bottom, other.bottom) - std::max(top, other.top);
    return w > 0 && h > 0 ? w * h : 0.0;
}

Box LabelPlacer::place(double x, double y, std::size_t characters) {
    const double w = kLetterWidth * static_cast<double>(characters) + 2, h = kHeight;
    const std::array<std::pair<double, double>, 8> corners = {{{5, -h - 2},
                                                               {5, 2},
                                                               {-w - 5, -h - 2},
                                                               {-w - 5, 2},
                                                               {-w / 2, -h - 6},
                                                               {-w / 2, 6},
                                                               {7, -h / 2},
                                                               {-w - 7, -h / 2}}};
    Box best{};
    double least = INFINITY;
    for (const auto& [dx, dy] : corners) {
        const Box box{x + dx, y + dy, x + dx + w, y + dy + h};
        const bool is_outside =
            box.right > area_.right || box.left < area_.left || box.bottom > area_.bottom;
        double cost = is_outside ? kOutside : 0;
        for (const Box& other : taken_) cost += box.overlap(other);
        if (cost < least) {
            least = cost;
            best = box;
        }
    }
    taken_.push_back(best);
    return best;
}

}  // namespace miebrdf::bench
