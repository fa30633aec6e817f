#include "rte/stack/hidden_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "rte/first_order/first_order.h"
#include "rte/fourier/fourier_mode.h"
#include "rte/grid/refraction_grid.h"
#include "rte/math/tolerance_budget.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/scaled_stack.h"

namespace miebrdf::rte {
namespace {

// (R of any base) / (R of a white ground) is at most this in any direction.
constexpr double kSafety = 100.0;

double largest(const std::vector<double>& cosines) {
    return cosines.empty() ? 1.0 : *std::max_element(cosines.begin(), cosines.end());
}

// At most `few` values of the list in equal steps, the first and the last among them.
std::vector<double> a_few_of(const std::vector<double>& values) {
    constexpr std::size_t few = 8;
    if (values.size() <= few) return values;
    std::vector<double> some;
    for (std::size_t i = 0; i < few; ++i)
        some.push_back(values[i * (values.size() - 1) / (few - 1)]);
    return some;
}

// The change of R between a black and a white base, at most: (2 k / v) / sinh(2 k tau), which falls
// with k; for k = 0 it is 1 / (v tau).
double most_visible(const Optics& coat, double optical_depth) {
    double odd = 0.0;
    for (std::size_t l = 1; l < coat.chi.size(); l += 2) odd = std::max(odd, std::abs(coat.chi[l]));
    const double u = coat.one_minus_albedo;
    const double v = u + coat.single_scattering_albedo * (1.0 - odd);
    const double x = 2.0 * std::sqrt(u * v) * optical_depth;
    return (x > 0.0 ? x / std::sinh(x) : 1.0) / (v * optical_depth);
}

// least_brightness of a half-space; for albedos (no mu_out) by R at mu_out = .5.
double least_brightness(const Optics& medium, Directions directions) {
    constexpr int moments = 32;
    if (directions.mu_out.empty()) directions = {std::move(directions.mu_in), {0.5}, {90.0}};
    return least_brightness(scale_stack({.base = medium}, moments, true).media, directions);
}

}  // namespace

bool may_hide(double optical_depth, const Directions& directions, double tolerance) {
    const double way = 1.0 / largest(directions.mu_in) + 1.0 / largest(directions.mu_out);
    return std::exp(-optical_depth * way) <= kHiddenLayersShare * tolerance;
}

bool hides_what_is_below(const Optics& coat, double optical_depth, const Directions& directions,
                         double tolerance) {
    if (!may_hide(optical_depth, directions, tolerance)) return false;
    if (is_bottomless(optical_depth)) return true;
    return kSafety * most_visible(coat, optical_depth) <=
           kHiddenLayersShare * tolerance * least_brightness(coat, directions);
}

double least_brightness(const std::vector<ScaledMedium>& media, const Directions& directions) {
    double least = std::numeric_limits<double>::infinity();
    const std::vector<double> mu_out = a_few_of(directions.mu_out);
    const std::vector<double> azimuths = a_few_of(directions.azimuth_deg);
    for (const double mu_in : directions.mu_in) {
        double brightest = 0.0;
        for (const double out : mu_out) {
            for (const double azimuth : azimuths) {
                const double cosine = std::cos(azimuth * (std::numbers::pi / 180.0));
                brightest = std::max(brightest, single_scattering(media, true, mu_in, out, cosine));
            }
        }
        least = std::min(least, brightest);
    }
    return std::isfinite(least) ? least : 0.0;
}

double least_brightness(const ScaledStack& stack, const Directions& directions) {
    return least_brightness(stack.media,
                            stack.refracts() ? refracted(directions, stack.top_index) : directions);
}

bool hides_in_fourier_order(const FourierMedium& coat, double scaled_optical_depth,
                            double allowed) {
    // With q = strongest(), U and V (eigenmodes.h) are at least (1 - q) M^-1, so that all modes
    // decay at least like exp(-(1 - q) tau), on the way down and again on the way up.
    const double slowest = 1.0 - coat.strongest();
    return slowest > 0.0 && std::exp(-2.0 * slowest * scaled_optical_depth) <= allowed;
}

bool is_bottomless(double optical_depth) { return std::isinf(optical_depth); }

double bounded_depth(double scaled_optical_depth) {
    return is_bottomless(scaled_optical_depth)
               ? scaled_optical_depth
               : std::min(scaled_optical_depth, std::cbrt(std::numeric_limits<double>::max()));
}

Stack with_black_ground(Stack stack) {
    if (stack.base_kind != BaseKind::half_space) return stack;
    if (stack.base.single_scattering_albedo != 0.0) return stack;
    // A step of the index reflects light, whatever the albedo below.
    const auto is_seen = [&] {
        return stack.boundary && !stack.coats.empty() &&
               stack.coats.front().index != stack.base_index;
    };
    if (is_seen()) return stack;
    stack.base_kind = BaseKind::none;
    while (!stack.coats.empty() && stack.coats.front().optics.single_scattering_albedo == 0.0 &&
           !is_seen()) {
        stack.coats.erase(stack.coats.begin());
    }
    return stack;
}

}  // namespace miebrdf::rte
