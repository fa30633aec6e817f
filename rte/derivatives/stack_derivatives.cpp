#include "rte/derivatives/stack_derivatives.h"

#include <algorithm>

#include "rte/derivatives/frozen_stack.h"
#include "rte/stack/hidden_layers.h"
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

}  // namespace

bool is_bounded(const Stack& stack, const StackChange& change) {
    const bool is_half_space = lowest_kind(stack) == BaseKind::half_space;
    if (!is_half_space || stack.base_kind != BaseKind::half_space) return true;
    return stack.base.one_minus_albedo > 0.0 ||
           change.plus.base.one_minus_albedo == change.minus.base.one_minus_albedo;
}

std::vector<ReflectionTable> reflection_derivatives(
    const Stack& asked, std::span<const StackChange> changes, const Directions& directions,
    const SolvedLight& light, const SolverOptions& options, const SolverReport& solved) {
    const auto complete = [&](const Stack& stack) {
        return light.components > 1 ? with_all_moments(stack) : stack;
    };
    const FrozenStack frozen(complete(asked), options, solved);
    const auto at = [&](const Stack& stack) {
        const ScaledStack scaled = frozen.scaled_like(complete(stack));
        return elements_last(
            frozen_reflection(frozen, scaled, frozen.grids_of(scaled), directions, light),
            std::size_t(light.shown() * light.shown()), directions.azimuth_deg.size());
    };
    std::vector<ReflectionTable> tables;
    for (const StackChange& change : changes) {
        ReflectionTable& table = tables.emplace_back();
        table.components = light.shown();
        table.reflection = slope(at(change.plus), at(change.minus), change.apart);
        table.mirror_reflectance = mirror_slope(change, directions.mu_in, light);
    }
    return tables;
}

std::vector<AlbedoTable> albedo_derivatives(const Stack& asked,
                                            std::span<const StackChange> changes,
                                            const AlbedoQuestion& question,
                                            const std::function<SurfaceWeights(double mu)>&,
                                            const SolverOptions& options,
                                            const SolverReport& solved) {
    const auto complete = [&](const Stack& stack) {
        return question.components > 1 ? with_all_moments(stack) : stack;
    };
    const FrozenStack frozen(complete(asked), options, solved);
    const auto at = [&](const Stack& stack,
                        const std::function<SurfaceWeights(double mu)>& surface) {
        const ScaledStack scaled = frozen.scaled_like(complete(stack));
        return frozen_albedo(frozen, scaled, frozen.grids_of(scaled), question, surface);
    };
    std::vector<AlbedoTable> tables;
    for (const StackChange& change : changes) {
        const AlbedoTable plus = at(change.plus, change.surface_plus);
        const AlbedoTable minus = at(change.minus, change.surface_minus);
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
