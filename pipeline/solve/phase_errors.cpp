#include "pipeline/solve/phase_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "pipeline/solve/checks.h"
#include "pipeline/solve/packing.h"
#include "rte/first_order/first_order.h"
#include "rte/math/tolerance_budget.h"
#include "rte/stack/scaled_stack.h"

namespace miebrdf {
namespace {

/// An estimate of an error of P that is known by its rms is so many times that.
constexpr double kDeviations = 2.0;
/// Where the moments come from the same table, its errors are in them, too:
///     dR/dP = scattered + share by_peak,
/// where the share is 1 for errors of the lowest degrees that delta-M cuts off and falls with the
/// forward peak to 0 for degrees beyond it. Low degrees prevail, but straight back all degrees add
/// up. Mean and rms of 44, 311 and 198 changes of R by points of P, as measured
/// (docs/internals/mie-log.md#errors-of-tables-seen-through-the-forward-peak).
struct PeakShare {
    double mean, doubt;
};
constexpr PeakShare kForward = {0.72, 0.40}, kAside = {0.89, 0.13}, kStraightBack = {0.47, 0.22};

bool is_straight_back(double cos_theta) { return cos_theta < -0.998; }  // beyond 176.4 degrees

const PeakShare& peak_share(double cos_theta) {
    if (is_straight_back(cos_theta)) return kStraightBack;
    return cos_theta > 0.5 ? kForward : kAside;
}

/// The phase function of one species of a layer.
struct PhasePart {
    const mie::PhaseTable* table = nullptr;
    const CrowdedPhase* crowded = nullptr;  ///< null: the species alone
    double share = 1.0;                     ///< of the layer's scattering
    std::size_t species = 0;                ///< of the medium

    /// (Contribution of this part to the layer's P) / (P of the part).
    double factor(double cos_theta) const {
        return crowded == nullptr ? share : share * crowded->factor(cos_theta);
    }
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

/// The change of R by an error of a layer's P.
struct Weight {
    double scattered = 0.0;  ///< dR / dP of what the forward peak does not reach
    double by_peak = 0.0;    ///< more than that where it is in the moments, times PeakShare

    double value(double cos_theta) const {
        return scattered + peak_share(cos_theta).mean * by_peak;
    }
    double doubt(double cos_theta) const { return peak_share(cos_theta).doubt * by_peak; }
};

/// One part of one layer at one scattering angle, and the change of R in a direction by its errors.
struct Term {
    std::size_t layer, part;
    double cos_theta;
    double value, doubt;  ///< of Weight, times the part's share
};

/// The index of each scaled medium among the media of the stack, counted from the top. Layers of
/// depth 0 scatter nothing and keep 0.
std::vector<std::size_t> places_from_top(const rte::Stack& stack, const rte::ScaledStack& scaled) {
    std::vector<std::size_t> with_depth, places(scaled.media.size(), 0);
    for (std::size_t c = 0; c < stack.coats.size(); ++c) {
        if (stack.coats[stack.coats.size() - 1 - c].optical_depth > 0.0) with_depth.push_back(c);
    }
    with_depth.push_back(stack.coats.size());  // the base
    std::size_t next = 0;
    for (std::size_t i = scaled.media.size(); i-- > 0;) {
        if (scaled.media[i].scaled_optical_depth > 0.0) places[i] = with_depth[next++];
    }
    return places;
}

/// The phase functions with errors in the layers of a scene, and dR/dP of each.
class NoisyLayers {
  public:
    explicit NoisyLayers(const SolvedLayers& solved)
        : solved_(solved),
          scaled_(rte::scale_stack(solved.stack, std::max(1, solved.moments), solved.delta_m)),
          unscaled_(rte::scale_stack(solved.stack, 1, false)) {
        for (const rte::ScaledMedium& medium : scaled_.media) {
            parts_.push_back(parts_of(medium.exact));
            const std::vector<PhasePart>& parts = parts_.back();
            in_moments_.push_back(std::all_of(
                parts.begin(), parts.end(),
                [](const PhasePart& part) { return part.table->parts().gave_moments; }));
            part_count_ += parts.size();
        }
        places_ = places_from_top(solved.stack, scaled_);
        // Below a rough boundary R averages P over angles, and its errors.
        if (solved.stack.boundary && solved.stack.boundary->is_rough()) part_count_ = 0;
    }
    NoisyLayers(const NoisyLayers&) = delete;

    /// 0: no phase function has errors.
    std::size_t part_count() const { return part_count_; }
    /// From the bottom up.
    std::size_t layers() const { return parts_.size(); }
    const std::vector<PhasePart>& parts(std::size_t layer) const { return parts_[layer]; }
    /// Among the stack's media, from the top down.
    std::size_t place(std::size_t layer) const { return places_[layer]; }

    /// Calls visit(index, terms, largest value at that incidence) for each direction.
    template <typename Visit>
    void for_each_direction(const std::vector<double>& reflection, const Visit& visit) const;

  private:
    const SolvedLayers& solved_;
    rte::ScaledStack scaled_, unscaled_;
    std::vector<std::vector<PhasePart>> parts_;
    std::vector<std::size_t> places_;
    std::vector<bool> in_moments_;
    std::size_t part_count_ = 0;
};

template <typename Visit>
void NoisyLayers::for_each_direction(const std::vector<double>& reflection,
                                     const Visit& visit) const {
    const auto& [mu_in, mu_out, azimuths] = solved_.directions;
    const std::size_t block = mu_out.size() * azimuths.size();
    const rte::FirstOrder with_peak(scaled_, true), without_peak(unscaled_, true);
    std::vector<Term> terms;
    std::size_t k = 0;
    for (const double in : mu_in) {
        const auto first = reflection.begin() + static_cast<std::ptrdiff_t>(k);
        const double brightest =
            *std::max_element(first, first + static_cast<std::ptrdiff_t>(block));
        for (const double out : mu_out) {
            const auto as_peak = with_peak.weights(in, out);
            const auto as_scattered = without_peak.weights(in, out);
            for (const double azimuth : azimuths) {
                const double cosine = std::cos(azimuth * (std::numbers::pi / 180.0));
                terms.clear();
                const auto add = [&](std::size_t layer, double cos_theta, double peak,
                                     double scattered) {
                    const Weight weight = in_moments_[layer] ? Weight{scattered, peak - scattered}
                                                             : Weight{peak, 0.0};
                    for (std::size_t p = 0; p < parts_[layer].size(); ++p) {
                        const double factor = parts_[layer][p].factor(cos_theta);
                        terms.push_back({layer, p, cos_theta, factor * weight.value(cos_theta),
                                         factor * weight.doubt(cos_theta)});
                    }
                };
                for (std::size_t i = 0; i < layers(); ++i) {
                    if (parts_[i].empty()) continue;
                    const rte::PhaseWeights& at = as_peak[i];
                    const rte::ScatteringAngles angles(at.mu_in, at.mu_out);
                    add(i, angles.back(cosine), at.back, as_scattered[i].back);
                    if (at.forward > 0.0)
                        add(i, angles.forward(cosine), at.forward, as_scattered[i].forward);
                }
                visit(k++, terms, brightest);
            }
        }
    }
}

/// P of one part of a layer, recomputed at one angle.
struct Point {
    double allowed = std::numeric_limits<double>::infinity();  ///< error, rms
    double change = 0.0;                                       ///< recomputed P - P of the table
    double noise = 0.0;                                        ///< error left, rms
};

/// Points of each part of each layer by angle; angles that differ by rounding are one.
using Points = std::vector<std::vector<std::map<double, Point>>>;

double angle_of(double cos_theta) {
    constexpr double step = 1e-6;  // degrees
    return step * std::round(std::acos(cos_theta) * (180.0 / std::numbers::pi) / step);
}

const Point* find_point(const Points& points, const Term& term) {
    if (points.empty()) return nullptr;
    const std::map<double, Point>& of_part = points[term.layer][term.part];
    const auto found = of_part.find(angle_of(term.cos_theta));
    return found == of_part.end() ? nullptr : &found->second;
}

/// Computes P of a species at its points, with as many sizes as the allowed errors need.
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
        // The number of sizes is bounded: where their noise exceeds that of the table, P stays.
        const double of_table =
            part.table->noise(std::cos(angles_deg[at] * std::numbers::pi / 180.0));
        if (!(point.noise < of_table)) point = {point.allowed, 0.0, of_table};
        ++at;
    }
}

/// The error allowed to a point beside the `doubt` about its forward peak: left^2 = error^2 +
/// doubt^2, where left = allowed / kShareOfPoints is all that is left of the tolerance; between
/// kLeastBesideDoubt x allowed and allowed.
double beside_doubt(double allowed, double doubt) {
    const double left = allowed / kShareOfPoints;
    const double rest = std::sqrt(std::max(left * left - doubt * doubt, 0.0));
    return std::clamp(rest, kLeastBesideDoubt * allowed, allowed);
}

// A NaN counts as the largest, and stays.
void keep_largest(double& largest, double value) {
    if (value > largest || std::isnan(value)) largest = value;
}

PhaseErrors errors_left(const NoisyLayers& layers, const SolvedLayers& solved,
                        const std::vector<double>& reflection, const Points& points) {
    const Directions& directions = solved.directions;
    const std::size_t azimuths = directions.azimuth_deg.size(), outs = directions.mu_out.size();
    PhaseErrors worst{.of_values = std::vector<double>(reflection.size())};
    layers.for_each_direction(
        reflection, [&](std::size_t k, const std::vector<Term>& terms, double brightest) {
            double noise = 0.0;
            for (const Term& term : terms) {
                double own = layers.parts(term.layer)[term.part].table->noise(term.cos_theta);
                double change = 0.0;
                if (const Point* known = find_point(points, term)) {
                    own = known->noise;
                    change = known->change;
                }
                noise = std::hypot(noise, term.value * own, term.doubt * change);
            }
            noise = brightest > 0.0 ? noise / brightest : 0.0;
            worst.of_values[k] = solved.transfer_errors[k] + kDeviations * noise;
            keep_largest(worst.with_transfer, worst.of_values[k]);
            if (!(noise > worst.noise.largest)) return;
            worst.noise = {noise, directions.mu_in[k / azimuths / outs],
                           directions.mu_out[k / azimuths % outs],
                           directions.azimuth_deg[k % azimuths]};
        });
    return worst;
}

PhaseErrors of_transfer_alone(const SolvedLayers& solved) {
    PhaseErrors errors{.of_values = solved.transfer_errors};
    for (const double error : solved.transfer_errors) keep_largest(errors.with_transfer, error);
    return errors;
}

}  // namespace

PhaseErrors phase_errors(const SolvedLayers& solved, const std::vector<double>& reflection) {
    const NoisyLayers layers(solved);
    if (layers.part_count() == 0) return of_transfer_alone(solved);
    return errors_left(layers, solved, reflection, {});
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
    const NoisyLayers layers(solved);
    if (layers.part_count() == 0) return of_transfer_alone(solved);
    Points points(layers.layers());
    for (std::size_t i = 0; i < points.size(); ++i) points[i].resize(layers.parts(i).size());
    layers.for_each_direction(reflection, [&](std::size_t k, const std::vector<Term>& terms,
                                              double brightest) {
        // As an rms, shared by terms whose errors are independent.
        const double largest = allowed[k] * std::max(brightest, 0.0) /
                               (kDeviations * std::sqrt(static_cast<double>(terms.size())));
        for (const Term& term : terms) {
            if (!(term.value > 0.0)) continue;
            const double noise = layers.parts(term.layer)[term.part].table->noise(term.cos_theta);
            if (noise <= largest / term.value) continue;
            // The noise of the table is the expected change of P. Straight back the doubt exceeds
            // the tolerance whatever the number of sizes: it is stated, and points get all.
            const double doubt = is_straight_back(term.cos_theta) ? 0.0 : term.doubt * noise;
            Point& point = points[term.layer][term.part][angle_of(term.cos_theta)];
            point.allowed = std::min(point.allowed, beside_doubt(largest, doubt) / term.value);
        }
    });
    for (std::size_t i = 0; i < points.size(); ++i) {
        // The layers of the stack are the topmost of the scene.
        const ResolvedMedium& medium = scene.media[scene.media.size() - 1 - layers.place(i)];
        for (std::size_t p = 0; p < points[i].size(); ++p) {
            const PhasePart& part = layers.parts(i)[p];
            if (!points[i][p].empty())
                find_points(medium.species[part.species], w, demand, part, run, points[i][p]);
        }
    }
    layers.for_each_direction(reflection,
                              [&](std::size_t k, const std::vector<Term>& terms, double) {
                                  for (const Term& term : terms) {
                                      if (const Point* point = find_point(points, term))
                                          reflection[k] += term.value * point->change;
                                  }
                              });
    return errors_left(layers, solved, reflection, points);
}

}  // namespace miebrdf
