#include "pipeline/fit/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <miebrdf/error.h>
#include "pipeline/fit/job.h"
#include "pipeline/fit/solved_job.h"
#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/amounts.h"
#include "pipeline/solve/named_index.h"
#include "pipeline/solve/resolver.h"

namespace miebrdf::fitting {
namespace {

constexpr double kExample_nm = 550.0;  // densities and numbers do not depend on it

/// The same words with other numbers.
class Scenes {
  public:
    explicit Scenes(const FitProblem& problem)
        : problem_(problem),
          slots_(slots_of(problem.unknowns, 1)),
          words_(words_of(problem, problem.data.front())) {}

    Scene at(const std::vector<double>& numbers) const {
        Job job;
        job.words = words_;
        return request_of(problem_, slots_, job, numbers, {}).scene;
    }

  private:
    const FitProblem& problem_;
    std::vector<Slot> slots_;
    std::vector<TemplateWord> words_;
};

const Medium& medium_of(const Scene& scene, int layer) {
    return layer < 0 ? scene.base : scene.layers[std::size_t(layer)].medium;
}

double sum_of_thicknesses(const Scene& scene) {
    double sum = 0.0;
    for (const Layer& layer : scene.layers)
        if (layer.depth.kind == Depth::Kind::thickness_um) sum += layer.depth.value;
    return sum;
}

std::string name_of(Species species) {
    species.amount.reset();
    const std::string text = describe(species);
    return species.name.empty() ? text : text.substr(0, text.find(','));
}

}  // namespace

std::vector<std::string> notes_of(const FitProblem& problem, const std::vector<double>& numbers) {
    return resolve(Scenes(problem).at(numbers), {kExample_nm}).notes;
}

Batch::Batch(const FitProblem& problem, const std::vector<double>& numbers) : start_(numbers) {
    const Scenes scenes(problem);
    const Scene scene = scenes.at(numbers);
    has_film_ = !scene.layers.empty() &&
                std::all_of(scene.layers.begin(), scene.layers.end(),
                            [](const Layer& l) { return std::isfinite(l.depth.value); });
    thickness_um_ = sum_of_thicknesses(scene);
    // Amounts are proportional to their numbers: two scenes tell which belongs to which.
    std::vector<double> inside = numbers;
    std::vector<Scene> moved;
    std::vector<double> steps;
    for (std::size_t u = 0; u < problem.unknowns.size(); ++u) {
        const Unknown& unknown = problem.unknowns[u];
        const double step = (numbers[u] - unknown.low > unknown.high - numbers[u] ? -1e-3 : 1e-3) *
                            (unknown.high - unknown.low);
        std::vector<double> at = numbers;
        at[u] += step;
        steps.push_back(step);
        if (inside[u] <= unknown.low) inside[u] = at[u];
        moved.push_back(scenes.at(at));
        thickness_slope_.push_back((sum_of_thicknesses(moved[u]) - thickness_um_) / step);
        for (int l = -1; l < int(scene.layers.size()); ++l) {
            const Medium &a = medium_of(scene, l), &b = medium_of(moved[u], l);
            for (std::size_t s = 0; s < a.species.size(); ++s) {
                if (a.species[s].amount == b.species[s].amount) continue;
                if (layer_ && *layer_ != l)
                    throw UsageError(fmt::format(
                        "amounts of two layers are unknown, of '{}' and '{}'; a recipe is of one "
                        "paint",
                        describe(medium_of(scene, *layer_)), describe(a)));
                layer_ = l;
            }
        }
    }
    if (!layer_) return;
    const Medium& medium = medium_of(scene, *layer_);
    const Scene probe = scenes.at(inside);
    const ResolvedScene resolved = resolve(Scene{.base = medium_of(probe, *layer_),
                                                 .particles = probe.particles,
                                                 .database = probe.database,
                                                 .index = probe.index},
                                           {kExample_nm});
    if (const auto density = layer_density_kg_m3(scene, medium)) layer_density_ = *density / 1e3;
    double sum = 0.0;
    bool has_rest = false;
    std::size_t r = 0;
    for (std::size_t s = 0; s < medium.species.size(); ++s) {
        const Species& species = medium.species[s];
        Component one{.name = name_of(species)};
        const auto& amount = medium_of(probe, *layer_).species[s].amount;
        if (amount && amount->value == 0.0) continue;
        const ResolvedSpecies& known = resolved.media.front().species[r++];
        if (species.amount) {
            one.kind = species.amount->kind;
            one.amount = species.amount->value;
            by_mass_ = by_mass_ && one.kind == Amount::Kind::mass_fraction;
            for (std::size_t u = 0; u < moved.size(); ++u) {
                const double change =
                    medium_of(moved[u], *layer_).species[s].amount->value - one.amount;
                if (change == 0.0) continue;
                one.unknown = u;
                one.slope = change / steps[u];
            }
            if (one.kind == Amount::Kind::number_per_cm3)
                one.volume_per_amount = known.volume_fraction / amount->value;
        }
        has_rest = has_rest || !one.kind;
        sum += one.amount;
        if (known.density_g_cm3) {
            one.density = *known.density_g_cm3;
        } else if (!kind_of(species).fills_layer) {
            throw UsageError(fmt::format(
                "'{}' has no known density, and grams need one; give it in g/cm3: density=2.5",
                one.name));
        }
        components_.push_back(std::move(one));
    }
    constexpr double kWhole = 1.0 - 1e-12;
    has_host_ = by_mass_ ? !has_rest && sum < kWhole : sum < kWhole;
    if (!has_host_) return;
    const Host& host = host_of(scene, medium);
    Component rest{.name = describe(host)};
    if (!host.name.empty())
        if (const auto density = resolve_index({.kind = Species::Kind::material, .name = host.name},
                                               {kExample_nm}, scene.database)
                                     .density_g_cm3)
            rest.density = *density;
    if (host.name.empty() && !layer_density_)
        notes_.push_back(fmt::format(
            "the density of {} is not known: grams and shares of the weight take 1 g/cm3 for it "
            "(layer-density, in kg/m3, is that of the whole paint)",
            rest.name));
    components_.push_back(std::move(rest));
}

double Batch::amount(const Component& component, const std::vector<double>& numbers) const {
    if (!component.unknown) return component.amount;
    const std::size_t u = *component.unknown;
    const double value = component.amount + component.slope * (numbers[u] - start_[u]);
    return value > 1e-12 * component.amount ? value : 0.0;  // of 0 rounding is left
}

Batch::Shares Batch::shares(const std::vector<double>& numbers) const {
    const std::size_t n = components_.size();
    Shares shares{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
    double given = 0.0;
    for (const Component& one : components_) given += amount(one, numbers) * one.volume_per_amount;
    shares.most_amount = given;
    for (std::size_t c = 0; c < n; ++c) {
        const Component& one = components_[c];
        const double share =
            one.kind ? amount(one, numbers) * one.volume_per_amount : std::max(0.0, 1.0 - given);
        const bool is_mass = by_mass_ || one.kind == Amount::Kind::mass_fraction;
        const double density =
            is_mass && !by_mass_ && layer_density_ ? one.density / *layer_density_ : one.density;
        shares.volume[c] = is_mass ? share / density : share;
    }
    const double filled = std::accumulate(shares.volume.begin(), shares.volume.end(), 0.0);
    if (by_mass_ && filled > 0.0)
        for (double& volume : shares.volume) volume /= filled;
    double mass = 0.0;
    for (std::size_t c = 0; c < n; ++c) {
        shares.weight[c] = shares.volume[c] * components_[c].density;
        mass += shares.weight[c];
    }
    if (has_host_ && layer_density_ && !by_mass_) {
        double& host = shares.weight.back();
        mass -= host;
        host = std::max(0.0, *layer_density_ - mass);
        mass += host;
    }
    for (std::size_t c = 0; c < n; ++c) {
        if (mass > 0.0) shares.weight[c] /= mass;
        if (components_[c].unknown) shares.coloured_volume += shares.volume[c];
    }
    return shares;
}

std::vector<double> Batch::numbers_of(const std::vector<double>& weights,
                                      std::vector<double> numbers) const {
    double mass = 0.0, volume = 0.0;
    for (std::size_t c = 0; c < components_.size(); ++c) {
        mass += weights[c];
        volume += weights[c] / components_[c].density;
    }
    if (layer_density_) volume = mass / *layer_density_;
    for (std::size_t c = 0; c < components_.size(); ++c) {
        const Component& one = components_[c];
        if (!one.unknown || one.slope == 0.0) continue;
        const double share = one.kind == Amount::Kind::mass_fraction
                                 ? weights[c] / mass
                                 : weights[c] / one.density / volume / one.volume_per_amount;
        numbers[*one.unknown] = start_[*one.unknown] + (share - one.amount) / one.slope;
    }
    return numbers;
}

double Batch::thickness_um(const std::vector<double>& numbers) const {
    double sum = thickness_um_;
    for (std::size_t u = 0; u < numbers.size(); ++u)
        sum += thickness_slope_[u] * (numbers[u] - start_[u]);
    return sum;
}

}  // namespace miebrdf::fitting
