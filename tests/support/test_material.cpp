#include "tests/support/test_material.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace miebrdf::support {
namespace {

double hapke_h(double mu, double albedo) {
    return (1 + 2 * mu) / (1 + 2 * mu * std::sqrt(1 - albedo));
}

double sine(double mu) { return std::sqrt((1 - mu) * (1 + mu)); }

}  // namespace

TestMaterial::TestMaterial(std::vector<double> wavelength_nm, double asymmetry)
    : wavelength_nm_(std::move(wavelength_nm)),
      channels_(channel_names(wavelength_nm_)),
      asymmetry_(asymmetry) {
    provenance_.version = "miebrdf test";
    provenance_.command_line = "miebrdf export --base 'test \"material\"'";
    provenance_.title = "half-space of Henyey-Greenstein scatterers";
    provenance_.sources = {"a closed form"};
}

double TestMaterial::brdf(const Direction& d, double albedo) const {
    const double cos_theta =
        -d.mu_in * d.mu_out +
        sine(d.mu_in) * sine(d.mu_out) * std::cos(d.azimuth_deg * std::numbers::pi / 180);
    const double g = asymmetry_;
    const double phase = (1 - g * g) / std::pow(1 + g * g - 2 * g * cos_theta, 1.5);
    return albedo / (4 * std::numbers::pi * (d.mu_in + d.mu_out)) *
               (phase - 1 + hapke_h(d.mu_in, albedo) * hapke_h(d.mu_out, albedo)) +
           lobe(d);
}

void TestMaterial::evaluate(std::span<const Direction> directions, std::span<double> values) const {
    const std::size_t count = wavelength_nm_.size();
    for (std::size_t d = 0; d < directions.size(); ++d) {
        for (std::size_t w = 0; w < count; ++w) {
            const double share =
                count > 1 ? static_cast<double>(w) / static_cast<double>(count - 1) : 0.5;
            values[d * count + w] = brdf(directions[d], 0.55 + 0.4 * share);
        }
    }
}

SharpMaterial::SharpMaterial(std::vector<double> wavelength_nm, double beckmann_alpha)
    : TestMaterial(std::move(wavelength_nm), 0.4), alpha_(beckmann_alpha) {}

double SharpMaterial::lobe(const Direction& d) const {
    const double azimuth = d.azimuth_deg * std::numbers::pi / 180;
    const double hx = sine(d.mu_in) - sine(d.mu_out) * std::cos(azimuth);
    const double hy = sine(d.mu_out) * std::sin(azimuth);
    const double hz = d.mu_in + d.mu_out;
    const double tan2 = (hx * hx + hy * hy) / (hz * hz);
    const double cos4 = std::pow(1 / (1 + tan2), 2);
    // Divided by (mu_in + mu_out)^2 in place of a shadowing term: bounded and reciprocal.
    return 0.05 * std::exp(-tan2 / (alpha_ * alpha_)) /
           (std::numbers::pi * alpha_ * alpha_ * cos4 * hz * hz);
}

ColouredMaterial::ColouredMaterial()
    : spectral(seven_wavelengths(), 0.4), rgb(spectral, nearest_wavelengths(seven_wavelengths())) {}

const TestMaterial& material() {
    static const TestMaterial instance(seven_wavelengths(), 0.4);
    return instance;
}

std::vector<double> seven_wavelengths() { return {400, 450, 500, 550, 600, 650, 700}; }

}  // namespace miebrdf::support
