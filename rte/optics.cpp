#include "rte/optics.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace miebrdf::rte {
namespace {

void require_albedo(double albedo) {
    if (!(albedo >= 0.0 && albedo <= 1.0)) {
        throw std::invalid_argument(
            fmt::format("single-scattering albedo {}; allowed: [0, 1]", albedo));
    }
}

Optics with_albedo(double single_scattering_albedo) {
    require_albedo(single_scattering_albedo);
    Optics optics;
    optics.single_scattering_albedo = single_scattering_albedo;
    optics.one_minus_albedo = 1.0 - single_scattering_albedo;
    return optics;
}

}  // namespace

void validate(const Optics& optics) {
    require_albedo(optics.single_scattering_albedo);
    const double sum = optics.single_scattering_albedo + optics.one_minus_albedo;
    // Two roundings of numbers up to 1; what a file prints with 12 digits passes as well.
    if (!(optics.one_minus_albedo >= 0.0 && std::abs(sum - 1.0) <= 1e-11)) {
        throw std::invalid_argument(
            fmt::format("one_minus_albedo {} with albedo {}: allowed is 1 - albedo within 1e-11",
                        optics.one_minus_albedo, optics.single_scattering_albedo));
    }
    if (optics.chi.empty() || !(std::abs(optics.chi[0] - 1.0) <= 1e-9)) {
        throw std::invalid_argument(
            fmt::format("chi_0 = {}; allowed: 1 within 1e-9 (the mean of P over the sphere)",
                        optics.chi.empty() ? std::nan("") : optics.chi[0]));
    }
    for (std::size_t l = 1; l < optics.chi.size(); ++l) {
        if (!(std::abs(optics.chi[l]) <= 1.0 + 1e-9)) {
            throw std::invalid_argument(
                fmt::format("chi_{} = {}; allowed: [-1, 1]", l, optics.chi[l]));
        }
    }
}

Optics isotropic_optics(double single_scattering_albedo) {
    return with_albedo(single_scattering_albedo);
}

Optics rayleigh_optics(double single_scattering_albedo) {
    Optics optics = with_albedo(single_scattering_albedo);
    optics.chi = {1.0, 0.0, 0.1};  // P = 3/4 (1 + cos^2) = 1 + P_2 / 2, chi_2 = 1 / (2 * 5)
    return optics;
}

Optics henyey_greenstein_optics(double single_scattering_albedo, double asymmetry) {
    Optics optics = with_albedo(single_scattering_albedo);
    const double g = asymmetry;
    if (!(g > -1.0 && g < 1.0)) {
        throw std::invalid_argument(fmt::format("asymmetry {}; allowed: (-1, 1)", g));
    }
    // Up to (2l+1) g^l below rounding, and never more than a peak of 1e-5 needs.
    constexpr std::size_t most_moments = 1 << 20;
    for (double moment = g; optics.chi.size() < most_moments; moment *= g) {
        if (!((2.0 * double(optics.chi.size()) + 1.0) * std::abs(moment) > 1e-17)) break;
        optics.chi.push_back(moment);
    }
    optics.phase = [g](double cos_theta) {
        // 1 + g^2 - 2 g cos, written so that nothing cancels in the peak (backward for g < 0).
        const double peak = 1.0 - std::abs(g);
        const double away = 1.0 - std::copysign(cos_theta, g * cos_theta);
        const double base = peak * peak + 2.0 * std::abs(g) * away;
        return (1.0 - g) * (1.0 + g) / (base * std::sqrt(base));
    };
    return optics;
}

}  // namespace miebrdf::rte
