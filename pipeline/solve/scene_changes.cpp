// SceneChange: the two sides of a difference.
#include "pipeline/solve/layer_derivatives.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "pipeline/solve/named_index.h"
#include "pipeline/solve/optics_memo.h"

namespace miebrdf {
namespace {

// (Change of a number) / (the number). Optics are differenced, by explicit formulas and sums with
// fixed nodes: the relative error is 1e-10 by the second order (1e-7 where optics vary within a
// hundredth of the number) and 1e-11 by rounding.
constexpr double kStep = 1e-5;
// At the end of its range a number is changed to one side alone, with an error of first order. A
// number that is 0 (an albedo, a share, g or k) is changed by this itself.
constexpr double kOneSidedStep = 1e-7;
// Where indices of hosts change, whole solutions are differenced, which have fewer digits. At the
// index of air there is one side alone, and indices closer than 1e-7 have no boundary.
constexpr double kIndexStep = 3e-5, kOneSidedIndexStep = 1e-5;

/// The scene that `make` makes of a number; empty where it is out of range.
template <typename Make>
std::optional<ResolvedScene> possible(const Make& make, double value) {
    try {
        return make(value);
    } catch (const UsageError&) {
        return std::nullopt;
    }
}

/// Shares of a number.
struct Steps {
    double both_sides = kStep, one_sided = kOneSidedStep;
};

/// The scene with the number on both sides, or on one where the other is not allowed.
/// @param make  the scene of a value; throws UsageError for values out of range
template <typename Make>
SceneChange around(const std::string& parameter, double value, std::size_t wavelengths,
                   const Make& make, Steps steps = {}) {
    const double scale = std::abs(value);
    double up = scale > 0.0 ? steps.both_sides * scale : kOneSidedStep, down = up;
    auto plus = possible(make, value + up), minus = possible(make, value - down);
    if (!plus && !minus) {
        throw UsageError(
            fmt::format("derivative by '{}' at {:g}: neither a little more nor a little less is "
                        "allowed; it is a choice, and none of these values has a derivative",
                        parameter, value));
    }
    const double one_sided = scale > 0.0 ? steps.one_sided * scale : kOneSidedStep;
    if (!plus) {
        up = 0.0;
        minus = make(value - (down = one_sided));
        plus = make(value);
    } else if (!minus) {
        down = 0.0;
        plus = make(value + (up = one_sided));
        minus = make(value);
    }
    // As the numbers are rounded.
    const double apart = (value + up) - (value - down);
    return {parameter, std::move(*plus), std::move(*minus),
            std::vector<double>(wavelengths, apart)};
}

/// Whether boundaries see other indices.
bool moves_hosts(const ResolvedScene& scene, const SceneChange& change) {
    if (!scene.boundary) return false;
    const auto indices = [](const ResolvedScene& side) {
        std::vector<std::vector<double>> all{side.scene_host_index};
        for (const ResolvedMedium& medium : side.media) all.push_back(medium.host_index);
        return all;
    };
    return indices(change.plus) != indices(scene) || indices(change.minus) != indices(scene);
}

/// Names of materials and hosts of a scene.
std::set<std::string> materials_of(const Scene& scene) {
    std::set<std::string> names;
    const auto add_host = [&](const Host& host) {
        if (!host.name.empty()) names.insert(host.name);
    };
    const auto add = [&](const Medium& medium) {
        for (const Species& species : medium.species) {
            if (species.kind == Species::Kind::material) names.insert(species.name);
        }
        if (medium.host) add_host(*medium.host);
    };
    if (!scene.substrate) add(scene.base);
    for (const Layer& layer : scene.layers) add(layer.medium);
    if (scene.substrate) add_host(scene.substrate->mirror);
    add_host(scene.particles.host);
    return names;
}

/// `n(NAME)`, `k(NAME)`.
struct IndexParameter {
    bool is_k;
    std::string material;
};
std::optional<IndexParameter> index_parameter(const std::string& text) {
    if (text.size() < 3 || text[1] != '(' || text.back() != ')') return std::nullopt;
    if (text[0] != 'n' && text[0] != 'k') return std::nullopt;
    return IndexParameter{text[0] == 'k', text.substr(2, text.size() - 3)};
}

SceneChange change_of_index(const BrdfState& state, const std::string& parameter,
                            const IndexParameter& index) {
    const std::set<std::string> names = materials_of(state.scene);
    if (names.count(index.material) == 0) {
        throw UsageError(fmt::format(
            "derivative by '{}': the scene has no material or host '{}'; it has {}", parameter,
            index.material,
            names.empty() ? "none by name" : fmt::format("{}", fmt::join(names, ", "))));
    }
    const std::vector<double>& nm = state.resolved.wavelength_nm;
    NamedIndexMemo& memo = state.control.memo->names();
    const auto shifted = [&](IndexShift shift) {
        shift.name = index.material;
        return resolve(state.scene, nm, &memo, &shift);
    };
    SceneChange change{parameter, {}, {}, {}};
    if (!index.is_k) {
        const auto by = [&](double step) {
            change.plus = shifted({{}, step, 0.0, 0.0});
            change.minus = shifted({{}, -step, 0.0, 0.0});
            change.apart.assign(nm.size(), 2.0 * step);
        };
        by(kStep);
        if (moves_hosts(state.resolved, change)) by(kIndexStep);
        return change;
    }
    // k spans decades over a spectrum: by a share of itself, and upwards from 0.
    change.plus = shifted({{}, 0.0, kStep, kOneSidedStep});
    change.minus = shifted({{}, 0.0, -kStep, 0.0});
    Materials materials(state.scene.database, state.scene.index, &memo);
    const Species material{.kind = Species::Kind::material, .name = index.material};
    const ResolvedIndex known =
        resolve_index(material, nm, state.scene.particles.k_floor, materials);
    for (const std::complex<double> at : known.index)
        change.apart.push_back(at.imag() > 0.0 ? 2.0 * kStep * at.imag() : kOneSidedStep);
    return change;
}

}  // namespace

SceneChange change_of(const BrdfState& state, const std::string& parameter) {
    if (const auto index = index_parameter(parameter))
        return change_of_index(state, parameter, *index);
    const std::vector<NamedNumber> numbers = named_numbers(state.scene);
    const auto found = std::find_if(numbers.begin(), numbers.end(),
                                    [&](const NamedNumber& one) { return one.name == parameter; });
    if (found == numbers.end()) with_values(state.scene, {{parameter, 0.0}});  // which refuses it
    const auto make = [&](double value) {
        const Scene scene = with_values(state.scene, {{parameter, value}});
        validate(scene);
        return resolve(scene, state.resolved.wavelength_nm, &state.control.memo->names());
    };
    const std::size_t wavelengths = state.resolved.wavelength_nm.size();
    SceneChange change = around(parameter, found->value, wavelengths, make);
    if (moves_hosts(state.resolved, change))
        change =
            around(parameter, found->value, wavelengths, make, {kIndexStep, kOneSidedIndexStep});
    // A layer of depth 0 and a surface without roughness are left out, and come with the change.
    const auto is_alike = [&](const ResolvedScene& changed) {
        return changed.media.size() == state.resolved.media.size() &&
               changed.surface.has_value() == state.resolved.surface.has_value();
    };
    if (is_alike(change.plus) && is_alike(change.minus)) return change;
    throw UsageError(
        fmt::format("derivative by '{}' at {:g}: what it belongs to is not there; allowed: numbers "
                    "above 0 (1e-6 "
                    "is as good as none)",
                    parameter, found->value));
}

}  // namespace miebrdf
