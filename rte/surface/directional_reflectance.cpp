// How much of the light from one direction a rough surface reflects, and means of it.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>
#include <vector>

#include <miebrdf/error.h>
#include <miebrdf/surface.h>
#include "rte/math/quadrature.h"
#include "rte/math/tolerance_budget.h"
#include "rte/surface/fresnel.h"
#include "rte/surface/microfacet.h"
#include "rte/surface/reflectance_table.h"
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

/// Chebyshev polynomials of 2 cos - 1. Fresnel's reflectance has a pole as far from the horizon as
/// 1 / |m|, which for 2 + 8i leaves 1e-8 to degrees of 48 and beyond.
constexpr int kPolynomials = 48;
struct FacetPolynomials {
    using Values = Eigen::Array<double, kPolynomials, 1>;
    Values operator()(double cos_facet) const {
        const double t = 2.0 * cos_facet - 1.0;
        Values values;
        values[0] = 1.0;
        values[1] = t;
        for (int j = 2; j < kPolynomials; ++j) values[j] = 2.0 * t * values[j - 1] - values[j - 2];
        return values;
    }
};

/// @tparam Reflectance  of a facet, by the cosine of incidence: a number, or an Eigen array
template <typename Slopes, typename Reflectance>
class ReflectanceIntegral {
  public:
    using Value = std::invoke_result_t<Reflectance, double>;

    /// @param critical_cosine  FresnelReflectance::critical_cosine
    ReflectanceIntegral(const Reflectance& fresnel, double critical_cosine,
                        const SurfaceOptions& options, double mu_in)
        : slopes_{options.beckmann_alpha},
          in_(mu_in),
          fresnel_(fresnel),
          shadowing_(options),
          in_over_masking_(shadowing_.cosine_over_masking(mu_in)),
          has_kinks_(options.shadowing == Shadowing::v_cavity),
          critical_cosine_(critical_cosine) {}

    Value value(const math::Quadrature& rule) const {
        const double largest = slopes_.across_of(in_.largest_y());
        Value sum = zero();
        double from = 0;
        for (const double corner : corners()) {
            const double to = std::min(slopes_.across_of(corner), largest);
            sum += strip(from, to, rule);
            from = std::max(from, to);
        }
        return 2.0 * (sum + strip(from, largest, rule));  // y and -y are alike
    }

  private:
    static Value zero() {
        if constexpr (std::is_arithmetic_v<Value>) {
            return 0.0;
        } else {
            return Value::Zero();
        }
    }

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
    Value strip(double from, double to, const math::Quadrature& rule) const {
        Value sum = zero();
        if (!(to > from)) return sum;
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

    Value line(double v, const math::Quadrature& rule) const {
        const double y = slopes_.y(v);
        const double end = slopes_.along_of(in_.highest_x(y), v);
        double from = slopes_.along_of(in_.lowest_x(y), v);
        bool root_first = false;
        Value sum = zero();
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
    Value segment(double v, double y, Cut first, Cut last, const math::Quadrature& rule) const {
        const double length = last.x - first.x;
        Value sum = zero();
        if (!(length > 0.0)) return sum;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const auto [share, slope] = share_of(rule.nodes[i], first.is_root, last.is_root);
            const double u = first.x + length * share;
            sum +=
                rule.weights[i] * slope * slopes_.along_density(u) * reflected(slopes_.x(u, v), y);
        }
        return length * sum;
    }

    /// (1 + x tan) G F of the mirrors with slopes (x, y).
    Value reflected(double x, double y) const {
        const double r2 = x * x + y * y;
        const double facing = in_.mu() + x * in_.sine();
        const double mu_out = (in_.mu() * (1.0 - r2) + 2.0 * x * in_.sine()) / (1.0 + r2);
        if (!(mu_out > 0 && facing > 0)) return zero();  // rounding at the ends of the line
        const double cos_half = 1.0 / std::sqrt(1.0 + r2);
        const double cos_facet = std::min(1.0, facing * cos_half);
        const double shadowing =
            shadowing_({in_.mu(), std::min(1.0, mu_out), cos_half, cos_facet}, in_over_masking_);
        return facing * mu_out * shadowing * fresnel_(cos_facet);
    }

    Slopes slopes_;
    SlopePlane in_;
    Reflectance fresnel_;
    ShadowingOverCosines shadowing_;
    double in_over_masking_;
    bool has_kinks_;
    double critical_cosine_;
};

double size_of(double change) { return std::abs(change); }
/// Coefficients of reflectances fall about as fast as this, so that integrals of high polynomials
/// need fewer digits. What they have in the end is in the bound on each value.
double size_of(const FacetPolynomials::Values& change) {
    constexpr double fall = 1.5;
    double size = 0.0, share = 1.0;
    for (const double one : change) {
        size = std::max(size, share * std::abs(one));
        share /= fall;
    }
    return size;
}

/// @param value   zero; the integral
/// @param change  the last change of it, by twice as many nodes
template <typename Integral>
IntegralResult refine(const Integral& integral, double tolerance, typename Integral::Value& value,
                      typename Integral::Value& change) {
    // Convergence is exponential (kinks lie on the ends of strips and segments), but two coarse
    // rules can agree by accident: a step is trusted to have gained no more than this over the one
    // before.
    constexpr double kTrustedGain = 1e-3;
    IntegralResult result;
    double size = 0.0;
    for (const math::Quadrature& rule : gauss_rules()) {
        const double previous_size = size;
        const typename Integral::Value before = value;
        value = integral.value(rule);
        result.nodes = static_cast<int>(rule.nodes.size());
        change = value - before;
        size = size_of(change);
        result.error_estimate = std::max(size, kTrustedGain * previous_size);
        result.converged = has_converged(result.error_estimate, tolerance);
        if (result.converged && result.nodes > kFewestNodes) break;
    }
    return result;
}

/// @param value, change  as refine has them
template <typename Reflectance, typename Value>
IntegralResult integrate(const Reflectance& reflectance, double critical_cosine,
                         const SurfaceOptions& options, double mu_in, double tolerance,
                         Value& value, Value& change) {
    if (!(mu_in > 0 && mu_in <= 1)) {
        throw UsageError("mu_in", mu_in, "(0, 1]");
    }
    if (options.distribution == MicrofacetDistribution::ggx) {
        return refine(ReflectanceIntegral<GgxSlopes, Reflectance>(reflectance, critical_cosine,
                                                                  options, mu_in),
                      tolerance, value, change);
    }
    return refine(ReflectanceIntegral<BeckmannSlopes, Reflectance>(reflectance, critical_cosine,
                                                                   options, mu_in),
                  tolerance, value, change);
}

/// Of reflectances in a table; SurfaceLobe has the same.
constexpr double kTableTolerance = 1e-6;

/// Of each integral: errors of the first ten add up, those of higher ones hardly count.
constexpr double kShareOfIntegral = 0.1;

/// T_j at the points cos(pi (i + 1/2) / count), from which coefficients are taken.
double chebyshev_angle(int point) { return pi * (point + 0.5) / kPolynomials; }

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
    if (!(tolerance > 0)) {
        throw UsageError("tolerance", tolerance, "above 0");
    }
    double value = 0.0, change = 0.0;
    IntegralResult result =
        integrate(fresnel, fresnel.critical_cosine(), options, mu_in, tolerance, value, change);
    result.value = value;
    return result;
}

ReflectanceTable::ReflectanceTable(const SurfaceOptions& options, std::vector<double> mu_in,
                                   std::size_t indices)
    : options_(options), mu_in_(std::move(mu_in)) {
    validate(options);
    constexpr std::size_t worth_a_table = 5;
    if (indices < worth_a_table) return;
    const auto cosines = Eigen::Index(mu_in_.size());
    integrals_.resize(cosines, kPolynomials);
    errors_.resize(cosines, kPolynomials);
    for (Eigen::Index k = 0; k < cosines; ++k) {
        FacetPolynomials::Values integral = FacetPolynomials::Values::Zero(), change = integral;
        integrate(FacetPolynomials{}, 0.0, options, mu_in_[std::size_t(k)],
                  kShareOfIntegral * kTableTolerance, integral, change);
        integrals_.row(k) = integral;
        errors_.row(k) = change.abs();
    }
    // a_j = (2 - delta_j0) / count sum_i T_j(point i) F(point i).
    coefficients_.resize(kPolynomials, kPolynomials);
    for (int j = 0; j < kPolynomials; ++j) {
        for (int i = 0; i < kPolynomials; ++i)
            coefficients_(j, i) =
                (j == 0 ? 1.0 : 2.0) / kPolynomials * std::cos(j * chebyshev_angle(i));
    }
}

std::vector<double> ReflectanceTable::at(std::complex<double> refractive_index) const {
    Eigen::VectorXd reflectances, bounds;
    if (integrals_.size() > 0) {
        const FresnelReflectance fresnel(refractive_index, options_.fresnel);
        Eigen::VectorXd at_points(kPolynomials);
        for (int i = 0; i < kPolynomials; ++i)
            at_points[i] = fresnel(0.5 * (1.0 + std::cos(chebyshev_angle(i))));
        const Eigen::VectorXd a = coefficients_ * at_points;
        // What is left out, and what it adds to the coefficients, is below the sum of the last
        // eight where those fall to a third over eight. Facets reflect no more than all light.
        const double left_out = a.tail<8>().cwiseAbs().sum();
        reflectances = integrals_ * a;
        bounds = (errors_ * a.cwiseAbs()).array() + left_out;
    }
    std::vector<double> all;
    all.reserve(mu_in_.size());
    for (std::size_t k = 0; k < mu_in_.size(); ++k) {
        const auto row = Eigen::Index(k);
        const bool is_known = row < bounds.size() && bounds[row] <= kTableTolerance;
        all.push_back(is_known ? reflectances[row]
                               : directional_reflectance(refractive_index, options_, mu_in_[k],
                                                         kTableTolerance)
                                     .value);
    }
    return all;
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
