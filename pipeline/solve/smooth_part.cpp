#include "pipeline/solve/smooth_part.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace miebrdf {
namespace {

/// The cosine of the first node, in place of 0, which is no direction; R has a limit there.
constexpr double kHorizon = 1e-9;
/// (Sum of the last orders that are left out) / (sum of all orders of a pair) is at most this.
constexpr double kNegligible = 1e-7;

std::size_t whole_lanes(std::size_t orders) {
    return (orders + math::kSeriesLanes - 1) / math::kSeriesLanes * math::kSeriesLanes;
}

/// The number of orders of a pair without the negligible last ones; all if one is NaN.
std::size_t orders_that_matter(const double* a, std::size_t orders) {
    double all = 0.0;
    for (std::size_t m = 0; m < orders; ++m) all += std::abs(a[m]);
    double tail = 0.0;
    std::size_t count = orders;
    while (count > 0 && tail + std::abs(a[count - 1]) <= kNegligible * all)
        tail += std::abs(a[--count]);
    return count;
}

}  // namespace

std::vector<double> cosines_of_azimuths(int n) {
    std::vector<double> list;
    list.reserve(std::size_t(n) + 1);
    for (int j = 0; j <= n; ++j) list.push_back(std::cos(std::numbers::pi * j / n));
    return list;
}

Eigen::MatrixXd samples_to_orders(int n) {
    Eigen::MatrixXd result(n + 1, resolved_orders(n));
    for (int j = 0; j <= n; ++j) {
        for (int m = 0; m < result.cols(); ++m) {
            result(j, m) = (m == 0 ? 1.0 : 2.0) / n * (j == 0 || j == n ? 0.5 : 1.0) *
                           std::cos(std::numbers::pi * ((m * j) % (2 * n)) / n);
        }
    }
    return result;
}

const std::vector<double>& SmoothPart::nodes() {
    static const std::vector<double> cosines = [] {
        std::vector<double> list = half_sine_nodes(kNodes);
        list.front() = kHorizon;
        list.back() = 1.0;
        return list;
    }();
    return cosines;
}

SmoothPart::SmoothPart(const std::vector<double>& modes, std::size_t orders)
    : orders_(whole_lanes(orders)), modes_(kNodes * kNodes * orders_, 0.0F) {
    for (std::size_t pair = 0; pair < kNodes * kNodes; ++pair) {
        const double* const a = &modes[pair * orders];
        // The other orders stay 0, so that the sum of two parts has no order that neither has.
        const std::size_t count = orders_that_matter(a, orders);
        std::transform(a, a + count, &modes_[pair * orders_],
                       [](double mode) { return static_cast<float>(mode); });
    }
    count_needed();
}

void SmoothPart::count_needed() {
    std::vector<std::size_t> of_pair(kNodes * kNodes);
    for (std::size_t pair = 0; pair < of_pair.size(); ++pair) {
        std::size_t& count = of_pair[pair];
        count = orders_;
        while (count > 0 && modes_[pair * orders_ + count - 1] == 0.0F) --count;
    }
    needed_.assign(kPlaces * kPlaces, 1);
    for (std::size_t in = 0; in < kPlaces; ++in) {
        for (std::size_t out = 0; out < kPlaces; ++out) {
            std::size_t most = 1;
            for (std::size_t i = 0; i < SixNodes::kCount; ++i) {
                const auto row =
                    of_pair.begin() + static_cast<std::ptrdiff_t>((in + i) * kNodes + out);
                most = std::max(most, *std::max_element(row, row + SixNodes::kCount));
            }
            needed_[in * kPlaces + out] = static_cast<std::uint32_t>(most);
        }
    }
}

void SmoothPart::scale(const std::vector<double>& in, const std::vector<double>& out) {
    for (std::size_t pair = 0; pair * orders_ < modes_.size(); ++pair) {
        const auto factor = static_cast<float>(in[pair / kNodes] * out[pair % kNodes]);
        for (std::size_t m = 0; m < orders_; ++m) modes_[pair * orders_ + m] *= factor;
    }
}

void SmoothPart::add(const SmoothPart& other, double weight) {
    if (other.orders_ > orders_) {
        std::vector<float> wider(kNodes * kNodes * other.orders_, 0.0F);
        for (std::size_t i = 0; i < modes_.size(); ++i)
            wider[i / orders_ * other.orders_ + i % orders_] = modes_[i];
        modes_ = std::move(wider);
        orders_ = other.orders_;
    }
    for (std::size_t i = 0; i < other.modes_.size(); ++i)
        modes_[i / other.orders_ * orders_ + i % other.orders_] +=
            static_cast<float>(weight * other.modes_[i]);
    count_needed();
}

void SmoothPart::series_at(double mu_in, double mu_out, std::vector<double>& series) const {
    series_at(place_of(mu_in), place_of(mu_out), mu_in + mu_out, series);
}

void SmoothPart::series_at(const SixNodes& in, const SixNodes& out, double mu_sum,
                           std::vector<double>& series) const {
    if (modes_.empty()) {
        series.assign(kLanes, 0.0);
        return;
    }
    series.resize(whole_lanes(needed_[in.first * kPlaces + out.first]));
    math::SeriesTable::Weights weight_in, weight_out;
    for (std::size_t j = 0; j < SixNodes::kCount; ++j) {
        weight_in[j] = static_cast<float>(in.weight[j] / mu_sum);
        weight_out[j] = static_cast<float>(out.weight[j]);
    }
    const math::SeriesTable neighbours{&modes_[(in.first * kNodes + out.first) * orders_],
                                       kNodes * orders_, orders_};
    neighbours.add_up(weight_in, weight_out, series);
}

}  // namespace miebrdf
