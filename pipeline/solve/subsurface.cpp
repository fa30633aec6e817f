// The colour of half-spaces of analytic media, and the albedo that a colour needs.
#include <miebrdf/layer_albedos.h>

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace miebrdf {
namespace {

/// The albedo of similarity s: half-spaces of the same s = ((1 - w) / (1 - g w))^1/2 look alike,
/// and their colour falls from 1 to 0 almost linearly where s is small.
double albedo_of_similarity(double s, double g) { return (1.0 - s * s) / (1.0 - g * s * s); }

double at(std::span<const double> list, std::size_t i) { return list[list.size() == 1 ? 0 : i]; }

/// Places that a colour and the bounds of its s have: the colour falls with s.
struct Bracket {
    double low = 0.0, high = 1.0;     ///< s
    double above = 0.0, below = 0.0;  ///< colour - wanted at them
    double s = 0.0;                   ///< to be looked at next
    bool is_found = false;

    /// The false position, whose stale end loses half of its value (Illinois).
    void look_between() { s = (low * below - high * above) / (below - above); }

    void take(double difference, double allowed) {
        if (std::abs(difference) <= allowed || high - low <= 1e-12) {
            is_found = true;
            return;
        }
        if (difference > 0.0) {
            low = s;
            above = difference;
            if (was_above) below *= 0.5;
        } else {
            high = s;
            below = difference;
            if (!was_above) above *= 0.5;
        }
        was_above = difference > 0.0;
        look_between();
    }

    bool was_above = false;
};

}  // namespace

std::vector<double> subsurface_colour(std::span<const double> single_scattering_albedo,
                                      std::span<const double> asymmetry,
                                      std::span<const double> host_index,
                                      const rte::SolverOptions& options, const Control& control) {
    const double infinite_depth[] = {std::numeric_limits<double>::infinity()}, zero[] = {0.0};
    const auto spherical = [&](std::span<const double> albedo) {
        return layer_albedos({albedo, asymmetry, infinite_depth, host_index, zero, {}}, options,
                             control)
            .spherical_albedo;
    };
    std::vector<double> colour = spherical(single_scattering_albedo);
    const std::vector<double> outside = spherical(zero);
    for (std::size_t i = 0; i < colour.size(); ++i) {
        const double r = at(outside, i);
        colour[i] = std::clamp((colour[i] - r) / (1.0 - r), 0.0, 1.0);
    }
    return colour;
}

std::vector<double> subsurface_albedo(std::span<const double> colour,
                                      std::span<const double> asymmetry,
                                      std::span<const double> host_index,
                                      const rte::SolverOptions& options, const Control& control) {
    for (std::size_t i = 0; i < colour.size(); ++i) {
        if (!(colour[i] >= 0.0 && colour[i] <= 1.0))
            throw UsageError(fmt::format("colour[{}]", i), colour[i], "[0, 1]");
    }
    std::size_t count = colour.size();
    for (const auto list : {asymmetry, host_index}) {
        if (list.size() != 1 && count == 1) count = list.size();
    }
    // What does not fit is refused with the place before anything is searched.
    std::vector<double> albedo(count, 1.0);
    subsurface_colour(albedo, asymmetry, host_index, options, control);
    std::vector<Bracket> brackets(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double wanted = at(colour, i);
        brackets[i].above = 1.0 - wanted;
        brackets[i].below = -wanted;
        brackets[i].is_found = wanted == 1.0 || wanted == 0.0;
        brackets[i].s = 1.0 - wanted;
    }
    constexpr int kMostSteps = 60;
    const double allowed = 0.01 * options.tolerance;
    for (int step = 0; step < kMostSteps; ++step) {
        std::vector<std::size_t> open;
        std::vector<double> w, g, n;
        for (std::size_t i = 0; i < count; ++i) {
            albedo[i] = albedo_of_similarity(brackets[i].s, at(asymmetry, i));
            if (brackets[i].is_found) continue;
            open.push_back(i);
            w.push_back(albedo[i]);
            g.push_back(at(asymmetry, i));
            n.push_back(at(host_index, i));
        }
        if (open.empty()) break;
        const std::vector<double> seen = subsurface_colour(w, g, n, options, control);
        for (std::size_t k = 0; k < open.size(); ++k)
            brackets[open[k]].take(seen[k] - at(colour, open[k]), allowed);
    }
    return albedo;
}

}  // namespace miebrdf
