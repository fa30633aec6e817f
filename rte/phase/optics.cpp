#include <miebrdf/optics.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <miebrdf/error.h>
#include "rte/math/legendre.h"
#include "rte/phase/polarisation.h"

namespace miebrdf::rte {
namespace {

void require_albedo(double albedo) {
    if (!(albedo >= 0.0 && albedo <= 1.0)) {
        throw UsageError("single_scattering_albedo", albedo, "[0, 1]");
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
        throw UsageError("one_minus_albedo", optics.one_minus_albedo,
                         fmt::format("1 - single_scattering_albedo within 1e-11, here {}",
                                     1.0 - optics.single_scattering_albedo));
    }
    if (optics.chi.empty() || !(std::abs(optics.chi[0] - 1.0) <= 1e-9)) {
        throw UsageError("chi[0]", optics.chi.empty() ? std::nan("") : optics.chi[0],
                         "1 within 1e-9 (the mean of P over the sphere)");
    }
    for (std::size_t l = 1; l < optics.chi.size(); ++l) {
        if (!(std::abs(optics.chi[l]) <= 1.0 + 1e-9)) {
            throw UsageError(fmt::format("chi[{}]", l), optics.chi[l], "[-1, 1]");
        }
    }
    if (optics.polarisation) validate(*optics.polarisation);
}

Optics isotropic_optics(double single_scattering_albedo) {
    return with_albedo(single_scattering_albedo);
}

Optics rayleigh_optics(double single_scattering_albedo, double depolarisation_factor) {
    Optics optics = with_albedo(single_scattering_albedo);
    const double rho = depolarisation_factor;
    if (!(rho >= 0.0 && rho <= 6.0 / 7.0)) {
        throw UsageError("depolarisation_factor", rho, "[0, 6/7]");
    }
    // P = 3/4 (1 + cos^2) = 1 + P_2 / 2 without depolarisation.
    optics.chi = {1.0, 0.0, 0.1 * (1.0 - rho) / (1.0 + 0.5 * rho)};
    optics.polarisation = rayleigh_polarisation(rho);
    return optics;
}

Optics henyey_greenstein_optics(double single_scattering_albedo, double asymmetry) {
    Optics optics = with_albedo(single_scattering_albedo);
    const double g = asymmetry;
    if (!(g > -1.0 && g < 1.0)) {
        throw UsageError("asymmetry", g, "(-1, 1)");
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

double MixedPhase::operator()(double cos_theta) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < components.size(); ++c) {
        const Optics& optics = components[c];
        sum += share[c] * (optics.phase ? optics.phase(cos_theta)
                                        : math::legendre_series(optics.chi, cos_theta));
    }
    return sum;
}

Optics mix(const std::vector<MixtureComponent>& components) {
    double extinction = 0.0;
    for (const MixtureComponent& component : components) {
        validate(component.optics);
        if (!(component.extinction >= 0.0 && std::isfinite(component.extinction))) {
            throw UsageError("extinction", component.extinction, "0 or more, finite");
        }
        extinction += component.extinction;
    }
    if (!(extinction > 0.0)) {
        throw UsageError("a mixture needs a component with extinction above 0");
    }

    Optics mixture;
    mixture.single_scattering_albedo = mixture.one_minus_albedo = 0.0;
    mixture.chi.clear();
    std::vector<double> scattering;
    bool any_phase = false;
    for (const MixtureComponent& component : components) {
        const Optics& optics = component.optics;
        const double share = component.extinction / extinction;
        scattering.push_back(share * optics.single_scattering_albedo);
        mixture.single_scattering_albedo += scattering.back();
        mixture.one_minus_albedo += share * optics.one_minus_albedo;
        mixture.chi.resize(std::max(mixture.chi.size(), optics.chi.size()), 0.0);
        any_phase = any_phase || bool(optics.phase);
    }
    if (mixture.single_scattering_albedo == 0.0) {
        mixture.chi = {1.0};  // nothing scatters: any phase function will do
        return mixture;
    }
    // Rounded shares may add up to more than 1; s / (s + a) never exceeds it.
    const double whole = mixture.single_scattering_albedo + mixture.one_minus_albedo;
    for (std::size_t c = 0; c < components.size(); ++c) {
        scattering[c] /= mixture.single_scattering_albedo;
        const std::vector<double>& chi = components[c].optics.chi;
        for (std::size_t l = 0; l < chi.size(); ++l) mixture.chi[l] += scattering[c] * chi[l];
    }
    mixture.chi.front() = 1.0;
    for (double& chi : mixture.chi) chi = std::clamp(chi, -1.0, 1.0);
    mixture.single_scattering_albedo /= whole;
    mixture.one_minus_albedo /= whole;
    for (const MixtureComponent& component : components) {
        if (!component.optics.has_more_moments)
            continue;  // beyond a list that was cut, none is known
        mixture.has_more_moments = true;
        mixture.chi.resize(std::min(mixture.chi.size(), component.optics.chi.size()));
    }
    MixedPhase phase{{}, std::move(scattering)};
    for (const MixtureComponent& component : components)
        phase.components.push_back(component.optics);
    mixture.polarisation = mix_polarisation(phase.components, phase.share);
    if (any_phase) mixture.phase = std::move(phase);
    return mixture;
}

void validate(const Boundary& boundary) {
    const double alpha = boundary.roughness;
    if (!(alpha == 0.0 || (alpha >= 0.02 && alpha <= 1.0)))
        throw UsageError("boundary", alpha, "0.02 to 1, or 0: smooth");
}

double top_index(const Stack& stack) {
    return stack.coats.empty() ? stack.base_index : stack.coats.back().index;
}

namespace {

void require_index(double index) {
    if (!(index >= kLeastIndex && index <= kLargestIndex)) {
        throw UsageError("host_index", index, "1 to 3 behind a boundary or over a mirror");
    }
}

// Below the least index nearly all light passes the facets straight on.
void require_rough_index(const Stack& stack) {
    const double top = top_index(stack);
    if (!(top - 1.0 < kLeastIndexStep || top >= kLeastRoughIndex))
        throw UsageError("host_index", top, "1, or 1.05 to 3 below a rough boundary");
}

// Indices matter for boundaries and mirrors only.
void validate_indices(const Stack& stack) {
    const std::complex<double> mirror = stack.mirror_index;
    if (stack.base_kind == BaseKind::mirror) {
        if (!(mirror.real() > 0.0 && mirror.imag() >= 0.0 && std::isfinite(std::abs(mirror))))
            throw UsageError("mirror_index", mirror.real(), "n > 0, k >= 0, finite");
    } else if (!stack.boundary) {
        return;
    }
    if (stack.boundary) {
        validate(*stack.boundary);
        if (stack.boundary->is_rough()) require_rough_index(stack);
    }
    if (stack.base_kind == BaseKind::half_space || stack.coats.empty())
        require_index(stack.base_index);
    for (const Coat& coat : stack.coats) require_index(coat.index);
}

}  // namespace

void validate(const Stack& stack) {
    validate_indices(stack);
    if (stack.base_kind == BaseKind::half_space) validate(stack.base);
    if (!(stack.ground_albedo >= 0.0 && stack.ground_albedo <= 1.0)) {
        throw UsageError("ground_albedo", stack.ground_albedo, "[0, 1]");
    }
    if (stack.base_kind == BaseKind::brdf) {
        validate(stack.ground);
        if (stack.boundary)
            throw UsageError("a ground by its BRDF lies in air; leave out the boundary");
    }
    for (const Coat& coat : stack.coats) {
        validate(coat.optics);
        if (!(coat.optical_depth >= 0.0)) {
            throw UsageError("optical_depth", coat.optical_depth, "0 or more");
        }
    }
}

}  // namespace miebrdf::rte
