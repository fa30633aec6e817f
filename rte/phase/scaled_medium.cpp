#include "rte/phase/scaled_medium.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace miebrdf::rte {
namespace {

// The running mean of split_forward_peak: wider than the beat of a glory in l, narrower than the
// peak; cut off at four sigma.
constexpr double kSigma = 12.0;
constexpr int kHalfWindow = 48;
// The structure counts when it could move first-order light by this much (times 1 / (1 - alpha f)).
constexpr double kNegligible = 1e-7;

double chi_at(const Optics& optics, std::size_t degree) {
    return degree < optics.chi.size() ? optics.chi[degree] : 0.0;
}

// The peak that L moments cannot carry. Every remaining chi'_l must stay within [-1, 1]:
// (chi - f) / (1 - f) >= -1 is f <= (1 + chi) / 2.
double forward_fraction(const Optics& optics, std::size_t moments) {
    const double f = chi_at(optics, moments);
    if (!(f > 0.0 && chi_at(optics, moments + 1) >= 0.0)) return 0.0;
    for (std::size_t l = 0; l < moments; ++l) {
        if (!(f <= 0.5 * (1.0 + chi_at(optics, l)))) return 0.0;
    }
    // A peak whose last moment rounds to 1 leaves nothing to scale by.
    return std::min(f, 1.0 - 1e-9);
}

// How much truncation matters.
double peak_strength(double f) {
    constexpr double weak = 1e-4;
    constexpr double strong = 0.2;
    return f > weak ? std::min(1.0, std::log(f / weak) / std::log(strong / weak)) : 0.0;
}

// K: the more light the peak holds, the wider the window of cutoffs.
int first_cutoff(double f, int moments) {
    constexpr double widest_share = 0.45;
    return std::max(1, moments - int(std::lround(widest_share * peak_strength(f) * moments)));
}

// Whether the running means of split_forward_peak are the moments themselves, as of
// Henyey-Greenstein: a second difference d of log chi moves a Gaussian mean by sigma^2 / 2 of it.
bool is_geometric(std::span<const double> chi) {
    double largest = 1.0, bend = 0.0;
    for (std::size_t l = 1; l + 1 < chi.size(); ++l) {
        const double square = chi[l] * chi[l];
        if (!(chi[l] > 0.0 && square > 0.0)) return false;
        bend = std::max(bend, std::abs(chi[l - 1] * chi[l + 1] - square) / square);
        largest = std::max(largest, (2.0 * double(l) + 1.0) * chi[l]);
    }
    return chi.size() > 2 && chi.back() > 0.0 &&
           0.5 * kSigma * kSigma * bend * largest <= kNegligible;
}

// Weight of one cutoff of the window: zero towards both ends, so that the share that is scaled away
// sets in and ends without a kink.
double cutoff_weight(int index, int cutoffs) {
    return std::sin(std::numbers::pi * (index + 1) / (cutoffs + 1));
}

}  // namespace

double ScaledOptics::share_scaled_away(int degree) const {
    const int last = int(chi.size());
    if (degree < first_cutoff) return 0.0;
    if (degree >= last) return 1.0;
    // sum_{i=1}^p sin(i h) in closed form, relative to that of all the cutoffs.
    const double half = 0.5 * std::numbers::pi / (last - first_cutoff + 2);
    const int p = degree - first_cutoff + 1;
    return std::sin(p * half) * std::sin((p + 1) * half) / std::cos(half);
}

Eigen::VectorXd ScaledOptics::strengths() const {
    Eigen::VectorXd result(chi.size());
    for (Eigen::Index l = 0; l < chi.size(); ++l) result[l] = albedo * (2.0 * l + 1.0) * chi[l];
    return result;
}

ScaledOptics scale_optics(const Optics& optics, int moments, bool delta_m) {
    ScaledOptics scaled;
    scale_optics(optics, moments, delta_m, scaled);
    return scaled;
}

void scale_optics(const Optics& optics, int moments, bool delta_m, ScaledOptics& scaled,
                  const ScaledOptics* like) {
    const auto fraction_like = [&] {
        return like->truncated > 0.0 ? chi_at(optics, std::size_t(moments)) : 0.0;
    };
    const double sharp = like != nullptr ? fraction_like()
                         : delta_m       ? forward_fraction(optics, std::size_t(moments))
                                         : 0.0;
    scaled.first_cutoff = like != nullptr ? like->first_cutoff : first_cutoff(sharp, moments);
    scaled.chi.setZero(moments);  // (1 - f) chi' until f is known
    double sum = 0.0;
    double weights = 0.0;
    const int cutoffs = moments - scaled.first_cutoff + 1;
    for (int cutoff = moments; cutoff >= scaled.first_cutoff; --cutoff) {
        const double f = cutoff == moments ? sharp : chi_at(optics, cutoff);
        const double weight = cutoff_weight(cutoff - scaled.first_cutoff, cutoffs);
        weights += weight;
        sum += weight * f;
        for (int l = 0; l < cutoff; ++l) scaled.chi[l] += weight * (chi_at(optics, l) - f);
    }
    const double f = scaled.truncated = sum / weights;
    scaled.chi /= double(scaled.chi[0]);  // = weights (1 - f), and exactly 1 afterwards
    // 1 - alpha f = (1 - f) + (1 - alpha) f: no digits lost when both are close to 1.
    scaled.depth_factor = (1.0 - f) + optics.one_minus_albedo * f;
    scaled.one_minus_albedo = optics.one_minus_albedo / scaled.depth_factor;
    scaled.albedo = optics.single_scattering_albedo * (1.0 - f) / scaled.depth_factor;
}

ForwardPeak split_forward_peak(std::span<const double> chi, int moments, int cutoff) {
    ForwardPeak split;
    split.first_degree = moments;
    const int count = int(chi.size());
    if (count <= moments + 1) return split;
    if (is_geometric(chi)) {
        split.peak.assign(chi.begin() + moments, chi.end());
        return split;
    }

    const Eigen::VectorXd kernel =
        (-0.5 / (kSigma * kSigma) *
         Eigen::ArrayXd::LinSpaced(2 * kHalfWindow + 1, -kHalfWindow, kHalfWindow).square())
            .exp();
    const Eigen::Map<const Eigen::VectorXd> moment(chi.data(), count);
    // Beside chi_0 = 1 the last moments of small spheres are rounding, whose signs mean nothing.
    const Eigen::VectorXd logarithm = moment.unaryExpr([](double x) {
        return x > std::numeric_limits<double>::epsilon()
                   ? std::log(x)
                   : std::numeric_limits<double>::quiet_NaN();
    });

    // The window at l: near the end it shrinks on both sides.
    const auto reach_at = [&](int l) { return std::min({kHalfWindow, l, count - 1 - l}); };
    std::vector<int> not_positive = {0};  // moments before each degree
    for (const double log : logarithm)
        not_positive.push_back(not_positive.back() + std::isnan(log));
    int not_geometric = moments;  // the first degree whose window is not positive throughout
    while (not_geometric < count) {
        const int first = not_geometric - reach_at(not_geometric);
        const int end = not_geometric + reach_at(not_geometric) + 1;
        if (not_positive[std::size_t(end)] > not_positive[std::size_t(first)]) break;
        ++not_geometric;
    }

    // No smooth peak is above all moments that are left: where they fall steeply a window reaches
    // back to much larger ones.
    // Beyond the cutoff one bound for all: it must have no steps where moments change their sign.
    std::vector<double> highest(std::size_t(count) + 1, 0.0);  // of degree l and above
    for (std::size_t l = std::size_t(count); l-- > 0;)
        highest[l] = std::max(highest[l + 1], std::abs(chi[l]));
    for (int l = std::max(moments, cutoff) + 1; l < count; ++l)
        highest[std::size_t(l)] = highest[std::size_t(std::max(moments, cutoff))];

    const double whole_weight = kernel.sum();
    double largest = 0.0;
    for (int l = moments; l < count; ++l) {
        // Near the end the window shrinks on both sides, so that a slope does not become a bias.
        const int reach = reach_at(l);
        const auto weights = kernel.segment(kHalfWindow - reach, 2 * reach + 1);
        const double weight = reach == kHalfWindow ? whole_weight : weights.sum();
        double smooth = weights.dot(moment.segment(l - reach, weights.size())) / weight;
        // From the geometric to the arithmetic mean over as many degrees as a window has: a step
        // at one degree would be a term of the sum over N_l that flips with its parity.
        if (l < not_geometric) {
            const double log_mean = weights.dot(logarithm.segment(l - reach, weights.size()));
            const double left = double(not_geometric - l) / (2 * kHalfWindow + 1);
            const double share = not_geometric == count || left >= 1.0
                                     ? 1.0
                                     : std::pow(std::sin(0.5 * std::numbers::pi * left), 2);
            smooth += share * (std::exp(log_mean / weight) - smooth);
        }
        smooth = std::clamp(smooth, -highest[std::size_t(l)], highest[std::size_t(l)]);
        split.peak.push_back(smooth);
        split.structure.push_back(chi[std::size_t(l)] - smooth);
        largest = std::max(largest, (2.0 * l + 1.0) * std::abs(split.structure.back()));
    }
    if (largest <= kNegligible) split.structure.clear();
    return split;
}

}  // namespace miebrdf::rte
