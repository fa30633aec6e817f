#include "tools/bench/approximations.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::bench {
namespace {

struct KubelkaMunk {
    double K, S;
};

KubelkaMunk kubelka_munk_coefficients(const SimpleLayer& layer) {
    const double a = layer.single_scattering_albedo;
    return {2 * (1 - a), (3 * a * (1 - layer.asymmetry) - (1 - a)) / 4};
}

// Meador & Weaver 1980, table 1, row "Eddington", after delta scaling with f = g^2.
struct TwoStream {
    double omega, tau, g1, g2, k, g;

    explicit TwoStream(const SimpleLayer& layer) {
        const double f = layer.asymmetry * layer.asymmetry;
        const double a = layer.single_scattering_albedo;
        g = (layer.asymmetry - f) / (1 - f);
        tau = layer.optical_depth * (1 - a * f);
        // Without absorption k = 0 and the formulas are 0/0; the limit is approached to about 1e-6.
        omega = std::min((1 - f) * a / (1 - a * f), 1 - 1e-12);
        g1 = (7 - omega * (4 + 3 * g)) / 4;
        g2 = -(1 - omega * (4 - 3 * g)) / 4;
        k = std::sqrt((g1 - g2) * (g1 + g2));
    }

    double gamma3(double mu) const { return (2 - 3 * g * mu) / 4; }

    double base_plane(double mu) const {
        const double g3 = gamma3(mu);
        const double alpha2 = g1 * g3 + g2 * (1 - g3);
        return omega * (alpha2 + k * g3) / ((1 + k * mu) * (k + g1));
    }
    double base_diffuse() const { return g2 / (g1 + k); }

    double layer_diffuse_reflectance() const {
        const double e = std::exp(-2 * k * tau);
        return g2 * (1 - e) / (k + g1 + (k - g1) * e);
    }
    double layer_diffuse_transmittance() const {
        const double e = std::exp(-2 * k * tau);
        return 2 * k * std::exp(-k * tau) / (k + g1 + (k - g1) * e);
    }

    struct Beam {
        double reflected, transmitted_diffuse, direct;
    };

    // Eq. 14 and 15, all terms divided by exp(k tau), so that thick layers do not overflow.
    Beam layer_beam(double mu) const {
        // k mu = 1 is a removable singularity; 1e-6 beside it the result has moved as little.
        if (std::abs(k * mu - 1) < 1e-6) mu *= 1 - 2e-6;
        const double g3 = gamma3(mu), g4 = 1 - g3;
        const double a1 = g1 * g4 + g2 * g3, a2 = g1 * g3 + g2 * g4;
        const double direct = std::exp(-tau / mu);
        const double e1 = std::exp(-k * tau), e2 = e1 * e1;
        const double factor = omega / ((1 - k * mu) * (1 + k * mu) * (k + g1 + (k - g1) * e2));
        const double up = (1 - k * mu) * (a2 + k * g3) - (1 + k * mu) * (a2 - k * g3) * e2 -
                          2 * k * (g3 - a2 * mu) * direct * e1;
        const double down = (1 + k * mu) * (a1 + k * g4) * direct -
                            (1 - k * mu) * (a1 - k * g4) * direct * e2 -
                            2 * k * (g4 + a1 * mu) * e1;
        return {factor * up, -factor * down, direct};
    }
};

}  // namespace

std::optional<double> kubelka_munk_reflectance(const SimpleStack& stack) {
    const auto [K, S] = kubelka_munk_coefficients(stack.base);
    if (!(S > 0)) return std::nullopt;
    const double ratio = K / S;
    const double base = 1 / (1 + ratio + std::sqrt(ratio * (ratio + 2)));
    return stack.coat ? kubelka_munk_film(*stack.coat, base) : base;
}

std::optional<double> kubelka_munk_film(const SimpleLayer& film, double ground) {
    const auto [K, S] = kubelka_munk_coefficients(film);
    if (!(S > 0)) return std::nullopt;
    const double a = 1 + K / S;
    const double b = std::sqrt((a - 1) * (a + 1));
    const double depth = S * film.optical_depth;
    // b coth(b S X) tends to 1 / (S X) without absorption.
    const double coth = b * depth > 1e-8 ? b / std::tanh(b * depth) : 1 / depth;
    return (1 - ground * (a - coth)) / (a - ground + coth);
}

double saunderson(double body, double outer, double internal) {
    return outer + (1 - outer) * (1 - internal) * body / (1 - internal * body);
}

std::optional<double> diffusion_reflectance(const SimpleStack& stack, double internal) {
    if (stack.coat) return std::nullopt;
    const double a = stack.base.single_scattering_albedo, g = stack.base.asymmetry;
    const double reduced = a * (1 - g) / (1 - a * g);
    const double s = std::sqrt(3 * (1 - a) / (1 - a * g));
    const double higher = (1 + internal) / (1 - internal);
    return reduced / 2 * (1 + std::exp(-4.0 / 3 * higher * s)) * std::exp(-s);
}

double two_stream_plane_albedo(const SimpleStack& stack, double mu_in) {
    const TwoStream base(stack.base);
    if (!stack.coat) return base.base_plane(mu_in);
    const TwoStream coat(*stack.coat);
    const auto beam = coat.layer_beam(mu_in);
    const double below = base.base_diffuse();
    const double up_below = beam.direct * base.base_plane(mu_in) + beam.transmitted_diffuse * below;
    return beam.reflected + up_below * coat.layer_diffuse_transmittance() /
                                (1 - below * coat.layer_diffuse_reflectance());
}

double single_scattering_reflection(const SimpleStack& stack, double mu_in, double mu_out,
                                    double coat_phase, double base_phase) {
    const double q = 1 / mu_in + 1 / mu_out;
    const double scale = 1 / (4 * (mu_in + mu_out));
    const double base = scale * stack.base.single_scattering_albedo * base_phase;
    if (!stack.coat) return base;
    const double depth = stack.coat->optical_depth * q;
    return std::exp(-depth) * base -
           std::expm1(-depth) * scale * stack.coat->single_scattering_albedo * coat_phase;
}

}  // namespace miebrdf::bench
