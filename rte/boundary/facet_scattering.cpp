#include "rte/boundary/facet_scattering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "rte/math/quadrature.h"
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"
#include "rte/surface/slopes.h"

namespace miebrdf::rte {
namespace {

// Gauss rules in s with the variable s^2 (3 - 2 s), which makes square roots at both ends smooth.
constexpr int kMostFacetNodes = 128;

const std::vector<math::Quadrature>& smooth_ended_rules() {
    static const auto rules = [] {
        std::vector<math::Quadrature> all(kMostFacetNodes + 1);
        for (int count = 1; count <= kMostFacetNodes; ++count) {
            math::Quadrature rule = math::gauss_legendre(count, 0.0, 1.0);
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                const double s = rule.nodes[i];
                rule.weights[i] *= 6.0 * s * (1.0 - s);
                rule.nodes[i] = s * s * (3.0 - 2.0 * s);
            }
            all[std::size_t(count)] = std::move(rule);
        }
        return all;
    }();
    return rules;
}

/// a x^2 - 2 b x + c + e y^2 = 0 in the slopes.
struct SlopeCurve {
    double a, b, c, e;

    /// Where it crosses a line of constant y.
    void add_crossings(double y, std::vector<double>& x) const {
        const double rest = c + e * y * y;
        const double discriminant = b * b - a * rest;
        if (!(discriminant >= 0.0)) return;
        const double q = b + std::copysign(std::sqrt(discriminant), b);
        x.push_back(q / a);
        x.push_back(rest / q);
    }
    /// Its largest y; NaN or infinite if it has none.
    double top() const { return std::sqrt((b * b - a * c) / (a * e)); }
};

/// Facets that reflect light into the cosine mu0.
SlopeCurve reflected_into(double mu, double sine, double mu0) {
    return {mu + mu0, sine, mu0 - mu, mu + mu0};
}

/// Facets that refract light into the cosine mu0: the horizontal part of in + m out is (sine + m
/// sine0 cos(azimuth), m sine0 sin(azimuth)), its vertical part mu - m mu0 is constant.
SlopeCurve refracted_into(double mu, double sine, double m, double mu0) {
    const double vertical = mu - m * mu0;
    const double m_sine0_2 = m * m * (1.0 - mu0) * (1.0 + mu0);
    return {vertical * vertical, vertical * sine, sine * sine - m_sine0_2, vertical * vertical};
}

/// Facets that light meets at the cosine `facet`.
SlopeCurve met_at(double mu, double sine, double facet) {
    return {(sine - facet) * (sine + facet), -mu * sine, (mu - facet) * (mu + facet),
            -facet * facet};
}

template <typename Slopes>
class FacetIntegral {
  public:
    FacetIntegral(double relative_index, const RoughSurface& surface, double mu, double refinement,
                  std::span<const double> edges)
        : slopes_{surface.alpha},
          refinement_(refinement),
          index_(relative_index),
          mu_(mu),
          sine_(std::sqrt((1.0 - mu) * (1.0 + mu))) {
        const auto add_reflected = [&](double mu0) {
            if (mu + mu0 > 0.0) curves_.push_back(reflected_into(mu, sine_, mu0));
        };
        const auto add_refracted = [&](double mu0) {
            // The facet's normal is on the light's side.
            if ((mu - index_ * mu0) * (1.0 - index_) > 0.0) {
                curves_.push_back(refracted_into(mu, sine_, index_, mu0));
            }
        };
        // Into the zenith, about which the azimuth turns: one facet each.
        if (mu + 1.0 > 0.0) zenith_.push_back(sine_ / (mu + 1.0));
        if ((mu - index_) * (1.0 - index_) > 0.0) zenith_.push_back(sine_ / (mu - index_));
        add_reflected(0.0);
        add_refracted(0.0);
        if (index_ < 1.0) {
            const double critical = std::sqrt((1.0 - index_) * (1.0 + index_));
            add_reflected(critical);
            add_reflected(-critical);
            curves_.push_back(met_at(mu, sine_, critical));
        } else if (index_ > 1.0) {
            const double critical = std::sqrt((index_ - 1.0) * (index_ + 1.0)) / index_;
            add_refracted(critical);
            add_refracted(-critical);
        }
        for (const double edge : edges) {
            for (const double cosine : {edge, -edge})
                index_ < 1.0 ? add_reflected(cosine) : add_refracted(cosine);
        }
    }

    FacetScattering scattering() {
        // Lines of constant v, in strips between the ends of the curves.
        std::vector<double> ends{0.0, kLargest};
        for (const SlopeCurve& curve : curves_) {
            const double v = slopes_.across_of(curve.top());
            if (v > 0.0 && v < kLargest) ends.push_back(v);
        }
        std::sort(ends.begin(), ends.end());
        for (std::size_t k = 1; k < ends.size(); ++k) {
            const double length = ends[k] - ends[k - 1];
            if (!(length > kShortest)) continue;
            const math::Quadrature& rule = rule_for(length);
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                const double v = ends[k - 1] + length * rule.nodes[i];
                line(v, 2.0 * length * rule.weights[i] * slopes_.across_density(v));
            }
        }
        for (ScatteredRays* rays : {&result_.reflected, &result_.refracted}) {
            for (double& energy : rays->energy) energy /= total_;
        }
        return std::move(result_);
    }

  private:
    // Of u and v; Gaussian slopes beyond are 1e-11 of all.
    static constexpr double kLargest = std::min(Slopes::kLargest, 5.0);
    static constexpr double kShortest = 1e-13 * kLargest;

    const math::Quadrature& rule_for(double length) const {
        const double share = length / (2.0 * kLargest);
        const int count = int(std::ceil(refinement_ * (kFewestPerPiece + kMorePerLine * share)));
        return smooth_ended_rules()[std::size_t(std::min(count, kMostFacetNodes))];
    }

    void line(double v, double weight) {
        const double y = slopes_.y(v);
        crossings_ = zenith_;
        for (const SlopeCurve& curve : curves_) curve.add_crossings(y, crossings_);
        // Facets that face the light: x > -mu / sine.
        double from = sine_ > 0.0 ? slopes_.along_of(-mu_ / sine_, v) : -kLargest;
        from = std::max(from, -kLargest);
        for (double& x : crossings_)
            x = std::isfinite(x) ? std::min(slopes_.along_of(x, v), kLargest) : from;
        crossings_.push_back(0.0);  // where slopes are densest
        crossings_.push_back(kLargest);
        std::sort(crossings_.begin(), crossings_.end());
        for (const double to : crossings_) {
            if (!(to - from > kShortest)) continue;
            const math::Quadrature& rule = rule_for(to - from);
            for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
                const double u = from + (to - from) * rule.nodes[i];
                facet(slopes_.x(u, v), y,
                      weight * (to - from) * rule.weights[i] * slopes_.along_density(u));
            }
            from = to;
        }
    }

    void facet(double x, double y, double weight) {
        const double r2 = x * x + y * y;
        const double facing = mu_ + x * sine_;
        if (!(facing > 0.0 && weight > 0.0)) return;
        const double normal_z = 1.0 / std::sqrt(1.0 + r2);
        const double cosine = std::min(1.0, facing * normal_z);
        const double reflected = reflectance(cosine);
        weight *= facing;
        total_ += weight;
        // In both the horizontal part is turned to the direction of propagation.
        const double twice = 2.0 * facing / (1.0 + r2);
        result_.reflected.add(
            weight * reflected,
            std::clamp((mu_ * (1.0 - r2) + 2.0 * x * sine_) / (1.0 + r2), -1.0, 1.0),
            cosine_of(sine_ - twice * x, twice * y));
        if (reflected == 1.0) return;
        const double inverse = 1.0 / index_;
        const double sine2 = (1.0 - cosine) * (1.0 + cosine) * inverse * inverse;
        const double along = std::sqrt(std::max(0.0, 1.0 - sine2)) - inverse * cosine;
        result_.refracted.add(
            weight * (1.0 - reflected), std::clamp(inverse * mu_ + along * normal_z, -1.0, 1.0),
            cosine_of(inverse * sine_ + along * x * normal_z, along * y * normal_z));
    }

    double reflectance(double cosine) const {
        // Exactly 1 in total reflection.
        if (index_ < 1.0 && (1.0 - cosine) * (1.0 + cosine) >= index_ * index_) return 1.0;
        return fresnel_reflectance(index_, cosine);
    }

    static double cosine_of(double forward, double across) {
        const double length = std::sqrt(forward * forward + across * across);
        return length > 0.0 ? forward / length : 1.0;
    }

    static constexpr double kFewestPerPiece = 5.0;
    static constexpr double kMorePerLine = 24.0;

    Slopes slopes_;
    double refinement_;
    double index_, mu_, sine_;
    double total_ = 0.0;
    std::vector<SlopeCurve> curves_;
    std::vector<double> zenith_;  ///< slopes along the light's direction
    std::vector<double> crossings_;
    FacetScattering result_;
};

/// log of the gamma function for x >= 1, to 1e-13: Stirling's series beyond 8.
double log_gamma_above_1(double x) {
    double product = 1.0;
    while (x < 8.0) {
        product *= x;
        x += 1.0;
    }
    const double y = 1.0 / (x * x);
    const double series = (1.0 / 12 - y * (1.0 / 360 - y * (1.0 / 1260 - y / 1680))) / x;
    return (x - 0.5) * std::log(x) - x + 0.5 * std::log(2.0 * std::numbers::pi) + series -
           std::log(product);
}

}  // namespace

double seen_from_both_sides(double one_plus_lambda, double beyond) {
    return std::exp(log_gamma_above_1(one_plus_lambda) + log_gamma_above_1(beyond) -
                    log_gamma_above_1(one_plus_lambda + beyond));
}

void ScatteredRays::add(double ray_energy, double ray_mu, double ray_cos_azimuth) {
    energy.push_back(ray_energy);
    mu.push_back(ray_mu);
    cos_azimuth.push_back(ray_cos_azimuth);
}

double ScatteredRays::sum() const { return std::accumulate(energy.begin(), energy.end(), 0.0); }

FacetScattering scatter_by_facets(double relative_index, const RoughSurface& surface, double mu,
                                  double refinement, std::span<const double> edges) {
    if (surface.distribution == MicrofacetDistribution::ggx) {
        return FacetIntegral<GgxSlopes>(relative_index, surface, mu, refinement, edges)
            .scattering();
    }
    return FacetIntegral<BeckmannSlopes>(relative_index, surface, mu, refinement, edges)
        .scattering();
}

FirstMeeting split_by_facets(const FacetScattering& light, const RoughSurface& surface, double mu) {
    const auto one_plus_lambda = [&](double cosine) {
        return cosine_over_masking(surface.distribution, surface.alpha, cosine) / cosine;
    };
    const double in = one_plus_lambda(mu);
    const double log_gamma_in = log_gamma_above_1(1.0 + in);
    FirstMeeting parts;
    const auto split = [](const ScatteredRays& rays, ScatteredRays& leaving, ScatteredRays& hidden,
                          const auto& hidden_share) {
        for (std::size_t k = 0; k < rays.mu.size(); ++k) {
            const double share = rays.mu[k] > 0.0 ? hidden_share(rays.mu[k]) : 1.0;
            const double energy = rays.energy[k];
            if (share < 1.0) leaving.add(energy * (1.0 - share), rays.mu[k], rays.cos_azimuth[k]);
            if (share > 0.0) hidden.add(energy * share, rays.mu[k], rays.cos_azimuth[k]);
        }
    };
    split(light.reflected, parts.leaving.reflected, parts.hidden.reflected, [&](double cosine) {
        const double out = one_plus_lambda(cosine);
        return (out - 1.0) / (in + out - 1.0);
    });
    split(light.refracted, parts.leaving.refracted, parts.hidden.refracted, [&](double cosine) {
        const double out = one_plus_lambda(cosine);
        return -std::expm1(log_gamma_in + log_gamma_above_1(out) - log_gamma_above_1(in + out));
    });
    return parts;
}

FacetScattering unhidden(const FacetScattering& light, const RoughSurface& surface, double mu) {
    return split_by_facets(light, surface, mu).leaving;
}

}  // namespace miebrdf::rte
