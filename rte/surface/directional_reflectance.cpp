// How much of the light from one direction a rough surface reflects, and means of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <miebrdf/error.h>
#include <miebrdf/surface.h>
#include "rte/math/quadrature.h"
#include "rte/math/tolerance_budget.h"
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"
#include "rte/surface/slopes.h"

namespace miebrdf::rte {
namespace {

using std::numbers::pi;

constexpr int kFewestNodes = 8;
constexpr std::size_t kDoublings = 6;

/// 8, 16, ..., 512 nodes; built once, constant afterwards.
const std::array<math::Quadrature, kDoublings + 1>& gauss_rules() {
    static const auto rules = [] {
        std::array<math::Quadrature, kDoublings + 1> r;
        for (std::size_t i = 0; i < r.size(); ++i) {
            r[i] = math::gauss_legendre(kFewestNodes << i, 0.0, 1.0);
        }
        return r;
    }();
    return rules;
}

template <typename Slopes>
class ReflectanceIntegral {
  public:
    ReflectanceIntegral(const FresnelReflectance& fresnel, const SurfaceOptions& options,
                        double mu_in)
        : slopes_{options.beckmann_alpha},
          in_(mu_in),
          fresnel_(fresnel),
          shadowing_(options),
          in_over_masking_(shadowing_.cosine_over_masking(mu_in)),
          has_kinks_(options.shadowing == Shadowing::v_cavity),
          critical_cosine_(fresnel.critical_cosine()) {}

    double value(const math::Quadrature& rule) const {
        const double largest = slopes_.across_of(in_.largest_y());
        double sum = 0;
        double from = 0;
        for (const double corner : corners()) {
            const double to = std::min(slopes_.across_of(corner), largest);
            sum += strip(from, to, rule);
            from = std::max(from, to);
        }
        return 2.0 * (sum + strip(from, largest, rule));  // y and -y are alike
    }

  private:
    /// Where a line is cut; at the critical angle F behaves like a square root.
    struct Cut {
        double x = 0.0;
        bool is_root = false;
    };

    std::vector<double> corners() const {
        std::vector<double> all;
        if (has_kinks_) all = in_.v_cavity_corners();
        if (critical_cosine_ > 0.0) {
            const auto critical = in_.incidence_corners(critical_cosine_);
            all.insert(all.end(), critical.begin(), critical.end());
            std::sort(all.begin(), all.end());
        }
        return all;
    }

    std::vector<Cut> cuts(double y) const {
        std::vector<Cut> all;
        if (has_kinks_) {
            for (const double x : in_.v_cavity_kinks(y)) all.push_back({x, false});
        }
        if (critical_cosine_ > 0.0) {
            for (const double x : in_.incidence_kinks(critical_cosine_, y))
                all.push_back({x, true});
        }
        std::sort(all.begin(), all.end(), [](const Cut& a, const Cut& b) { return a.x < b.x; });
        return all;
    }

    /// A share of an interval and its slope, for a share t of the nodes' range: squares at the ends
    /// where the integrand behaves like a square root.
    static std::pair<double, double> share_of(double t, bool root_first, bool root_last) {
        if (root_first && root_last) return {t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t)};
        if (root_first) return {t * t, 2.0 * t};
        if (root_last) return {t * (2.0 - t), 2.0 * (1.0 - t)};
        return {t, 1.0};
    }

    /// Lines between two values of v. Where they end, at the rim of the disk or where kinks
    /// meet, x behaves like a square root: v = from + (to - from) sin(psi) makes it smooth. At the
    /// critical angle it does so at both ends.
    double strip(double from, double to, const math::Quadrature& rule) const {
        if (!(to > from)) return 0.0;
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double psi = 0.5 * pi * rule.nodes[i];
            const auto [share, slope] = critical_cosine_ > 0.0
                                            ? share_of(rule.nodes[i], true, true)
                                            : std::pair(std::sin(psi), 0.5 * pi * std::cos(psi));
            const double v = from + (to - from) * share;
            sum += rule.weights[i] * slope * slopes_.across_density(v) * line(v, rule);
        }
        return (to - from) * sum;
    }

    double line(double v, const math::Quadrature& rule) const {
        const double y = slopes_.y(v);
        const double end = slopes_.along_of(in_.highest_x(y), v);
        double from = slopes_.along_of(in_.lowest_x(y), v);
        bool root_first = false;
        double sum = 0;
        if (has_kinks_ || critical_cosine_ > 0.0) {
            for (const Cut& cut : cuts(y)) {
                const double to = std::clamp(slopes_.along_of(cut.x, v), from, end);
                sum += segment(v, y, {from, root_first}, {to, cut.is_root}, rule);
                if (to > from) root_first = cut.is_root;
                from = to;
            }
        }
        return sum + segment(v, y, {from, root_first}, {end, false}, rule);
    }

    /// @param first, last  in u
    double segment(double v, double y, Cut first, Cut last, const math::Quadrature& rule) const {
        const double length = last.x - first.x;
        if (!(length > 0.0)) return 0.0;
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const auto [share, slope] = share_of(rule.nodes[i], first.is_root, last.is_root);
            const double u = first.x + length * share;
            sum +=
                rule.weights[i] * slope * slopes_.along_density(u) * reflected(slopes_.x(u, v), y);
        }
        return length * sum;
    }

    /// (1 + x tan) G F of the mirrors with slopes (x, y).
    double reflected(double x, double y) const {
        const double r2 = x * x + y * y;
        const double facing = in_.mu() + x * in_.sine();
        const double mu_out = (in_.mu() * (1.0 - r2) + 2.0 * x * in_.sine()) / (1.0 + r2);
        if (!(mu_out > 0 && facing > 0)) return 0.0;  // rounding at the ends of the line
        const double cos_half = 1.0 / std::sqrt(1.0 + r2);
        const double cos_facet = std::min(1.0, facing * cos_half);
        const double shadowing =
            shadowing_({in_.mu(), std::min(1.0, mu_out), cos_half, cos_facet}, in_over_masking_);
        return facing * mu_out * shadowing * fresnel_(cos_facet);
    }

    Slopes slopes_;
    SlopePlane in_;
    const FresnelReflectance& fresnel_;
    ShadowingOverCosines shadowing_;
    double in_over_masking_;
    bool has_kinks_;
    double critical_cosine_;
};

template <typename Slopes>
IntegralResult refine(const ReflectanceIntegral<Slopes>& integral, double tolerance) {
    // Convergence is exponential (kinks lie on the ends of strips and segments), but two coarse
    // rules can agree by accident: a step is trusted to have gained no more than this over the one
    // before.
    constexpr double kTrustedGain = 1e-3;
    IntegralResult result;
    double change = 0;
    for (const math::Quadrature& rule : gauss_rules()) {
        const double previous_change = change;
        const double before = result.value;
        result.value = integral.value(rule);
        result.nodes = static_cast<int>(rule.nodes.size());
        change = std::abs(result.value - before);
        result.error_estimate = std::max(change, kTrustedGain * previous_change);
        result.converged = has_converged(result.error_estimate, tolerance);
        if (result.converged && result.nodes > kFewestNodes) break;
    }
    return result;
}

double mean_with(const std::function<double(double)>& rho, HemisphereMean mean, int nodes) {
    const math::Quadrature rule = math::gauss_legendre(nodes, 0.0, 1.0);
    double sum = 0;
    for (int i = 0; i < nodes; ++i) {
        const double t = rule.nodes[i];
        const double mu = t * t;
        const double weight = 2.0 * t * rule.weights[i];
        sum += weight * (mean == HemisphereMean::cosine ? 2.0 * mu : 1.0) * (1.0 - rho(mu));
    }
    return sum;
}

}  // namespace

IntegralResult directional_reflectance(std::complex<double> refractive_index,
                                       const SurfaceOptions& options, double mu_in,
                                       double tolerance) {
    validate(options);
    const FresnelReflectance fresnel(refractive_index, options.fresnel);
    if (!(mu_in > 0 && mu_in <= 1)) {
        throw UsageError("mu_in", mu_in, "(0, 1]");
    }
    if (!(tolerance > 0)) {
        throw UsageError("tolerance", tolerance, "above 0");
    }
    if (options.distribution == MicrofacetDistribution::ggx) {
        return refine(ReflectanceIntegral<GgxSlopes>(fresnel, options, mu_in), tolerance);
    }
    return refine(ReflectanceIntegral<BeckmannSlopes>(fresnel, options, mu_in), tolerance);
}

IntegralResult mean_transmittance(const std::function<double(double mu)>& rho, HemisphereMean mean,
                                  double tolerance) {
    if (!(tolerance > 0)) {
        throw UsageError("tolerance", tolerance, "above 0");
    }
    constexpr int kFewest = 8;
    constexpr int kMost = 256;
    IntegralResult result;
    result.value = mean_with(rho, mean, kFewest);
    for (int nodes = 2 * kFewest; nodes <= kMost && !result.converged; nodes *= 2) {
        const double before = result.value;
        result.value = mean_with(rho, mean, nodes);
        result.nodes = nodes;
        result.error_estimate = std::abs(result.value - before);
        result.converged = has_converged(result.error_estimate, tolerance);
    }
    return result;
}

}  // namespace miebrdf::rte
