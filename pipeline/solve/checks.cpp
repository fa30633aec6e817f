#include "pipeline/solve/checks.h"

#include <miebrdf/ensemble.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "pipeline/solve/packing.h"
#include "rte/first_order/first_order.h"
#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

/// Where each value is in a list, if it is there.
std::vector<std::optional<std::size_t>> places_of(const std::vector<double>& values,
                                                  const std::vector<double>& list) {
    std::vector<std::optional<std::size_t>> places;
    for (const double value : values) {
        const auto found = std::find(list.begin(), list.end(), value);
        auto& place = places.emplace_back();
        if (found != list.end()) place = static_cast<std::size_t>(found - list.begin());
    }
    return places;
}

/// A layer whose phase function has noise: R of single scattering per P.
struct NoisyLayer {
    std::vector<std::pair<const mie::PhaseTable*, double>> tables;  ///< with their shares
    double strength;                                                ///< alpha / (1 - alpha f)
    double optical_depth;                                           ///< scaled by delta-M
};

/// The tables of a phase function, or of all that a mixture is made of.
void add_tables(const rte::Optics& optics, double share,
                std::vector<std::pair<const mie::PhaseTable*, double>>& tables) {
    if (const auto* table = optics.phase.target<mie::PhaseTable>())
        tables.emplace_back(table, share);
    if (const auto* crowded = optics.phase.target<CrowdedPhase>())
        add_tables(crowded->alone, share, tables);
    if (const auto* mixed = optics.phase.target<rte::MixedPhase>()) {
        for (std::size_t c = 0; c < mixed->components.size(); ++c)
            add_tables(mixed->components[c], share * mixed->share[c], tables);
    }
}

void add_layer(const rte::Optics& optics, double optical_depth, int moments,
               std::vector<NoisyLayer>& layers) {
    std::vector<std::pair<const mie::PhaseTable*, double>> tables;
    add_tables(optics, 1.0, tables);
    if (tables.empty()) return;
    const auto cutoff = static_cast<std::size_t>(std::max(moments, 0));
    const double f = cutoff < optics.chi.size() ? optics.chi[cutoff] : 0.0;
    const double factor = 1.0 - optics.single_scattering_albedo * f;
    layers.push_back(
        {std::move(tables), optics.single_scattering_albedo / factor, optical_depth * factor});
}

double noise_of(const std::vector<NoisyLayer>& layers, double mu_in, double mu_out,
                double cos_azimuth) {
    const double cos_theta = rte::cos_scattering_angle(mu_in, mu_out, cos_azimuth);
    const double slant = 1.0 / mu_in + 1.0 / mu_out;
    double sum = 0.0;
    for (const NoisyLayer& layer : layers) {
        double noise = 0.0;
        for (const auto& [table, share] : layer.tables) noise += share * table->noise(cos_theta);
        sum += layer.strength * noise * -std::expm1(-layer.optical_depth * slant);
    }
    return sum / (4.0 * (mu_in + mu_out));
}

}  // namespace

PhysicsReport physics_of(const std::vector<double>& values, const Directions& directions) {
    const auto& [mu_in, mu_out, azimuth] = directions;
    PhysicsReport report;
    report.least_value = *std::min_element(values.begin(), values.end());
    const double largest = *std::max_element(values.begin(), values.end());
    const auto swapped_in = places_of(mu_out, mu_in), swapped_out = places_of(mu_in, mu_out);
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        for (std::size_t o = 0; o < mu_out.size(); ++o) {
            const auto back_in = swapped_in[o], back_out = swapped_out[i];
            if (!back_in || !back_out) continue;
            for (std::size_t a = 0; a < azimuth.size(); ++a) {
                const double there = values[(i * mu_out.size() + o) * azimuth.size() + a];
                const double back =
                    values[(*back_in * mu_out.size() + *back_out) * azimuth.size() + a];
                const double defect = there == back ? 0.0 : std::abs(there - back) / largest;
                report.reciprocity_defect =
                    std::max(report.reciprocity_defect.value_or(0.0), defect);
            }
        }
    }
    return report;
}

PhaseNoise largest_phase_noise(const rte::Stack& stack, const Directions& directions,
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

double rest_of_tolerance(double tolerance, double mie_error_estimate) {
    return std::max(tolerance - mie_error_estimate, 0.5 * tolerance);
}

void judge(WavelengthReport& report, double mie_error_estimate, bool mie_converged,
           double tolerance) {
    report.mie_error_estimate = mie_error_estimate;
    report.error_estimate = report.solver.error_estimate + mie_error_estimate;
    report.converged =
        has_converged(report.error_estimate, tolerance, report.solver.converged, mie_converged);
}

}  // namespace miebrdf
