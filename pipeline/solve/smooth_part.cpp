#include "pipeline/solve/smooth_part.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf {
namespace {

/// Stands for the horizon, where R itself has a limit but mu = 0 is no direction.
constexpr double kHorizon = 1e-9;
constexpr int kStencil = 6;

/// Lagrange weights of six neighbouring nodes.
struct Stencil {
    std::size_t first = 0;
    double weight[kStencil] = {};

    double of(const std::vector<double>& values) const {
        double sum = 0.0;
        for (int j = 0; j < kStencil; ++j)
            sum += weight[j] * values[first + static_cast<std::size_t>(j)];
        return sum;
    }
};

Stencil stencil_at(double mu) {
    constexpr int intervals = SmoothPart::kNodes - 1;
    const double x =
        2.0 / std::numbers::pi * std::asin(std::sqrt(std::clamp(mu, 0.0, 1.0))) * intervals;
    const int first =
        std::clamp(static_cast<int>(x) - kStencil / 2 + 1, 0, intervals + 1 - kStencil);
    Stencil stencil;
    stencil.first = static_cast<std::size_t>(first);
    // Rounding of sin and asin must not turn a node into something between nodes.
    const double nearest = std::round(x);
    const double t = (std::abs(x - nearest) < 1e-11 * intervals ? nearest : x) - first;
    for (int j = 0; j < kStencil; ++j) {
        double weight = 1.0;
        for (int i = 0; i < kStencil; ++i) {
            if (i != j) weight *= (t - i) / (j - i);
        }
        stencil.weight[j] = weight;
    }
    return stencil;
}

}  // namespace

const std::vector<double>& SmoothPart::nodes() {
    static const std::vector<double> cosines = [] {
        std::vector<double> list;
        for (std::size_t k = 0; k < kNodes; ++k) {
            const double sine = std::sin(std::numbers::pi / 2 * static_cast<double>(k) /
                                         static_cast<double>(kNodes - 1));
            list.push_back(k + 1 == kNodes ? 1.0 : std::max(sine * sine, kHorizon));
        }
        return list;
    }();
    return cosines;
}

SmoothPart::SmoothPart(std::vector<double> modes, std::size_t orders)
    : orders_(orders), modes_(std::move(modes)) {}

void SmoothPart::scale(const std::vector<double>& in, const std::vector<double>& out) {
    for (std::size_t pair = 0; pair * orders_ < modes_.size(); ++pair) {
        const double factor = in[pair / kNodes] * out[pair % kNodes];
        for (std::size_t m = 0; m < orders_; ++m) modes_[pair * orders_ + m] *= factor;
    }
}

void SmoothPart::add(const SmoothPart& other, double weight) {
    if (other.orders_ > orders_) {
        std::vector<double> wider(kNodes * kNodes * other.orders_, 0.0);
        for (std::size_t i = 0; i < modes_.size(); ++i)
            wider[i / orders_ * other.orders_ + i % orders_] = modes_[i];
        modes_ = std::move(wider);
        orders_ = other.orders_;
    }
    for (std::size_t i = 0; i < other.modes_.size(); ++i)
        modes_[i / other.orders_ * orders_ + i % other.orders_] += weight * other.modes_[i];
}

void SmoothPart::series_at(double mu_in, double mu_out, std::vector<double>& series) const {
    series.assign(std::max<std::size_t>(1, orders_), 0.0);
    if (modes_.empty()) return;
    const Stencil in = stencil_at(mu_in), out = stencil_at(mu_out);
    for (std::size_t i = 0; i < kStencil; ++i) {
        for (std::size_t o = 0; o < kStencil; ++o) {
            const double weight = in.weight[i] * out.weight[o] / (mu_in + mu_out);
            if (weight == 0.0) continue;
            const double* a = &modes_[((in.first + i) * kNodes + out.first + o) * orders_];
            for (std::size_t m = 0; m < orders_; ++m) series[m] += weight * a[m];
        }
    }
}

double at_cosine(const std::vector<double>& at_nodes, double mu) {
    return stencil_at(mu).of(at_nodes);
}

double cosine_sum(const std::vector<double>& a, double cos_azimuth) {
    double next = 0.0, after = 0.0;
    for (std::size_t m = a.size() - 1; m > 0; --m) {
        const double current = a[m] + 2.0 * cos_azimuth * next - after;
        after = next;
        next = current;
    }
    return a[0] + cos_azimuth * next - after;
}

}  // namespace miebrdf
