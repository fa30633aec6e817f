#include "pipeline/solve/phase_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mie/ensemble/phase_table.h"
#include "rte/first_order/first_order.h"

namespace miebrdf {
namespace {

/// A layer whose phase function has noise: R of single scattering per P.
struct NoisyLayer {
    const mie::PhaseTable* table;
    double strength;       ///< alpha / (1 - alpha f)
    double optical_depth;  ///< scaled by delta-M
};

void add_layer(const rte::Optics& optics, double optical_depth, int moments,
               std::vector<NoisyLayer>& layers) {
    const auto* table = optics.phase.target<mie::PhaseTable>();
    if (table == nullptr) return;
    const auto cutoff = static_cast<std::size_t>(std::max(moments, 0));
    const double f = cutoff < optics.chi.size() ? optics.chi[cutoff] : 0.0;
    const double factor = 1.0 - optics.single_scattering_albedo * f;
    layers.push_back({table, optics.single_scattering_albedo / factor, optical_depth * factor});
}

double noise_of(const std::vector<NoisyLayer>& layers, double mu_in, double mu_out,
                double cos_azimuth) {
    const double cos_theta = rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    const double slant = 1.0 / mu_in + 1.0 / mu_out;
    double sum = 0.0;
    for (const NoisyLayer& layer : layers) {
        sum += layer.strength * layer.table->noise(cos_theta) *
               -std::expm1(-layer.optical_depth * slant);
    }
    return sum / (4.0 * (mu_in + mu_out));
}

}  // namespace

PhaseNoise largest_phase_noise(const rte::Stack& stack, const rte::Directions& directions,
                               const std::vector<double>& reflection, int moments) {
    std::vector<NoisyLayer> layers;
    if (stack.base_kind == rte::BaseKind::half_space) {
        add_layer(stack.base, std::numeric_limits<double>::infinity(), moments, layers);
    }
    for (const rte::Coat& coat : stack.coats) {
        add_layer(coat.optics, coat.optical_depth, moments, layers);
    }
    if (layers.empty()) return {};
    const std::size_t per_incidence = directions.mu_out.size() * directions.azimuth_deg.size();
    PhaseNoise worst;
    for (std::size_t i = 0; i < directions.mu_in.size(); ++i) {
        const auto first = reflection.begin() + static_cast<std::ptrdiff_t>(i * per_incidence);
        const double brightest =
            *std::max_element(first, first + static_cast<std::ptrdiff_t>(per_incidence));
        if (!(brightest > 0)) continue;
        for (const double mu_out : directions.mu_out) {
            for (const double azimuth_deg : directions.azimuth_deg) {
                const double cos_azimuth = std::cos(azimuth_deg * std::numbers::pi / 180);
                const double noise =
                    noise_of(layers, directions.mu_in[i], mu_out, cos_azimuth) / brightest;
                if (noise > worst.largest)
                    worst = {noise, directions.mu_in[i], mu_out, azimuth_deg};
            }
        }
    }
    return worst;
}

}  // namespace miebrdf
