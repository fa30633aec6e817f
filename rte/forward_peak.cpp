#include "rte/forward_peak.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace miebrdf::rte {
namespace {

constexpr double sigma = 12.0;  // wider than the beat of a glory in l, narrower than the peak
constexpr int half_window = 48;

// The rest counts when it could move first-order light by this much (times 1 / (1 - alpha f)).
constexpr double negligible = 1e-7;

}  // namespace

ForwardPeak split_forward_peak(std::span<const double> chi, int moments) {
    ForwardPeak split;
    split.first_degree = moments;
    const int count = int(chi.size());
    if (count <= moments + 1) return split;

    std::array<double, 2 * half_window + 1> kernel;
    for (int k = -half_window; k <= half_window; ++k) {
        kernel[std::size_t(k + half_window)] = std::exp(-0.5 * (k / sigma) * (k / sigma));
    }
    std::vector<double> logarithm(chi.size());
    for (int l = 0; l < count; ++l)
        logarithm[std::size_t(l)] = chi[std::size_t(l)] > 0.0 ? std::log(chi[std::size_t(l)]) : 0.0;

    double largest = 0.0;
    for (int l = moments; l < count; ++l) {
        // Near the end the window shrinks on both sides, so that a slope does not become a bias.
        const int reach = std::min({half_window, l, count - 1 - l});
        double weight = 0.0;
        double mean = 0.0;
        double log_mean = 0.0;
        bool positive = true;
        for (int k = -reach; k <= reach; ++k) {
            const std::size_t at = std::size_t(l + k);
            const double w = kernel[std::size_t(k + half_window)];
            weight += w;
            mean += w * chi[at];
            log_mean += w * logarithm[at];
            positive = positive && chi[at] > 0.0;
        }
        const double smooth = positive ? std::exp(log_mean / weight) : mean / weight;
        split.peak.push_back(smooth);
        split.rest.push_back(chi[std::size_t(l)] - smooth);
        largest = std::max(largest, (2.0 * l + 1.0) * std::abs(split.rest.back()));
    }
    if (largest <= negligible) split.rest.clear();
    return split;
}

}  // namespace miebrdf::rte
