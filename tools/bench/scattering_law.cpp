#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/bench/photon_tracer.h"

namespace miebrdf::bench {

ScatteringLaw ScatteringLaw::isotropic() { return ScatteringLaw(Kind::isotropic); }
ScatteringLaw ScatteringLaw::rayleigh() { return ScatteringLaw(Kind::rayleigh); }

ScatteringLaw ScatteringLaw::henyey_greenstein(double asymmetry) {
    if (!(asymmetry > -1 && asymmetry < 1)) {
        throw std::invalid_argument(fmt::format("asymmetry {} is not in (-1, 1)", asymmetry));
    }
    if (asymmetry == 0) return isotropic();
    ScatteringLaw law(Kind::henyey_greenstein);
    law.g_ = asymmetry;
    return law;
}

ScatteringLaw ScatteringLaw::tabulated(std::vector<double> x, std::vector<double> value) {
    const std::size_t n = x.size();
    if (n < 2 || value.size() != n || x.front() != -1 || x.back() != 1) {
        throw std::invalid_argument(
            "a phase function table needs cosines from -1 to 1, each with a value");
    }
    ScatteringLaw law(Kind::tabulated);
    law.cumulative_.assign(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        if (!(value[i] >= 0) || (i > 0 && !(x[i] > x[i - 1]))) {
            throw std::invalid_argument(fmt::format(
                "phase function table: value {} at cosine {} is negative or out of order", value[i],
                x[i]));
        }
        if (i > 0) {
            law.cumulative_[i] =
                law.cumulative_[i - 1] + (x[i] - x[i - 1]) * (value[i] + value[i - 1]) / 2;
        }
    }
    const double total = law.cumulative_.back();
    if (!(total > 0)) throw std::invalid_argument("phase function table is 0 everywhere");
    for (double& c : law.cumulative_) c /= total;
    for (double& v : value) v *= 2 / total;
    law.cos_theta_ = std::move(x);
    law.value_ = std::move(value);
    return law;
}

double ScatteringLaw::value(double x) const {
    switch (kind_) {
        case Kind::isotropic:
            return 1.0;
        case Kind::rayleigh:
            return 0.75 * (1 + x * x);
        case Kind::henyey_greenstein: {
            const double base = (1 - g_) * (1 - g_) + 2 * g_ * (1 - x);
            return (1 - g_ * g_) / (base * std::sqrt(base));
        }
        case Kind::tabulated:
            break;
    }
    const auto above = std::upper_bound(cos_theta_.begin() + 1, cos_theta_.end() - 1, x);
    const auto i = static_cast<std::size_t>(above - cos_theta_.begin());
    const double t = (x - cos_theta_[i - 1]) / (cos_theta_[i] - cos_theta_[i - 1]);
    return value_[i - 1] + t * (value_[i] - value_[i - 1]);
}

double ScatteringLaw::sample(double u) const {
    double x = 0;
    switch (kind_) {
        case Kind::isotropic:
            return 2 * u - 1;
        case Kind::rayleigh: {
            // x^3 + 3 x = 8 u - 4, by Cardano's formula.
            const double half = 4 * u - 2;
            const double a = std::cbrt(std::abs(half) + std::sqrt(half * half + 1));
            x = std::copysign(a - 1 / a, half);
            break;
        }
        case Kind::henyey_greenstein: {
            // Witt 1977, eq. 19.
            const double s = (1 - g_ * g_) / (1 - g_ + 2 * g_ * u);
            x = (1 + g_ * g_ - s * s) / (2 * g_);
            break;
        }
        case Kind::tabulated: {
            const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, u);
            const auto i = static_cast<std::size_t>(above - cumulative_.begin());
            // The area of a trapezoid from its left end is what is missing: v t + slope t^2 / 2.
            const double width = cos_theta_[i] - cos_theta_[i - 1];
            const double v = value_[i - 1];
            const double slope = (value_[i] - v) / width;
            const double area = 2 * (u - cumulative_[i - 1]);
            const double root = std::sqrt(std::max(0.0, v * v + 2 * slope * area));
            const double t = v + root > 0 ? 2 * area / (v + root) : 0.0;
            x = cos_theta_[i - 1] + std::min(t, width);
            break;
        }
    }
    return std::clamp(x, -1.0, 1.0);
}

}  // namespace miebrdf::bench
