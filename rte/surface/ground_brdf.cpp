// BRDFs of natural grounds in closed form: Rahman, Pinty & Verstraete; Ross-thick and Li-sparse
// kernels; Hapke.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include <miebrdf/surface.h>
#include "rte/math/quadrature.h"

namespace miebrdf::rte {
namespace {

using std::numbers::pi;

/// A pair of directions; g is the angle between them, psi = 180 deg - azimuth.
struct Pair {
    double in, out;  // cosines
    double sine_in, sine_out;
    double tan_in, tan_out;
    double one_plus_azimuth, one_minus_azimuth;  // 1 -+ cos(psi)
    double one_minus_g, one_plus_g;              // 1 -+ cos(g), without cancellation near g = 0

    Pair(double mu_in, double mu_out, double cos_azimuth)
        : in(mu_in),
          out(mu_out),
          sine_in(std::sqrt((1.0 - in) * (1.0 + in))),
          sine_out(std::sqrt((1.0 - out) * (1.0 + out))),
          tan_in(sine_in / in),
          tan_out(sine_out / out),
          one_plus_azimuth(1.0 + cos_azimuth),
          one_minus_azimuth(1.0 - cos_azimuth) {
        const double apart = (in - out) * (in - out) + (sine_in - sine_out) * (sine_in - sine_out);
        one_minus_g = std::min(2.0, 0.5 * apart + sine_in * sine_out * one_plus_azimuth);
        one_plus_g = 2.0 - one_minus_g;
    }

    double cos_g() const { return 1.0 - one_minus_g; }
    double half_tangent() const { return std::sqrt(one_minus_g / one_plus_g); }  // tan(g / 2)
    /// tan^2 i + tan^2 e - 2 tan i tan e cos psi.
    double squared_distance() const {
        return (tan_in - tan_out) * (tan_in - tan_out) + 2.0 * tan_in * tan_out * one_plus_azimuth;
    }
};

/// Rahman, Pinty & Verstraete 1993, J. Geophys. Res. 98, 20791, eq. (3) to (8).
double rpv(const std::array<double, 6>& v, const Pair& at) {
    const double rho0 = v[0], k = v[1], theta = v[2], rhoc = v[3];
    const double M = std::pow(at.in * at.out * (at.in + at.out), k - 1.0);
    const double F =
        (1.0 - theta * theta) / std::pow(1.0 + theta * theta + 2.0 * theta * at.cos_g(), 1.5);
    const double H = 1.0 + (1.0 - rhoc) / (1.0 + std::sqrt(at.squared_distance()));
    return rho0 * M * F * H;
}

/// Wanner, Li & Strahler 1995, J. Geophys. Res. 100, 21077, in the reciprocal form of MODIS (Lucht,
/// Schaaf & Strahler 2000, IEEE Trans. Geosci. Remote Sens. 38, 977, eq. 37 to 44): h/b = 2, b/r =
/// 1.
double ross_li(const std::array<double, 6>& v, const Pair& at) {
    const double g = 2.0 * std::atan(at.half_tangent());
    const double sum = at.in + at.out, product = at.in * at.out;
    const double volume = ((0.5 * pi - g) * at.cos_g() + std::sin(g)) / sum - 0.25 * pi;
    const double across = at.tan_in * at.tan_out;  // times sin psi
    const double cos_t =
        std::min(1.0, 2.0 * product / sum *
                          std::sqrt(at.squared_distance() +
                                    across * across * at.one_plus_azimuth * at.one_minus_azimuth));
    const double t = std::acos(cos_t);
    const double overlap = (t - std::sin(t) * cos_t) * sum / (pi * product);
    const double geometry = overlap - sum / product + 0.5 * at.one_plus_g / product;
    return v[0] + v[1] * volume + v[2] * geometry;
}

/// Hapke 2012, "Theory of reflectance and emittance spectroscopy", 2nd ed.: the anisotropic model
/// with the H function of Hapke 2002 (Icarus 157, 523, eq. 13), the surge by shadow hiding and
/// macroscopic roughness (Hapke 1984, Icarus 59, 41).
double hapke(const std::array<double, 6>& v, const Pair& at) {
    const double w = v[0], b = v[1], c = v[2], B0 = v[3], h = v[4], theta_deg = v[5];
    const double t = std::tan(theta_deg * (pi / 180.0));
    const double chi = 1.0 / std::sqrt(1.0 + pi * t * t);
    struct Tilted {
        double mu, sine, E1, E2, eta;
    };
    const auto tilted = [&](double mu, double sine) {
        const double x = mu / (sine * t);
        const double E1 = std::exp(-2.0 / pi * x), E2 = std::exp(-x * x / pi);
        return Tilted{mu, sine, E1, E2, chi * (mu + sine * t * E2 / (2.0 - E1))};
    };
    Tilted steep = tilted(at.in, at.sine_in), flat = tilted(at.out, at.sine_out);
    if (steep.mu < flat.mu) std::swap(steep, flat);
    const double cos_psi = 1.0 - at.one_plus_azimuth, sin2 = 0.5 * at.one_plus_azimuth;
    const double psi = std::acos(std::clamp(cos_psi, -1.0, 1.0));
    const double share = 2.0 - flat.E1 - psi / pi * steep.E1;
    const double mu_steep =
        chi * (steep.mu + steep.sine * t * (cos_psi * flat.E2 + sin2 * steep.E2) / share);
    const double mu_flat = chi * (flat.mu + flat.sine * t * (flat.E2 - sin2 * steep.E2) / share);
    const double f = std::exp(-2.0 * std::sqrt(at.one_plus_azimuth / at.one_minus_azimuth));
    const double shadowing = mu_steep * mu_flat * chi /
                             (steep.eta * flat.eta * (1.0 - f + f * chi * steep.mu / steep.eta));
    const double gamma = std::sqrt(1.0 - w), r0 = (1.0 - gamma) / (1.0 + gamma);
    const auto H = [&](double x) {
        return 1.0 / (1.0 - w * x * (r0 + (0.5 - r0 * x) * std::log1p(1.0 / x)));
    };
    const double even = 1.0 + b * b, lobe = 0.5 * (1.0 - b * b);
    const double P = lobe * ((1.0 + c) / std::pow(even - 2.0 * b * at.cos_g(), 1.5) +
                             (1.0 - c) / std::pow(even + 2.0 * b * at.cos_g(), 1.5));
    const double surge = B0 * h / (h + at.half_tangent());
    return 0.25 * w / (mu_steep + mu_flat) * (P * (1.0 + surge) + H(mu_steep) * H(mu_flat) - 1.0) *
           shadowing;
}

constexpr double kMany = 1e6;
constexpr GroundParameter kRpv[] = {
    {"rho0", 0.0, 2.0}, {"k", 0.0, 3.0}, {"theta", -0.99, 0.99}, {"rhoc", -kMany, kMany}};
constexpr GroundParameter kRossLi[] = {
    {"iso", 0.0, 2.0}, {"vol", -kMany, kMany}, {"geo", -kMany, kMany}};
constexpr GroundParameter kHapke[] = {{"w", 0.0, 1.0},    {"b", 0.0, 0.99},
                                      {"c", -1.0, 1.0},   {"b0", 0.0, kMany},
                                      {"h", 1e-6, kMany}, {"thetabar", 0.0, 60.0}};
constexpr GroundModel kModels[] = {{"rpv", kRpv, 3}, {"ross-li", kRossLi, 3}, {"hapke", kHapke, 6}};

}  // namespace

std::span<const GroundModel> ground_models() { return kModels; }

const GroundModel& GroundBrdf::model() const { return kModels[std::size_t(kind)]; }

double GroundBrdf::reflection(double mu_in, double mu_out, double cos_azimuth) const {
    const Pair at(mu_in, mu_out, std::clamp(cos_azimuth, -1.0, 1.0));
    switch (kind) {
        case Kind::rpv:
            return rpv(values, at);
        case Kind::ross_li:
            return ross_li(values, at);
        case Kind::hapke:
            break;
    }
    return hapke(values, at);
}

void validate(const GroundBrdf& ground) {
    std::size_t i = 0;
    for (const GroundParameter& one : ground.model().parameters) {
        const double value = ground.values[i++];
        if (value >= one.low && value <= one.high) continue;
        throw UsageError(fmt::format("{}: {} {}; allowed: {} to {}", ground.model().name, one.name,
                                     value, one.low, one.high));
    }
}

GroundEnergy energy_of(const GroundBrdf& ground) {
    constexpr int kNodes = 16;
    static const math::Quadrature mu = math::gauss_legendre(kNodes, 0.0, 1.0);
    static const math::Quadrature azimuth = math::gauss_legendre(kNodes, 0.0, pi);
    GroundEnergy energy;
    for (std::size_t i = 0; i < kNodes; ++i) {
        double plane = 0.0;
        for (std::size_t o = 0; o < kNodes; ++o) {
            for (std::size_t a = 0; a < kNodes; ++a) {
                const double R =
                    ground.reflection(mu.nodes[i], mu.nodes[o], std::cos(azimuth.nodes[a]));
                energy.is_negative = energy.is_negative || R < 0.0;
                plane += 2.0 / pi * mu.nodes[o] * mu.weights[o] * azimuth.weights[a] * R;
            }
        }
        if (plane > 1.0) energy.above_one_below_mu = mu.nodes[i];
        energy.spherical_albedo += 2.0 * mu.nodes[i] * mu.weights[i] * plane;
    }
    return energy;
}

}  // namespace miebrdf::rte
