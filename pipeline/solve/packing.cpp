#include "pipeline/solve/packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/sphere.h>
#include "pipeline/cache/job_key.h"
#include "rte/first_order/first_order.h"
#include "rte/math/quadrature.h"

namespace miebrdf {
namespace {

// Beyond this, moments of P S cost more than all the rest, and crowding only changes diffraction.
constexpr double kLargestSizeParameter = 300.0;
constexpr int kNodesPerPanel = 12;
constexpr double kPi = std::numbers::pi;

/// sum_k (-1)^k y^(2k) / ((2k + 1)! (2k + power)): the integral of x^(power - 1) sin(yx) / (yx).
double series(double y, int power) {
    double sum = 0.0, term = 1.0;
    for (int k = 0; k < 14; ++k) {
        sum += term / (2 * k + power);
        term *= -y * y / ((2 * k + 2) * (2 * k + 3));
    }
    return sum;
}

double kd_of(const ResolvedSpecies& species, std::size_t w) {
    const Particles& at = species.particles[w];
    const double k_per_um = 2.0e3 * kPi * at.host_index / at.wavelength_nm;
    return 2.0 * k_per_um * species.outer_radius_um;
}

/// A sphere of this radius, or with such a core.
std::vector<mie::SphereLayer> layers_of(const Particles& at, double radius_um) {
    const double k_per_um = 2.0e3 * kPi * at.host_index / at.wavelength_nm;
    const double core = k_per_um * radius_um;
    std::vector<mie::SphereLayer> layers = {{at.index / at.host_index, core}};
    for (const mie::ParticleCoating& coating : at.coatings) {
        layers.push_back({coating.refractive_index / at.host_index,
                          layers.back().size_parameter + k_per_um * coating.thickness_um +
                              coating.share_of_radius * core});
    }
    return layers;
}

/// Gauss nodes over (0, pi) that resolve `degrees` Legendre functions and S(q); weights of
/// sin(theta) d theta / 2.
math::Quadrature angles_for(double kd, int degrees) {
    const double fastest = std::max({kd, double(degrees), 20.0});
    const int panels = static_cast<int>(std::ceil(kPi * fastest / 4.0));
    const math::Quadrature rule = math::gauss_legendre(kNodesPerPanel, 0.0, 1.0);
    math::Quadrature all;
    for (int p = 0; p < panels; ++p) {
        for (int i = 0; i < kNodesPerPanel; ++i) {
            const double theta = kPi * (p + rule.nodes[i]) / panels;
            all.nodes.push_back(theta);
            all.weights.push_back(0.5 * std::sin(theta) * kPi / panels * rule.weights[i]);
        }
    }
    return all;
}

/// Means over the sphere of `values` at the angles times P_l, l = 0 ... count - 1.
std::vector<double> moments_of(const math::Quadrature& angles, const std::vector<double>& values,
                               std::size_t count) {
    std::vector<double> chi(count, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double mu = std::cos(angles.nodes[i]), weight = angles.weights[i] * values[i];
        double before = 0.0, here = 1.0;
        for (std::size_t l = 0; l < count; ++l) {
            chi[l] += weight * here;
            const double n = static_cast<double>(l);
            const double next = ((2.0 * n + 1.0) * mu * here - n * before) / (n + 1.0);
            before = here;
            here = next;
        }
    }
    return chi;
}

/// Between values at 0, 1, 2, ... through the four nearest.
double cubic_at(const std::vector<double>& values, double x) {
    const auto last = static_cast<double>(values.size()) - 4.0;
    const double start = std::clamp(std::floor(x) - 1.0, 0.0, last);
    const double t = x - start;
    const double* const v = &values[static_cast<std::size_t>(start)];
    return -v[0] * (t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0 +
           v[1] * t * (t - 2.0) * (t - 3.0) / 2.0 - v[2] * t * (t - 1.0) * (t - 3.0) / 2.0 +
           v[3] * t * (t - 1.0) * (t - 2.0) / 6.0;
}

/// |<F>|^2 / <|F|^2> at angles alike apart, of spheres of the effective radius.
std::vector<double> coherent_shares(const ResolvedSpecies& species, std::size_t w, double kd) {
    constexpr double kStep = 0.15;  // of kd times the angle: cubics then err by 1e-5
    const int intervals = static_cast<int>(std::ceil(kPi * std::max(kd, 20.0) / kStep));
    std::vector<double> degrees;
    for (int i = 0; i <= intervals; ++i) degrees.push_back(180.0 * i / intervals);
    const std::size_t count = degrees.size();
    std::vector<std::complex<double>> mean_s1(count), mean_s2(count);
    std::vector<double> intensity(count), shares(count);
    for (const CrowdMember& member : species.crowd) {
        const auto f = mie::scattering_amplitudes(
            layers_of(member.particles[w], species.effective_radius_um), degrees);
        for (std::size_t i = 0; i < count; ++i) {
            mean_s1[i] += member.share * f.s1[i];
            mean_s2[i] += member.share * f.s2[i];
            intensity[i] += member.share * (std::norm(f.s1[i]) + std::norm(f.s2[i]));
        }
    }
    for (std::size_t i = 0; i < count; ++i)
        shares[i] = (std::norm(mean_s1[i]) + std::norm(mean_s2[i])) / intensity[i];
    return shares;
}

Structure structure_of(const ResolvedSpecies& species, std::size_t w) {
    Structure structure{species.crowd_fraction, kd_of(species, w)};
    if (!species.crowd.empty()) structure.coherent = coherent_shares(species, w, structure.kd);
    return structure;
}

}  // namespace

double percus_yevick(double volume_fraction, double qd) {
    const double f = volume_fraction, y = qd;
    const double gap = std::pow(1.0 - f, 4);
    const double a = (1.0 + 2.0 * f) * (1.0 + 2.0 * f) / gap;
    const double b = -6.0 * f * (1.0 + 0.5 * f) * (1.0 + 0.5 * f) / gap;
    const double c = 0.5 * f * a;
    constexpr double kSmall = 1.5;  // where the closed forms still lose digits
    if (y < kSmall)
        return 1.0 / (1.0 + 24.0 * f * (a * series(y, 3) + b * series(y, 4) + c * series(y, 6)));
    const double sine = std::sin(y), cosine = std::cos(y), y2 = y * y;
    const double first = (sine - y * cosine) / (y2 * y);
    const double second = (2.0 * y * sine + (2.0 - y2) * cosine - 2.0) / (y2 * y2);
    const double third =
        (-y2 * y2 * cosine + 4.0 * ((3.0 * y2 - 6.0) * cosine + (y2 * y - 6.0 * y) * sine + 6.0)) /
        (y2 * y2 * y2);
    return 1.0 / (1.0 + 24.0 * f * (a * first + b * second + c * third));
}

double Structure::operator()(double cos_theta) const {
    const double sine_of_half = std::sqrt(std::max(0.0, 0.5 * (1.0 - cos_theta)));
    const double s = percus_yevick(volume_fraction, 2.0 * kd * sine_of_half);
    if (coherent.empty()) return s;
    const auto intervals = static_cast<double>(coherent.size() - 1);
    return 1.0 + (s - 1.0) * cubic_at(coherent, 2.0 * std::asin(sine_of_half) / kPi * intervals);
}

double CrowdedPhase::factor(double cos_theta) const { return structure(cos_theta) / mean; }

double CrowdedPhase::operator()(double cos_theta) const {
    return alone.phase(cos_theta) * factor(cos_theta);
}

std::string crowd_key(const ResolvedSpecies& species, std::size_t w) {
    JobKey key("crowd");
    key.add(species.crowd_fraction);
    for (const CrowdMember& member : species.crowd) key.add(member.share).add(member.key[w]);
    return key.hash();
}

MediumOptics crowded(const MediumOptics& alone, const ResolvedSpecies& species, std::size_t w,
                     const std::vector<double>& angles_deg) {
    const double kd = kd_of(species, w);
    if (kd > 2.0 * kLargestSizeParameter) {
        throw UsageError(fmt::format(
            "medium '{}': its size parameter is {:.4g} at {} nm; packing percus-yevick goes up to "
            "{}: crowding of larger spheres changes their forward diffraction alone",
            describe(species.species), 0.5 * kd, species.particles[w].wavelength_nm,
            kLargestSizeParameter));
    }
    CrowdedPhase phase{alone.optics, structure_of(species, w), 1.0};
    const std::size_t count = alone.optics.chi.size();
    const math::Quadrature angles = angles_for(kd, static_cast<int>(count));
    std::vector<double> values;
    for (const double theta : angles.nodes) values.push_back(phase(std::cos(theta)));
    MediumOptics whole = alone;
    whole.optics.chi = moments_of(angles, values, count);
    phase.mean = whole.optics.chi.front();
    for (double& chi : whole.optics.chi) chi /= phase.mean;
    whole.asymmetry = count > 1 ? whole.optics.chi[1] : 0.0;
    const double scattered = alone.optics.single_scattering_albedo * phase.mean;
    const double extinction = scattered + alone.optics.one_minus_albedo;
    whole.optics.single_scattering_albedo = scattered / extinction;
    whole.optics.one_minus_albedo = alone.optics.one_minus_albedo / extinction;
    whole.q_ext = alone.q_ext.value_or(0.0) * extinction;
    for (std::size_t i = 0; i < whole.phase.size(); ++i) {
        const double factor = phase.factor(std::cos(angles_deg[i] * kPi / 180.0));
        whole.phase[i] *= factor;
        if (i < whole.phase_error.size()) whole.phase_error[i] *= factor;
    }
    whole.optics.phase = std::move(phase);
    return whole;
}

std::optional<double> crowding(const ResolvedSpecies& species, std::size_t w) {
    const double kd = kd_of(species, w);
    constexpr double kLargest = 60.0;
    if (0.5 * kd > kLargest) return std::nullopt;
    const math::Quadrature angles = angles_for(kd, static_cast<int>(4.0 * kd) + 20);
    std::vector<double> degrees;
    for (const double theta : angles.nodes) degrees.push_back(theta * 180.0 / kPi);
    const auto amplitudes = mie::scattering_amplitudes(
        layers_of(species.particles[w], species.effective_radius_um), degrees);
    const Structure structure = structure_of(species, w);
    double alone = 0.0, together = 0.0;  // of the scattering, weighted by 1 - cos
    for (std::size_t i = 0; i < degrees.size(); ++i) {
        const double mu = std::cos(angles.nodes[i]), away = 1.0 - mu;
        const double intensity = std::norm(amplitudes.s1[i]) + std::norm(amplitudes.s2[i]);
        const double part = angles.weights[i] * away * intensity;
        alone += part;
        together += part * structure(mu);
    }
    return together / alone;
}

}  // namespace miebrdf
