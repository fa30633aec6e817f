#include "rte/surface/microfacet.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <miebrdf/error.h>

namespace miebrdf::rte {
namespace {

using std::numbers::inv_sqrtpi;
using std::numbers::pi;

template <typename Function>
double zero_between(const Function& f, double from, double to) {
    std::uintmax_t steps = 100;
    const auto bracket = boost::math::tools::toms748_solve(
        f, from, to, boost::math::tools::eps_tolerance<double>(50), steps);
    return 0.5 * (bracket.first + bracket.second);
}

}  // namespace

void validate(const SurfaceOptions& options) {
    if (!(options.beckmann_alpha >= 1e-4 && options.beckmann_alpha <= 4.0)) {
        throw UsageError("beckmann_alpha", options.beckmann_alpha, "0.0001 to 4");
    }
}

double normal_density(MicrofacetDistribution distribution, double alpha, double tan2_half) {
    const double tan2 = std::min(tan2_half, 1e100);  // keeps sec^4 finite; D is at its limit there
    const double t = tan2 / (alpha * alpha);
    const double sec2 = 1.0 + tan2;
    const double profile = distribution == MicrofacetDistribution::beckmann
                               ? std::exp(-t)
                               : 1.0 / ((1.0 + t) * (1.0 + t));
    return profile * sec2 * sec2 / (pi * alpha * alpha);
}

double cosine_over_masking(MicrofacetDistribution distribution, double alpha, double mu) {
    const double sine = std::sqrt(std::max(0.0, (1.0 - mu) * (1.0 + mu)));
    const double spread = alpha * sine;
    if (distribution == MicrofacetDistribution::ggx) return 0.5 * (mu + std::hypot(mu, spread));
    if (spread == 0.0) return mu;
    const double a = mu / spread;
    return mu + 0.5 * (spread * std::exp(-a * a) * inv_sqrtpi - mu * std::erfc(a));
}

ShadowingOverCosines::ShadowingOverCosines(const SurfaceOptions& options)
    : shadowing_(options.shadowing),
      distribution_(options.shadowing_distribution.value_or(options.distribution)),
      alpha_(options.beckmann_alpha) {
    validate(options);
}

double ShadowingOverCosines::cosine_over_masking(double mu) const {
    return rte::cosine_over_masking(distribution_, alpha_, mu);
}

double ShadowingOverCosines::operator()(const FacetGeometry& geometry) const {
    const bool smith = shadowing_ != Shadowing::v_cavity;
    return (*this)(geometry, smith ? cosine_over_masking(geometry.mu_in) : 0.0);
}

double ShadowingOverCosines::operator()(const FacetGeometry& g, double in_over_masking) const {
    if (shadowing_ == Shadowing::v_cavity) {
        // G = min(1, 2 cos_half mu / cos_facet) with the smaller mu; divided by both cosines.
        const double grooves = 2.0 * g.cos_half / (g.cos_facet * std::max(g.mu_in, g.mu_out));
        return std::min(1.0 / (g.mu_in * g.mu_out), grooves);
    }
    const double out_over_masking = cosine_over_masking(g.mu_out);
    if (shadowing_ == Shadowing::smith_separable) return 1.0 / (in_over_masking * out_over_masking);
    // mu_in mu_out (1 + Lambda_in + Lambda_out) from mu (1 + Lambda) of both.
    return 1.0 / (g.mu_out * in_over_masking + g.mu_in * (out_over_masking - g.mu_out));
}

SlopePlane::SlopePlane(double mu_in)
    : mu_(mu_in), sine_(std::sqrt((1.0 - mu_in) * (1.0 + mu_in))) {}

/// mu sqrt(1 / mu^2 - y^2)
double SlopePlane::root(double y) const {
    return std::sqrt(std::max(0.0, (1.0 - y * mu_) * (1.0 + y * mu_)));
}

double SlopePlane::lowest_x(double y) const {
    return (y - 1.0) * (y + 1.0) * mu_ / (sine_ + root(y));  // tan - root / mu, no difference
}

double SlopePlane::highest_x(double y) const { return (sine_ + root(y)) / mu_; }

std::vector<double> SlopePlane::v_cavity_kinks(double y) const {
    std::vector<double> kinks;
    const double mu = mu_;
    const double s = sine_;
    const double y2 = y * y;
    if (s > 0) kinks.push_back(mu / s);  // 2 cos_half mu_in = cos_facet
    const double discriminant = s * s - 4 * mu * mu * y2;
    if (discriminant > 0) {  // mu_out = mu_in
        const double large = (s + std::sqrt(discriminant)) / (2 * mu);
        kinks.insert(kinks.end(), {large, y2 / large});
    }
    // 2 cos_half mu_out = cos_facet, in slopes 2 (1 - x^2 - y^2) mu + 4 x s = (mu + x s)(1 + x^2 +
    // y^2): a cubic, positive at both ends of the line, with a root on either side of its minimum.
    const auto cubic = [&](double x) {
        return ((s * x + 3 * mu) * x - s * (3 - y2)) * x - mu * (1 - 3 * y2);
    };
    const double under_root = mu * mu + s * s * (3 - y2) / 3;
    if (under_root > 0) {
        const double minimum = s * (3 - y2) / 3 / (mu + std::sqrt(under_root));
        const double lowest = lowest_x(y);
        const double highest = highest_x(y);
        if (minimum > lowest && minimum < highest && cubic(minimum) < 0) {
            if (cubic(lowest) > 0) kinks.push_back(zero_between(cubic, lowest, minimum));
            if (cubic(highest) > 0) kinks.push_back(zero_between(cubic, minimum, highest));
        }
    }
    std::sort(kinks.begin(), kinks.end());
    return kinks;
}

std::vector<double> SlopePlane::v_cavity_corners() const {
    std::vector<double> corners;
    const double s2 = sine_ * sine_;
    // mu_out = mu_in is the circle x^2 + y^2 = x tan; its top, and where x = cot crosses it.
    if (s2 > 0) corners.push_back(sine_ / (2 * mu_));
    if (s2 > mu_ * mu_) corners.push_back(std::sqrt((1.0 - mu_ / sine_) * (1.0 + mu_ / sine_)));
    // The cubic's roots merge where (3 - s^2 Y)^3 = 27 mu^2 (1 + s^2 Y)^2, Y = y^2; divided by s^2,
    // so that it also holds at normal incidence (Y = 1/3). Falls from 27 at Y = 0.
    const auto merging = [&](double y2) {
        return 27 - 81 * y2 + s2 * y2 * (54 + y2 * (27 * s2 - 18 - s2 * y2));
    };
    const double beyond = s2 > 0.5 ? 3.0 / s2 : 6.0;
    if (merging(beyond) < 0) corners.push_back(std::sqrt(zero_between(merging, 0.0, beyond)));
    std::sort(corners.begin(), corners.end());
    return corners;
}

// (mu + x s)^2 = c^2 (1 + x^2 + y^2) is quadratic in x, with the discriminant c^2 (1 - c^2 + (s^2 -
// c^2) y^2).
std::vector<double> SlopePlane::incidence_kinks(double cos_facet, double y) const {
    const double c = cos_facet, s = sine_;
    const double flatness = (s - c) * (s + c);
    const double under_root = (1.0 - c) * (1.0 + c) + flatness * y * y;
    std::vector<double> kinks;
    if (!(under_root >= 0.0)) return kinks;
    const double q = -(mu_ * s + c * std::sqrt(under_root));
    const auto add = [&](double x) {
        if (std::isfinite(x) && mu_ + x * s > 0.0) kinks.push_back(x);  // the mirror's front
    };
    add(q / flatness);
    add((mu_ * mu_ - c * c * (1.0 + y * y)) / q);
    std::sort(kinks.begin(), kinks.end());
    return kinks;
}

std::vector<double> SlopePlane::incidence_corners(double cos_facet) const {
    const double c = cos_facet, s = sine_;
    std::vector<double> corners;
    if (c > s) corners.push_back(std::sqrt((1.0 - c) * (1.0 + c) / ((c - s) * (c + s))));
    // At the rim light leaves along the horizon: twice the angle of incidence lies between the two
    // rays, whose product is s cos(azimuth).
    const double cosine = (2.0 * c * c - 1.0) / s;
    if (std::abs(cosine) < 1.0) corners.push_back(std::sqrt((1.0 - cosine) * (1.0 + cosine)) / mu_);
    std::sort(corners.begin(), corners.end());
    return corners;
}

}  // namespace miebrdf::rte
