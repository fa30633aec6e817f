#include "rte/grid/discretisation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace miebrdf::rte {
namespace {

// chi_n above this: between 2n/3 and n nodes the error does not fall geometrically yet.
constexpr double slow_above = 1e-3;

std::size_t most_moments(const Stack& stack) {
    std::size_t most = stack.base_kind == BaseKind::half_space ? stack.base.chi.size() : 1;
    for (const Coat& coat : stack.coats) most = std::max(most, coat.optics.chi.size());
    return most;
}

// What lists that were cut short allow (Optics::has_more_moments).
std::size_t most_usable_moments(const Stack& stack) {
    std::size_t most = most_moments(stack);
    const auto limit = [&](const Optics& optics) {
        if (!optics.has_more_moments) return;
        most = std::min(most, std::max<std::size_t>(1, optics.chi.size() - 1));
    };
    if (stack.base_kind == BaseKind::half_space) limit(stack.base);
    for (const Coat& coat : stack.coats) limit(coat.optics);
    return most;
}

// Of that degree, over all media.
double largest_moment(const Stack& stack, int degree) {
    double largest = 0.0;
    const auto look_at = [&](const Optics& optics) {
        const auto l = std::size_t(degree);
        if (l < optics.chi.size()) largest = std::max(largest, optics.chi[l]);
    };
    if (stack.base_kind == BaseKind::half_space) look_at(stack.base);
    for (const Coat& coat : stack.coats) look_at(coat.optics);
    return largest;
}

}  // namespace

bool converges_slowly(const Stack& stack, int streams) {
    return largest_moment(stack, streams) > slow_above;
}

Discretisation choose_discretisation(const Stack& stack, const SolverOptions& options,
                                     int streams) {
    Discretisation choice;
    choice.grid = options.grid == GridKind::automatic ? GridKind::mapped_gauss : options.grid;
    choice.streams = streams;
    // Half-range Gauss integrates products of two degrees up to l + l' <= 2n - 1. What is beyond
    // has decayed by l = 2n, or the soft cutoff of delta-M lets it fade (docs/numerics.md).
    choice.moments = int(std::min(most_usable_moments(stack), std::size_t(2 * streams)));
    return choice;
}

std::vector<int> stream_ladder(const Stack& stack, const SolverOptions& options) {
    const int steps[] = {8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256};
    const bool simple = most_moments(stack) <= 8;
    const int start = simple ? 8 : options.tolerance >= 1e-3 ? 16 : 24;
    std::vector<int> ladder;
    for (const int n : steps) {
        if (n >= start) ladder.push_back(n);
    }
    return ladder;
}

int coarser_streams(int streams) {
    return streams > 3 ? std::max(2, 2 * streams / 3) : streams + 1;
}

// What is below a coat as deep as this does not show in double precision, absorbing or not.
constexpr double deepest_coat = 1e100;

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
