#include "rte/derivatives/stack_derivatives.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "rte/derivatives/frozen_stack.h"
#include "rte/derivatives/order_tangents.h"
#include "rte/first_order/beams.h"
#include "rte/stack/fourier_sum.h"
#include "rte/stack/layered_reflection.h"

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
    // One side alone has a boundary: where the step of the index begins to count.
    if (plus.size() != minus.size())
        return std::vector<double>(std::max(plus.size(), minus.size()), 0.0);
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

// Hosts of indices so close together have a narrow panel of nodes between them.
constexpr double kCloseIndices = 1.051;
// What such a panel adds to a reflection is within the tolerance with few nodes, and its derivative
// is off by as much as itself: -.17, .15, .047, .062, .063 for .06298 with 16, 24, 32, 48, 64
// nodes, where a film is split in two of one index.
constexpr int kCloseStreams = 64;

bool has_close_indices(const StackGrids& grids) {
    const std::vector<double>& indices = grids.indices();
    return std::adjacent_find(indices.begin(), indices.end(), [](double low, double high) {
               return high < kCloseIndices * low;
           }) != indices.end();
}

/// Derivatives of what closed forms take, where they can be taken.
struct ClosedChanges {
    std::vector<ScaledChange> changes;
    std::vector<char> are_possible;
};

ClosedChanges closed_changes(const FrozenStack& frozen, std::span<const StackChange> changes,
                             const std::vector<ScaledSides>& sides, int components) {
    const ScaledStack& middle = frozen.scaled();
    const std::vector<ScaledMedium>& media = middle.media;
    const bool is_rough = middle.boundary && middle.boundary->is_rough();
    ClosedChanges closed;
    for (std::size_t c = 0; c < changes.size(); ++c) {
        const auto& [plus, minus] = sides[c];
        const double apart = changes[c].apart;
        const bool is_possible = OrderTangents::can_solve(frozen, plus, minus, components);
        closed.are_possible.push_back(char(is_possible));
        if (!is_possible) continue;
        ScaledChange& change = closed.changes.emplace_back();
        change.apart = apart;
        for (std::size_t k = 0; k < media.size(); ++k) {
            const ScaledMedium &a = plus.media[k], &b = minus.media[k];
            change.strengths.push_back((a.scaled.strengths() - b.scaled.strengths()) / apart);
            const bool has_depth = std::isfinite(media[k].scaled_optical_depth);
            change.depths.push_back(
                has_depth ? (a.scaled_optical_depth - b.scaled_optical_depth) / apart : 0.0);
            if (components == 1) continue;
            change.plus.push_back(matrix_strengths(a));
            change.minus.push_back(matrix_strengths(b));
        }
        change.ground_albedo = (plus.ground_albedo - minus.ground_albedo) / apart;
        if (!is_rough || !middle.has_mirrors()) continue;
        change.unscattered =
            frozen.grids()
                .of(middle.top_index)
                .mu.unaryExpr([&, &plus = plus, &minus = minus](double mu) {
                    return (unscattered_return(plus, mu) - unscattered_return(minus, mu)) / apart;
                });
    }
    return closed;
}

/// A stack and both sides of its changes in one discretisation, and what closed forms take of them.
struct FrozenChanges {
    std::vector<StackChange> changes;
    FrozenStack frozen;
    std::vector<ScaledSides> sides;
    ClosedChanges closed;
    /// With the nodes of differences between close indices, and whose they are.
    std::optional<FrozenStack> finer = {};
    std::vector<char> need_finer;

    FrozenChanges(const Stack& stack, std::span<const StackChange> asked, int components,
                  const SolverOptions& options, const SolverReport& solved)
        : changes(completed(asked, components)),
          frozen(completed(stack, components), changes, options, solved),
          sides(sides_of(frozen, changes)),
          closed(closed_changes(frozen, changes, sides, components)),
          need_finer(changes.size(), 0) {
        for (std::size_t c = 0; c < changes.size(); ++c) {
            if (closed.are_possible[c]) continue;
            const auto is_close = [&](const ScaledStack& side) {
                return has_close_indices(frozen.grids_of(side));
            };
            if (!is_close(sides[c].plus) && !is_close(sides[c].minus)) continue;
            if (!finer) {
                SolverReport with_more = solved;
                with_more.streams = std::max(solved.streams, kCloseStreams);
                finer.emplace(completed(stack, components), changes, options, with_more);
            }
            need_finer[c] = 1;
            sides[c] = {finer->scaled_like(changes[c].plus), finer->scaled_like(changes[c].minus)};
        }
    }

    /// What the sides of a change are compared in.
    const FrozenStack& of(std::size_t change) const { return need_finer[change] ? *finer : frozen; }

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

/// Slopes of light scattered more than once, by closed change [pair][element][azimuth]; empty if
/// there is no physical solution.
std::vector<std::vector<double>> multiple_slopes(const FrozenStack& frozen,
                                                 const std::vector<ScaledChange>& changes,
                                                 const Directions& directions,
                                                 const SolvedLight& light) {
    const RequestedDirections requested = collect(directions.mu_in, directions.mu_out);
    const std::size_t azimuths = directions.azimuth_deg.size();
    const int shown = light.shown(), solved = light.components;
    std::vector<std::vector<double>> sums(
        changes.size(), std::vector<double>(directions.mu_in.size() * directions.mu_out.size() *
                                                azimuths * std::size_t(shown * shown),
                                            0.0));
    OrderTangents order(frozen, requested, changes, solved, false);
    const int highest = std::min(frozen.fourier_orders(),
                                 count_of_fourier_orders(requested, order.fourier_orders(), light));
    for (int m = 0; m < highest; ++m) {
        if (m > 0 && shown == 1 && fourier_order_vanishes(m, directions.azimuth_deg)) continue;
        if (!order.solve(m)) return {};
        std::vector<double> cosines, sines;
        for (const double azimuth : directions.azimuth_deg) {
            const double angle = m * azimuth * (std::numbers::pi / 180.0);
            cosines.push_back((m == 0 ? 1.0 : 2.0) * std::cos(angle));
            sines.push_back((m == 0 ? 1.0 : 2.0) * std::sin(angle));
        }
        for (std::size_t c = 0; c < changes.size(); ++c) {
            const Eigen::MatrixXd& multiple = order.tangents()[c].multiple;
            double* sum = sums[c].data();
            for (Eigen::Index i = 0; i < multiple.cols(); i += solved) {
                for (Eigen::Index o = 0; o < multiple.rows(); o += solved) {
                    for (int element = 0; element < shown * shown; ++element) {
                        const int row = element / shown, column = element % shown;
                        const StokesHarmonic harmonic = stokes_harmonic(row, column);
                        const double value = harmonic.sign * multiple(o + row, i + column);
                        const std::vector<double>& waves = harmonic.is_sine ? sines : cosines;
                        for (const double wave : waves) *sum++ += value * wave;
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
    if (!closed.changes.empty())
        multiple = multiple_slopes(frozen, closed.changes, directions, light);
    const auto at = [&](const FrozenStack& own, const ScaledStack& scaled, bool is_closed) {
        if (is_closed) return frozen_first_order(own, scaled, directions, light);
        return frozen_reflection(own, scaled, own.grids_of(scaled), directions, light);
    };
    std::vector<ReflectionTable> tables;
    auto more = multiple.begin();
    for (std::size_t c = 0; c < changes.size(); ++c) {
        ReflectionTable& table = tables.emplace_back();
        table.components = light.shown();
        const bool is_closed = more != multiple.end() && closed.are_possible[c];
        const FrozenStack& own = known.of(c);
        std::vector<double> whole = slope(at(own, sides[c].plus, is_closed),
                                          at(own, sides[c].minus, is_closed), changes[c].apart);
        if (is_closed) {
            for (std::size_t k = 0; k < whole.size(); ++k) whole[k] += (*more)[k];
            ++more;
        }
        table.reflection =
            elements_last(std::move(whole), std::size_t(light.shown() * light.shown()),
                          directions.azimuth_deg.size());
        table.mirror_reflectance = mirror_slope(changes[c], directions.mu_in, light);
    }
    return tables;
}

namespace {

/// Both weights of the surface at the nodes, times what they are of uniform light.
struct LetThrough {
    Eigen::VectorXd in, out;

    LetThrough(const ZenithGrid& grid, const std::function<SurfaceWeights(double mu)>& surface)
        : in(flux_weights(grid)), out(in) {
        for (Eigen::Index q = 0; surface && q < grid.size(); ++q) {
            const SurfaceWeights weights = surface(grid.mu[q]);
            in[q] *= weights.in;
            out[q] *= weights.out;
        }
    }
};

void add_to(AlbedoTable& table, const AlbedoTable& more) {
    const auto add = [](std::vector<double>& list, const std::vector<double>& other) {
        for (std::size_t k = 0; k < list.size(); ++k) list[k] += other[k];
    };
    add(table.plane_albedo, more.plane_albedo);
    add(table.polarised_plane_albedo, more.polarised_plane_albedo);
    add(table.transmittance, more.transmittance);
    table.spherical_albedo += more.spherical_albedo;
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
    const RequestedDirections requested = collect(question.mu_in, {});
    OrderTangents order(frozen, requested, closed.changes, question.components, question.transmits);
    const LetThrough let(frozen.grids().top(), surface);
    const bool is_solved = !closed.changes.empty() && order.solve_albedos(let.in, let.out);
    const auto at = [&](const FrozenStack& own, const ScaledStack& scaled,
                        const std::function<SurfaceWeights(double mu)>& weights) {
        return frozen_albedo(own, scaled, own.grids_of(scaled), question, weights);
    };
    const auto difference = [&](const AlbedoTable& plus, const AlbedoTable& minus, double apart) {
        AlbedoTable table;
        table.plane_albedo = slope(plus.plane_albedo, minus.plane_albedo, apart);
        table.polarised_plane_albedo =
            slope(plus.polarised_plane_albedo, minus.polarised_plane_albedo, apart);
        table.spherical_albedo = (plus.spherical_albedo - minus.spherical_albedo) / apart;
        table.transmittance = slope(plus.transmittance, minus.transmittance, apart);
        return table;
    };
    std::vector<AlbedoTable> tables;
    auto tangent = order.tangents().begin();
    for (std::size_t c = 0; c < changes.size(); ++c) {
        const StackChange& change = changes[c];
        AlbedoTable& table = tables.emplace_back();
        if (!is_solved || !closed.are_possible[c]) {
            const auto of = [&](const std::function<SurfaceWeights(double mu)>& changed)
                -> const std::function<SurfaceWeights(double mu)>& {
                return changed ? changed : surface;
            };
            const FrozenStack& own = known.of(c);
            table = difference(at(own, sides[c].plus, of(change.surface_plus)),
                               at(own, sides[c].minus, of(change.surface_minus)), change.apart);
        } else {
            table.plane_albedo = tangent->plane_albedo;
            table.polarised_plane_albedo = tangent->polarised_plane_albedo;
            table.spherical_albedo = tangent->spherical_albedo;
            table.transmittance = tangent->transmittance;
            ++tangent;
            // Another surface sees the same layers.
            if (change.surface_plus) {
                add_to(table,
                       difference(at(frozen, frozen.scaled(), change.surface_plus),
                                  at(frozen, frozen.scaled(), change.surface_minus), change.apart));
            }
        }
        table.mirror_reflectance =
            mirror_slope(change, question.mu_in, {question.components, true});
        ScaledStack exact;
        AlbedoTable below;
        find_unscattered(change.plus, question.mu_in, question.components, exact,
                         table.unscattered_transmittance);
        find_unscattered(change.minus, question.mu_in, question.components, exact,
                         below.unscattered_transmittance);
        table.unscattered_transmittance =
            slope(table.unscattered_transmittance, below.unscattered_transmittance, change.apart);
    }
    return tables;
}

}  // namespace miebrdf::rte
