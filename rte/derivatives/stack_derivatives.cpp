#include "rte/derivatives/stack_derivatives.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "rte/derivatives/frozen_stack.h"
#include "rte/derivatives/order_tangents.h"
#include "rte/stack/requests.h"

namespace miebrdf::rte {
namespace {

std::vector<double> slope(const std::vector<double>& plus, const std::vector<double>& minus,
                          double apart) {
    std::vector<double> result(plus.size());
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = (plus[k] - minus[k]) / apart;
    return result;
}

std::vector<double> mirror_slope(const StackChange& change, const std::vector<double>& mu_in,
                                 const SolvedLight& light) {
    ScaledStack exact;
    std::vector<double> plus, minus;
    find_mirror_reflectances(change.plus, mu_in, light, exact, plus);
    find_mirror_reflectances(change.minus, mu_in, light, exact, minus);
    return slope(plus, minus, change.apart);
}

/// A change as the discrete equations see both of its sides.
struct ScaledSides {
    ScaledStack plus, minus;
};

std::vector<ScaledSides> sides_of(const FrozenStack& frozen, std::span<const StackChange> changes) {
    std::vector<ScaledSides> sides;
    for (const StackChange& change : changes)
        sides.push_back({frozen.scaled_like(change.plus), frozen.scaled_like(change.minus)});
    return sides;
}

/// Derivatives of what closed forms take; where they cannot be taken, zeros.
struct ClosedChanges {
    std::vector<ScaledChange> changes;
    std::vector<char> are_possible;

    bool any() const {
        return std::find(are_possible.begin(), are_possible.end(), char(true)) !=
               are_possible.end();
    }
};

ClosedChanges closed_changes(const FrozenStack& frozen, std::span<const StackChange> changes,
                             const std::vector<ScaledSides>& sides) {
    const std::vector<ScaledMedium>& media = frozen.scaled().media;
    ClosedChanges closed;
    for (std::size_t c = 0; c < changes.size(); ++c) {
        const auto& [plus, minus] = sides[c];
        const double apart = changes[c].apart;
        const bool is_possible = OrderTangents::can_solve(frozen, plus, minus);
        closed.are_possible.push_back(char(is_possible));
        ScaledChange& change = closed.changes.emplace_back();
        change.depths.assign(media.size(), 0.0);
        for (std::size_t k = 0; k < media.size(); ++k) {
            Eigen::VectorXd& strengths = change.strengths.emplace_back();
            strengths.setZero(media[k].scaled.chi.size());
            if (!is_possible) continue;
            const ScaledMedium &a = plus.media[k], &b = minus.media[k];
            strengths = (a.scaled.strengths() - b.scaled.strengths()) / apart;
            if (std::isfinite(media[k].scaled_optical_depth))
                change.depths[k] = (a.scaled_optical_depth - b.scaled_optical_depth) / apart;
        }
        if (is_possible) change.ground_albedo = (plus.ground_albedo - minus.ground_albedo) / apart;
    }
    return closed;
}

/// A stack and both sides of its changes in one discretisation, and what closed forms take of them.
struct FrozenChanges {
    std::vector<StackChange> changes;
    FrozenStack frozen;
    std::vector<ScaledSides> sides;
    ClosedChanges closed;

    FrozenChanges(const Stack& stack, std::span<const StackChange> asked, int components,
                  const SolverOptions& options, const SolverReport& solved)
        : changes(completed(asked, components)),
          frozen(completed(stack, components), changes, options, solved),
          sides(sides_of(frozen, changes)),
          closed(closed_changes(frozen, changes, sides)) {}

  private:
    static Stack completed(const Stack& stack, int components) {
        return components > 1 ? with_all_moments(stack) : stack;
    }
    static std::vector<StackChange> completed(std::span<const StackChange> asked, int components) {
        std::vector<StackChange> changes(asked.begin(), asked.end());
        for (StackChange& change : changes) {
            change.plus = completed(change.plus, components);
            change.minus = completed(change.minus, components);
        }
        return changes;
    }
};

/// Slopes of light scattered more than once, [change][(in * outs + out) * azimuths + azimuth];
/// empty if there is no physical solution.
std::vector<std::vector<double>> multiple_slopes(const FrozenStack& frozen,
                                                 const std::vector<ScaledChange>& changes,
                                                 const Directions& directions) {
    const RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    const std::size_t azimuths = directions.azimuth_deg.size(), outs = directions.mu_out.size();
    std::vector<std::vector<double>> sums(
        changes.size(), std::vector<double>(directions.mu_in.size() * outs * azimuths, 0.0));
    OrderTangents order(frozen, requested, changes, false);
    const int orders = only_fourier_order_zero(requested) ? 1 : frozen.fourier_orders();
    for (int m = 0; m < std::min(orders, frozen.scaled().moments); ++m) {
        if (m > 0 && fourier_order_vanishes(m, directions.azimuth_deg)) continue;
        if (!order.solve(m)) return {};
        for (std::size_t c = 0; c < changes.size(); ++c) {
            const ReflectorTangent& tangent = order.tangents()[c];
            if (tangent.is_zero()) continue;
            for (std::size_t a = 0; a < azimuths; ++a) {
                const double wave = (m == 0 ? 1.0 : 2.0) * std::cos(m * directions.azimuth_deg[a] *
                                                                    (std::numbers::pi / 180.0));
                for (std::size_t i = 0; i < directions.mu_in.size(); ++i) {
                    for (std::size_t o = 0; o < outs; ++o) {
                        sums[c][(i * outs + o) * azimuths + a] +=
                            wave * tangent.multiple(Eigen::Index(o), Eigen::Index(i));
                    }
                }
            }
        }
    }
    return sums;
}

}  // namespace

bool is_bounded(const Stack& stack, const StackChange& change) {
    const bool is_half_space = lowest_kind(stack) == BaseKind::half_space;
    if (!is_half_space || stack.base_kind != BaseKind::half_space) return true;
    return stack.base.one_minus_albedo > 0.0 ||
           change.plus.base.one_minus_albedo == change.minus.base.one_minus_albedo;
}

std::vector<ReflectionTable> reflection_derivatives(
    const Stack& asked, std::span<const StackChange> asked_changes, const Directions& directions,
    const SolvedLight& light, const SolverOptions& options, const SolverReport& solved) {
    const FrozenChanges known(asked, asked_changes, light.components, options, solved);
    const std::vector<StackChange>& changes = known.changes;
    const FrozenStack& frozen = known.frozen;
    const std::vector<ScaledSides>& sides = known.sides;
    const ClosedChanges& closed = known.closed;
    std::vector<std::vector<double>> multiple;
    if (light.components == 1 && closed.any())
        multiple = multiple_slopes(frozen, closed.changes, directions);
    const auto is_closed = [&](std::size_t c) {
        return !multiple.empty() && closed.are_possible[c];
    };
    const auto at = [&](const ScaledStack& scaled, std::size_t c) {
        std::vector<double> values;
        if (is_closed(c)) {
            values = frozen_first_order(frozen, scaled, directions);
        } else {
            values = frozen_reflection(frozen, scaled, frozen.grids_of(scaled), directions, light);
        }
        return elements_last(std::move(values), std::size_t(light.shown() * light.shown()),
                             directions.azimuth_deg.size());
    };
    std::vector<ReflectionTable> tables;
    for (std::size_t c = 0; c < changes.size(); ++c) {
        ReflectionTable& table = tables.emplace_back();
        table.components = light.shown();
        table.reflection = slope(at(sides[c].plus, c), at(sides[c].minus, c), changes[c].apart);
        for (std::size_t k = 0; is_closed(c) && k < table.reflection.size(); ++k)
            table.reflection[k] += multiple[c][k];
        table.mirror_reflectance = mirror_slope(changes[c], directions.mu_in, light);
    }
    return tables;
}

namespace {

/// With the weights of the surface as they are.
std::vector<AlbedoTable> albedo_slopes(const FrozenStack& frozen,
                                       const std::vector<ScaledChange>& changes,
                                       const AlbedoQuestion& question) {
    const RequestedDirections requested = collect(question.mu_in, {});
    OrderTangents order(frozen, requested, changes, question.transmits);
    std::vector<AlbedoTable> tables;
    if (!order.solve(0)) return tables;
    const Eigen::VectorXd D = flux_weights(frozen.grids().top());
    const double ground = frozen.scaled().ground_albedo;
    for (std::size_t c = 0; c < changes.size(); ++c) {
        AlbedoTable& table = tables.emplace_back();
        const ReflectorTangent& tangent = order.tangents()[c];
        const std::size_t count = question.mu_in.size();
        table.plane_albedo.assign(count, 0.0);
        if (question.transmits) table.transmittance.assign(count + 1, 0.0);
        if (tangent.is_zero()) continue;
        const Eigen::VectorXd plane = tangent.rows * D;
        for (std::size_t i = 0; i < count; ++i) table.plane_albedo[i] = plane[requested.in[i]];
        table.spherical_albedo = D.dot(tangent.nodes * D) / D.squaredNorm();
        if (!question.transmits) continue;
        const Reflector& whole = order.reflector();
        const double absorbed = 1.0 - ground, less = changes[c].ground_albedo;
        const auto of = [&](double slope, double value) { return absorbed * slope - less * value; };
        const bool has_slope = tangent.transmittance_at_nodes.size() > 0;
        for (std::size_t i = 0; i < count; ++i) {
            const int in = requested.in[i];
            table.transmittance[i] = of(has_slope ? tangent.transmittance_at_requested[in] : 0.0,
                                        whole.transmittance_at_requested[in]);
        }
        table.transmittance.back() = of(has_slope ? D.dot(tangent.transmittance_at_nodes) : 0.0,
                                        D.dot(whole.transmittance_at_nodes)) /
                                     D.squaredNorm();
    }
    return tables;
}

}  // namespace

std::vector<AlbedoTable> albedo_derivatives(const Stack& asked,
                                            std::span<const StackChange> asked_changes,
                                            const AlbedoQuestion& question,
                                            const std::function<SurfaceWeights(double mu)>& surface,
                                            const SolverOptions& options,
                                            const SolverReport& solved) {
    const FrozenChanges known(asked, asked_changes, question.components, options, solved);
    const std::vector<StackChange>& changes = known.changes;
    const FrozenStack& frozen = known.frozen;
    const std::vector<ScaledSides>& sides = known.sides;
    const ClosedChanges& closed = known.closed;
    std::vector<AlbedoTable> closed_tables;
    if (question.components == 1 && !surface && closed.any())
        closed_tables = albedo_slopes(frozen, closed.changes, question);
    std::vector<AlbedoTable> tables;
    for (std::size_t c = 0; c < changes.size(); ++c) {
        if (!closed_tables.empty() && closed.are_possible[c]) {
            tables.push_back(std::move(closed_tables[c]));
            continue;
        }
        const StackChange& change = changes[c];
        const auto at = [&](const ScaledStack& scaled,
                            const std::function<SurfaceWeights(double mu)>& weights) {
            return frozen_albedo(frozen, scaled, frozen.grids_of(scaled), question, weights);
        };
        const AlbedoTable plus = at(sides[c].plus, change.surface_plus);
        const AlbedoTable minus = at(sides[c].minus, change.surface_minus);
        AlbedoTable& table = tables.emplace_back();
        table.plane_albedo = slope(plus.plane_albedo, minus.plane_albedo, change.apart);
        table.polarised_plane_albedo =
            slope(plus.polarised_plane_albedo, minus.polarised_plane_albedo, change.apart);
        table.spherical_albedo = (plus.spherical_albedo - minus.spherical_albedo) / change.apart;
        table.transmittance = slope(plus.transmittance, minus.transmittance, change.apart);
        table.mirror_reflectance =
            mirror_slope(change, question.mu_in, {question.components, true});
    }
    return tables;
}

}  // namespace miebrdf::rte
