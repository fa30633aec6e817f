#include "rte/stack/hidden_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "rte/first_order/first_order.h"
#include "rte/fourier/fourier_mode.h"
#include "rte/grid/refraction_grid.h"
#include "rte/math/tolerance_budget.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/layered_reflection.h"
#include "rte/stack/stack_solver.h"

namespace miebrdf::rte {
namespace {

// Bases that are not Lambertian: what a base sends back where it came from may be brighter than a
// white ground by this.
constexpr double kSafety = 100.0;
// Enough for transmissions to some per cent, which is all that a yes or no needs.
constexpr int kStreams = 16;
constexpr double kDeepestCoat = 1e100;

double largest(const std::vector<double>& cosines) {
    return cosines.empty() ? 1.0 : *std::max_element(cosines.begin(), cosines.end());
}

// A few of a list, its ends among them.
std::vector<double> a_few_of(const std::vector<double>& values) {
    constexpr std::size_t few = 8;
    if (values.size() <= few) return values;
    std::vector<double> some;
    for (std::size_t i = 0; i < few; ++i)
        some.push_back(values[i * (values.size() - 1) / (few - 1)]);
    return some;
}

AlbedoTable albedo_over_ground(const Optics& coat, double optical_depth,
                               const std::vector<double>& cosines, double ground_albedo) {
    Stack stack;
    stack.base_kind = BaseKind::lambertian;
    stack.ground_albedo = ground_albedo;
    stack.coats = {{coat, optical_depth}};
    SolverOptions options;
    options.streams = kStreams;
    return albedo(stack, cosines, options);
}

// At each incidence the largest value that the coat itself sends to (some of) the directions; 0
// where 16 streams cannot tell.
std::vector<double> brightest_over_black(const Optics& coat, double optical_depth,
                                         const Directions& directions) {
    Stack stack;
    stack.base_kind = BaseKind::none;
    stack.coats = {{coat, optical_depth}};
    const Directions some{directions.mu_in, a_few_of(directions.mu_out),
                          a_few_of(directions.azimuth_deg)};
    SolverOptions options;
    options.streams = kStreams;
    const std::vector<double> values = reflect(stack, some, options).reflection;
    const std::size_t block = some.mu_out.size() * some.azimuth_deg.size();
    std::vector<double> brightest(some.mu_in.size(), 0.0);
    for (std::size_t k = 0; k < values.size(); ++k)
        if (values[k] > brightest[k / block]) brightest[k / block] = values[k];
    return brightest;
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
    std::vector<double> cosines = directions.mu_in;
    cosines.insert(cosines.end(), directions.mu_out.begin(), directions.mu_out.end());
    const AlbedoTable black = albedo_over_ground(coat, optical_depth, cosines, 0.0);
    const AlbedoTable white = albedo_over_ground(coat, optical_depth, cosines, 1.0);
    const auto visible = [&](std::size_t i) {
        return std::abs(white.plane_albedo[i] - black.plane_albedo[i]);
    };
    const double mean = std::abs(white.spherical_albedo - black.spherical_albedo);
    const std::size_t incident = directions.mu_in.size();
    const bool albedo_only = directions.mu_out.empty();
    const auto is_below = [&](double change, double value) {
        return kSafety * change <= kHiddenLayersShare * tolerance * value;
    };
    if (albedo_only && !is_below(mean, black.spherical_albedo)) return false;
    const std::vector<double> brightest =
        albedo_only ? black.plane_albedo : brightest_over_black(coat, optical_depth, directions);
    for (std::size_t i = 0; i < incident; ++i) {
        if (albedo_only && !is_below(visible(i), brightest[i])) return false;
        for (std::size_t o = incident; o < cosines.size(); ++o) {
            // Differences of this size are rounding: nothing is left to see.
            const double change =
                visible(i) * visible(o) / std::max(mean, std::numeric_limits<double>::epsilon());
            if (!is_below(change, brightest[i])) return false;
        }
    }
    return true;
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
    // With q = strongest(): U and V (eigenmodes.h) are at least (1 - q) M^-1, so that nothing
    // decays more slowly than exp(-(1 - q) tau), down and up.
    const double slowest = 1.0 - coat.strongest();
    return slowest > 0.0 && std::exp(-2.0 * slowest * scaled_optical_depth) <= allowed;
}

bool is_bottomless(double optical_depth) { return std::isinf(optical_depth); }

double bounded_depth(double scaled_optical_depth) {
    return is_bottomless(scaled_optical_depth) ? scaled_optical_depth
                                               : std::min(scaled_optical_depth, kDeepestCoat);
}

Stack with_black_ground(Stack stack) {
    if (stack.base_kind != BaseKind::half_space) return stack;
    if (stack.base.single_scattering_albedo != 0.0) return stack;
    // A step of the index is seen in the dark too.
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
