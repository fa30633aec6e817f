#include "rte/phase/forward_peak.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

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

    const Eigen::VectorXd kernel =
        (-0.5 / (sigma * sigma) *
         Eigen::ArrayXd::LinSpaced(2 * half_window + 1, -half_window, half_window).square())
            .exp();
    const Eigen::Map<const Eigen::VectorXd> moment(chi.data(), count);
    const Eigen::VectorXd logarithm = moment.unaryExpr(
        [](double x) { return x > 0.0 ? std::log(x) : std::numeric_limits<double>::quiet_NaN(); });

    double largest = 0.0;
    for (int l = moments; l < count; ++l) {
        // Near the end the window shrinks on both sides, so that a slope does not become a bias.
        const int reach = std::min({half_window, l, count - 1 - l});
        const auto weights = kernel.segment(half_window - reach, 2 * reach + 1);
        const double weight = weights.sum();
        const double log_mean = weights.dot(logarithm.segment(l - reach, weights.size()));
        // NaN: not positive throughout the window.
        const double smooth = std::isnan(log_mean)
                                  ? weights.dot(moment.segment(l - reach, weights.size())) / weight
                                  : std::exp(log_mean / weight);
        split.peak.push_back(smooth);
        split.rest.push_back(chi[std::size_t(l)] - smooth);
        largest = std::max(largest, (2.0 * l + 1.0) * std::abs(split.rest.back()));
    }
    if (largest <= negligible) split.rest.clear();
    return split;
}

}  // namespace miebrdf::rte
