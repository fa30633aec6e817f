#include "tests/render/analytic_brdf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "pipeline/render/sampler.h"

namespace miebrdf::render {
namespace {

std::vector<double> unit_interval(std::vector<double> values, const char* name) {
    for (const double value : values) {
        if (!(value >= 0.0 && value <= 1.0)) {
            throw std::invalid_argument(fmt::format("{} {}; allowed: [0, 1]", name, value));
        }
    }
    return values;
}

}  // namespace

LambertianBrdf::LambertianBrdf(std::vector<double> albedo)
    : albedo_(unit_interval(std::move(albedo), "albedo")) {}

void LambertianBrdf::evaluate(double, double, double, std::span<double> brdf) const {
    for (std::size_t w = 0; w < albedo_.size(); ++w) brdf[w] = albedo_[w] / std::numbers::pi;
}

LommelSeeligerBrdf::LommelSeeligerBrdf(std::vector<double> single_scattering_albedo)
    : albedo_(unit_interval(std::move(single_scattering_albedo), "single-scattering albedo")) {}

void LommelSeeligerBrdf::evaluate(double mu_in, double mu_out, double,
                                  std::span<double> brdf) const {
    const double shape = 1.0 / (4.0 * std::numbers::pi * (mu_in + mu_out));
    for (std::size_t w = 0; w < albedo_.size(); ++w) brdf[w] = albedo_[w] * shape;
}

RoughLobeBrdf::RoughLobeBrdf(std::vector<double> reflectance, double alpha)
    : reflectance_(unit_interval(std::move(reflectance), "reflectance")), alpha_(alpha) {
    if (!(alpha > 0.0 && alpha <= 2.0)) {
        throw std::invalid_argument(fmt::format("roughness {}; allowed: (0, 2]", alpha));
    }
}

void RoughLobeBrdf::evaluate(double mu_in, double mu_out, double cos_azimuth,
                             std::span<double> brdf) const {
    const HalfVector half = half_vector(mu_in, mu_out, cos_azimuth);
    const double g = 2.0 * half.cos_normal / half.cos_light;
    const double shape = beckmann_density(half.cos_normal, alpha_) *
                         std::min(1.0, g * std::min(mu_in, mu_out)) / (4.0 * mu_in * mu_out);
    for (std::size_t w = 0; w < reflectance_.size(); ++w) brdf[w] = reflectance_[w] * shape;
}

}  // namespace miebrdf::render
