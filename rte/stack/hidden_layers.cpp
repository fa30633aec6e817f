#include "rte/stack/hidden_layers.h"

#include <algorithm>
#include <cmath>

#include "rte/fourier/fourier_mode.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf::rte {
namespace {

constexpr double kSafety = 10.0;  // bases that are not Lambertian
// Enough for transmissions to some per cent, which is all that a yes or no needs.
constexpr int kStreams = 16;
// Differences below this are rounding of the solver: nothing is left to see.
constexpr double kDarkest = 1e-13;
constexpr double kDeepestCoat = 1e100;

double largest(const std::vector<double>& cosines) {
    return cosines.empty() ? 1.0 : *std::max_element(cosines.begin(), cosines.end());
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
    if (albedo_only &&
        !(kSafety * mean <= kHiddenLayersShare * tolerance * black.spherical_albedo)) {
        return false;
    }
    for (std::size_t i = 0; i < incident; ++i) {
        const double allowed = kHiddenLayersShare * tolerance * black.plane_albedo[i];
        if (albedo_only && !(kSafety * visible(i) <= allowed)) return false;
        for (std::size_t o = incident; o < cosines.size(); ++o) {
            const double change = visible(i) * visible(o) / std::max(mean, kDarkest);
            if (!(kSafety * change <= allowed)) return false;
        }
    }
    return true;
}

bool hides_in_fourier_order(const FourierMedium& coat, double scaled_optical_depth,
                            double tolerance) {
    // With q = strongest(): U and V (eigenmodes.h) are at least (1 - q) M^-1, so that nothing
    // decays more slowly than exp(-(1 - q) tau). Down and up, times 4 for what the coat reflects
    // itself.
    constexpr double kCoatReflects = 4.0;
    const double slowest = 1.0 - coat.strongest();
    return slowest > 0.0 &&
           kCoatReflects * std::exp(-2.0 * slowest * scaled_optical_depth) <= tolerance;
}

bool is_bottomless(double optical_depth) { return std::isinf(optical_depth); }

double bounded_depth(double scaled_optical_depth) {
    return is_bottomless(scaled_optical_depth) ? scaled_optical_depth
                                               : std::min(scaled_optical_depth, kDeepestCoat);
}

Stack with_black_ground(Stack stack) {
    if (stack.base_kind != BaseKind::half_space) return stack;
    if (stack.base.single_scattering_albedo != 0.0) return stack;
    stack.base_kind = BaseKind::none;
    while (!stack.coats.empty() && stack.coats.front().optics.single_scattering_albedo == 0.0) {
        stack.coats.erase(stack.coats.begin());
    }
    return stack;
}

}  // namespace miebrdf::rte
