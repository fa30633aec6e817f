#include "pipeline/solve/phase_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pipeline/solve/checks.h"
#include "pipeline/solve/packing.h"
#include "rte/first_order/first_order.h"
#include "rte/grid/refraction_grid.h"
#include "rte/phase/scaled_medium.h"
#include "rte/stack/refracted_first_order.h"

namespace miebrdf {
namespace {

/// Of an error of P that is known by its rms.
constexpr double kDeviations = 2.0;
/// Where the moments come from the same table, its errors are in them, too, and the forward peak
/// falls to nothing over the degrees that they may have: what an error of P does lies between what
/// degrees beyond the peak do (0) and what the lowest that delta-M cuts off do (1). Low degrees
/// prevail, but for straight back, where all degrees add up. Measured against tables for
/// --mie-tolerance 1e-5 (docs/internals/mie-log.md#errors-of-tables-seen-through-the-forward-peak).
struct PeakShare {
    double mean = 0.0;
    double doubt = 0.0;  ///< rms
};
constexpr PeakShare kPeakShare = {0.9, 0.1}, kPeakShareBeforeBack = {1.0, 0.2},
                    kPeakShareNearBack = {0.6, 0.2};
/// Less than the rms, which is 0.1 for a pair of large spheres and 0.2 for all that were measured:
/// 0.13 leaves 13 wavelengths of 31 of the pair unconverged, of which those looked at err by half
/// of 1e-3.
constexpr PeakShare kPeakShareBack = {0.3, 0.05};
// Cosines of 165, 176.4 and 179.3 degrees.
constexpr double kBeforeBack = -0.9659, kNearBack = -0.9980, kStraightBack = -0.999925;

PeakShare peak_share(double cos_theta) {
    if (cos_theta > kBeforeBack) return kPeakShare;
    if (cos_theta > kNearBack) return kPeakShareBeforeBack;
    return cos_theta > kStraightBack ? kPeakShareNearBack : kPeakShareBack;
}

/// The phase function of one species of a layer.
struct PhasePart {
    const mie::PhaseTable* table = nullptr;
    const CrowdedPhase* crowded = nullptr;  ///< null: the species alone
    double share = 1.0;                     ///< of the layer's scattering
    std::size_t species = 0;                ///< of the medium

    /// What it adds to the layer's P, per its own.
    double factor(double cos_theta) const {
        return crowded == nullptr ? share : share * crowded->factor(cos_theta);
    }
};

struct PhaseLayer {
    std::vector<PhasePart> parts = {};  ///< none: nothing errs
    double albedo = 0.0;
    double depth_factor = 1.0;  ///< of delta-M
    double optical_depth = 0.0;
};

/// The parts of a layer's phase function that come from Mie theory.
std::vector<PhasePart> parts_of(const rte::Optics& optics) {
    std::vector<PhasePart> parts;
    const auto add = [&](const rte::Optics& one, double share, std::size_t species) {
        PhasePart part{.share = share, .species = species};
        part.table = one.phase.target<mie::PhaseTable>();
        part.crowded = one.phase.target<CrowdedPhase>();
        if (part.crowded != nullptr)
            part.table = part.crowded->alone.phase.target<mie::PhaseTable>();
        if (part.table != nullptr) parts.push_back(part);
    };
    const auto* mixed = optics.phase.target<rte::MixedPhase>();
    if (mixed == nullptr) {
        add(optics, 1.0, 0);
    } else {
        for (std::size_t s = 0; s < mixed->components.size(); ++s)
            add(mixed->components[s], mixed->share[s], s);
    }
    return parts;
}

/// The layers from the top down.
std::vector<PhaseLayer> layers_of(const SolvedLayers& solved) {
    std::vector<PhaseLayer> layers;
    const auto add = [&](const rte::Optics& optics, double optical_depth) {
        const auto scaled = rte::scale_optics(optics, std::max(1, solved.moments), solved.delta_m);
        layers.push_back({parts_of(optics), optics.single_scattering_albedo, scaled.depth_factor,
                          optical_depth});
    };
    const rte::Stack& stack = solved.stack;
    for (auto coat = stack.coats.rbegin(); coat != stack.coats.rend(); ++coat)
        add(coat->optics, coat->optical_depth);
    if (stack.base_kind == rte::BaseKind::half_space)
        add(stack.base, std::numeric_limits<double>::infinity());
    return layers;
}

/// What an error of a layer's P does to R.
struct Weight {
    double scattered = 0.0;  ///< dR / dP of what the forward peak does not reach
    double by_peak = 0.0;    ///< more than that where it is in the moments, times PeakShare

    double value(double cos_theta) const {
        return scattered + peak_share(cos_theta).mean * by_peak;
    }
    double doubt(double cos_theta) const { return peak_share(cos_theta).doubt * by_peak; }
};

/// Of each layer at a pair of cosines.
void find_weights(const std::vector<PhaseLayer>& layers, double mu_in, double mu_out,
                  std::vector<Weight>& weights) {
    const double q = 1.0 / mu_in + 1.0 / mu_out;
    double above = 0.25 / (mu_in + mu_out), above_scaled = above;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const PhaseLayer& layer = layers[i];
        const double slant = layer.optical_depth * q, scaled = slant * layer.depth_factor;
        const double as_peak =
            above_scaled * layer.albedo / layer.depth_factor * -std::expm1(-scaled);
        const double as_scattered = above * layer.albedo * -std::expm1(-slant);
        const bool in_moments =
            !layer.parts.empty() &&
            std::all_of(layer.parts.begin(), layer.parts.end(),
                        [](const PhasePart& part) { return part.table->parts().gave_moments; });
        weights[i] =
            in_moments ? Weight{as_scattered, as_peak - as_scattered} : Weight{as_peak, 0.0};
        above *= std::exp(-slant);
        above_scaled *= std::exp(-scaled);
    }
}

/// Calls visit(index, cos Theta, weights of the layers, largest value at that incidence).
/// @param index  under a smooth boundary, else 1
template <typename Visit>
void for_each_direction(const std::vector<PhaseLayer>& layers, double index,
                        const Directions& directions, const std::vector<double>& reflection,
                        const Visit& visit) {
    const auto& [mu_in, mu_out, azimuths] = directions;
    const std::size_t block = mu_out.size() * azimuths.size();
    std::vector<double> cosines;
    cosines.reserve(azimuths.size());
    std::vector<Weight> weights(layers.size());
    for (const double azimuth : azimuths)
        cosines.push_back(std::cos(azimuth * (std::numbers::pi / 180.0)));
    std::size_t k = 0;
    for (const double in : mu_in) {
        const auto first = reflection.begin() + static_cast<std::ptrdiff_t>(k);
        const double brightest =
            *std::max_element(first, first + static_cast<std::ptrdiff_t>(block));
        const double inner_in = rte::refracted_cosine(index, in);
        for (const double out : mu_out) {
            const double inner_out = rte::refracted_cosine(index, out);
            find_weights(layers, inner_in, inner_out, weights);
            const double paths = rte::straight_paths_factor(index, in, out);
            for (Weight& weight : weights) {
                weight.scattered *= paths;
                weight.by_peak *= paths;
            }
            for (const double cosine : cosines) {
                visit(k++, rte::cos_scattering_angle(inner_in, inner_out, cosine), weights,
                      brightest);
            }
        }
    }
}

// A rough boundary averages over angles.
bool is_rough(const rte::Stack& stack) { return stack.boundary && stack.boundary->is_rough(); }

// As boundaries see the topmost layer. Layers of other hosts and beams that mirrors send back see
// other angles; their noise is taken as that of the topmost one's.
double index_of(const rte::Stack& stack) { return stack.boundary ? rte::top_index(stack) : 1.0; }

bool has_one_index(const rte::Stack& stack) {
    if (stack.base_kind == rte::BaseKind::mirror) return false;
    if (!stack.boundary) return true;
    const double index = rte::top_index(stack);
    return (stack.base_kind != rte::BaseKind::half_space || stack.base_index == index) &&
           std::all_of(stack.coats.begin(), stack.coats.end(),
                       [=](const rte::Coat& coat) { return coat.index == index; });
}

bool any_noisy(const std::vector<PhaseLayer>& layers) {
    return std::any_of(layers.begin(), layers.end(),
                       [](const PhaseLayer& layer) { return !layer.parts.empty(); });
}

/// P of one layer at one angle, anew.
struct Point {
    double allowed = std::numeric_limits<double>::infinity();
    double change = 0.0;  ///< against the table
    double noise = 0.0;   ///< rms
};

/// By angle, of each part of each layer; angles that differ by rounding are one.
using Points = std::vector<std::vector<std::map<double, Point>>>;

double angle_of(double cos_theta) {
    constexpr double step = 1e-6;  // degrees
    return step * std::round(std::acos(cos_theta) * (180.0 / std::numbers::pi) / step);
}

/// P of a species at the angles of its points, from as many sizes as that takes.
void find_points(const ResolvedSpecies& species, std::size_t w, const OpticsDemand& demand,
                 const PhasePart& part, const mie::Executor& run, std::map<double, Point>& points) {
    std::vector<double> angles_deg, errors;
    for (const auto& [angle, point] : points) {
        angles_deg.push_back(std::clamp(angle, 0.0, 180.0));
        errors.push_back(kDeviations * point.allowed);
    }
    const mie::PhaseValues values =
        phase_of_mie(species, w, demand, *part.table, angles_deg, errors, run);
    std::size_t at = 0;
    for (auto& [angle, point] : points) {
        point.change =
            values.phase[at] - (*part.table)(std::cos(angles_deg[at] * std::numbers::pi / 180.0));
        point.noise = values.error[at] / kDeviations;
        // A bounded number of sizes may do worse than the table.
        const double of_table =
            part.table->noise(std::cos(angles_deg[at] * std::numbers::pi / 180.0));
        if (!(point.noise < of_table)) point = {point.allowed, 0.0, of_table};
        ++at;
    }
}

/// What a point may err by where the doubt about the peak takes a part of what is left of the
/// tolerance there: the part that points do not have in any case, then theirs, but for half of it.
double beside_doubt(double allowed, double doubt) {
    const double left = allowed / kShareOfPoints;
    const double rest = std::sqrt(std::max(left * left - doubt * doubt, 0.0));
    return std::clamp(rest, 0.5 * allowed, allowed);
}

// NaN, too, and for good.
void raise(double& largest, double value) {
    if (value > largest || std::isnan(value)) largest = value;
}

PhaseErrors errors_left(const std::vector<PhaseLayer>& layers, const SolvedLayers& solved,
                        const std::vector<double>& reflection, const Points& points) {
    const Directions& directions = solved.directions;
    const std::size_t azimuths = directions.azimuth_deg.size(), outs = directions.mu_out.size();
    PhaseErrors worst;
    for_each_direction(
        layers, index_of(solved.stack), directions, reflection,
        [&](std::size_t k, double cos_theta, const std::vector<Weight>& weights, double brightest) {
            const double of_transfer = solved.transfer_errors[k];
            double noise = 0.0;
            for (std::size_t i = 0; i < layers.size(); ++i) {
                for (std::size_t p = 0; p < layers[i].parts.size(); ++p) {
                    const PhasePart& part = layers[i].parts[p];
                    double own = part.table->noise(cos_theta), change = 0.0;
                    if (!points.empty() && !points[i][p].empty()) {
                        const auto known = points[i][p].find(angle_of(cos_theta));
                        if (known != points[i][p].end()) {
                            own = known->second.noise;
                            change = known->second.change;
                        }
                    }
                    const double factor = part.factor(cos_theta);
                    noise = std::hypot(noise, factor * weights[i].value(cos_theta) * own,
                                       factor * weights[i].doubt(cos_theta) * change);
                }
            }
            noise = brightest > 0.0 ? noise / brightest : 0.0;
            raise(worst.with_transfer, of_transfer + kDeviations * noise);
            if (!(noise > worst.noise.largest)) return;
            worst.noise = {noise, directions.mu_in[k / azimuths / outs],
                           directions.mu_out[k / azimuths % outs],
                           directions.azimuth_deg[k % azimuths]};
        });
    return worst;
}

PhaseErrors of_transfer_alone(const SolvedLayers& solved) {
    PhaseErrors errors;
    for (const double error : solved.transfer_errors) raise(errors.with_transfer, error);
    return errors;
}

}  // namespace

PhaseErrors phase_errors(const SolvedLayers& layers, const std::vector<double>& reflection) {
    const std::vector<PhaseLayer> list = layers_of(layers);
    if (!any_noisy(list) || is_rough(layers.stack)) return of_transfer_alone(layers);
    return errors_left(list, layers, reflection, {});
}

bool has_noisy_phase(const rte::Stack& stack) {
    const auto is_noisy = [](const rte::Optics& optics) { return !parts_of(optics).empty(); };
    return (stack.base_kind == rte::BaseKind::half_space && is_noisy(stack.base)) ||
           std::any_of(stack.coats.begin(), stack.coats.end(),
                       [&](const rte::Coat& coat) { return is_noisy(coat.optics); });
}

PhaseErrors refine_phase(const ResolvedScene& scene, std::size_t w, const OpticsDemand& demand,
                         const SolvedLayers& solved, const std::vector<double>& allowed,
                         std::vector<double>& reflection, const mie::Executor& run) {
    const std::vector<PhaseLayer> layers = layers_of(solved);
    if (!any_noisy(layers) || is_rough(solved.stack) || !has_one_index(solved.stack))
        return phase_errors(solved, reflection);
    const double index = index_of(solved.stack);
    Points points(layers.size());
    std::size_t parts = 0;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        points[i].resize(layers[i].parts.size());
        parts += layers[i].parts.size();
    }
    // An rms; parts err independently of each other.
    const double share = 1.0 / (kDeviations * std::sqrt(static_cast<double>(parts)));
    for_each_direction(
        layers, index, solved.directions, reflection,
        [&](std::size_t k, double cos_theta, const std::vector<Weight>& weights, double brightest) {
            const double largest = share * allowed[k] * std::max(brightest, 0.0);
            for (std::size_t i = 0; i < layers.size(); ++i) {
                for (std::size_t p = 0; p < layers[i].parts.size(); ++p) {
                    const PhasePart& part = layers[i].parts[p];
                    const double factor = part.factor(cos_theta);
                    const double weight = weights[i].value(cos_theta) * factor;
                    if (!(weight > 0.0)) continue;
                    const double noise = part.table->noise(cos_theta);
                    if (noise <= largest / weight) continue;
                    // The table's noise is what P will change by, as far as is known before.
                    const double doubt = weights[i].doubt(cos_theta) * factor * noise;
                    const double enough = beside_doubt(largest, doubt) / weight;
                    Point& point = points[i][p][angle_of(cos_theta)];
                    point.allowed = std::min(point.allowed, enough);
                }
            }
        });
    for (std::size_t i = 0; i < layers.size(); ++i) {
        // The layers that show are the scene's topmost.
        const ResolvedMedium& medium = scene.media[scene.media.size() - 1 - i];
        for (std::size_t p = 0; p < layers[i].parts.size(); ++p) {
            const PhasePart& part = layers[i].parts[p];
            if (!points[i][p].empty())
                find_points(medium.species[part.species], w, demand, part, run, points[i][p]);
        }
    }
    for_each_direction(
        layers, index, solved.directions, reflection,
        [&](std::size_t k, double cos_theta, const std::vector<Weight>& weights, double) {
            for (std::size_t i = 0; i < layers.size(); ++i) {
                for (std::size_t p = 0; p < layers[i].parts.size(); ++p) {
                    if (points[i][p].empty()) continue;
                    const auto point = points[i][p].find(angle_of(cos_theta));
                    if (point == points[i][p].end()) continue;
                    reflection[k] += weights[i].value(cos_theta) *
                                     layers[i].parts[p].factor(cos_theta) * point->second.change;
                }
            }
        });
    return errors_left(layers, solved, reflection, points);
}

}  // namespace miebrdf
