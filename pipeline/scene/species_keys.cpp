#include "pipeline/scene/species_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <miebrdf/error.h>
#include "materials/database/names.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_parts.h"
#include "pipeline/scene/size_words.h"

namespace miebrdf {
namespace {

using Kind = mie::SizeDistributionKind;

constexpr std::array<Unit, 6> kLengthsUm = {
    {{"nm", 1, 1000}, {"um", 1, 1}, {"µm", 1, 1}, {"mm", 1000, 1}, {"cm", 10000, 1}, {"", 1, 1}}};
constexpr std::array<Unit, 4> kShares = {
    {{"%", 1, 100}, {"ppm", 1, 1000000}, {"ppb", 1, 1000000000}, {"", 1, 1}}};
constexpr std::array<Unit, 11> kMassShares = {{{"%", 1, 100},
                                               {"ppm", 1, 1000000},
                                               {"ppb", 1, 1000000000},
                                               {"ng/g", 1, 1000000000},
                                               {"ug/g", 1, 1000000},
                                               {"µg/g", 1, 1000000},
                                               {"mg/g", 1, 1000},
                                               {"ug/kg", 1, 1000000000},
                                               {"mg/kg", 1, 1000000},
                                               {"g/kg", 1, 1000},
                                               {"", 1, 1}}};
constexpr std::array<Unit, 5> kNumbersPerCm3 = {
    {{"/cm3", 1, 1}, {"cm-3", 1, 1}, {"/m3", 1, 1000000}, {"m-3", 1, 1000000}, {"", 1, 1}}};
constexpr std::array<Unit, 4> kDensities = {
    {{"g/cm3", 1, 1}, {"kg/m3", 1, 1000}, {"kg/l", 1, 1}, {"", 1, 1}}};

/// @param what  the medium and the key
Kind parse_kind(const std::string& text, const std::string& what) {
    try {
        return mie::parse_size_distribution(text);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: {}", what.substr(0, what.rfind(':')), error.what()));
    }
}

/// A species on its way in.
struct Words {
    Species& species;
    SizeWords sizes = {};
};

/// A key that follows a species, and what it sets.
struct Key {
    const char* name;
    void (*set)(Words& words, const std::string& value, const std::string& what,
                const std::string& text);
};

template <typename Value>
struct Named {
    const char* name;
    Value value;
};
constexpr Named<GrainShape::Kind> kShapes[] = {
    {"sphere", GrainShape::Kind::sphere},
    {"spheroid", GrainShape::Kind::spheroid},
    {"hexagonal-plate", GrainShape::Kind::hexagonal_plate},
    {"koch", GrainShape::Kind::koch}};
constexpr Named<bool> kMethods[] = {{"corrections", false}, {"t-matrix", true}};
constexpr Named<PhaseForm> kPhases[] = {
    {"mie", PhaseForm::mie},
    {"henyey-greenstein", PhaseForm::henyey_greenstein},
    {"double-henyey-greenstein", PhaseForm::double_henyey_greenstein}};

template <typename Value, std::size_t count>
Value value_of(const Named<Value> (&all)[count], const std::string& name, const std::string& what) {
    std::string known;
    for (const auto& one : all) {
        if (name == one.name) return one.value;
        known += (known.empty() ? "" : ", ") + std::string(one.name);
    }
    throw UsageError(fmt::format("{}: '{}'; allowed: {}", what, name, known));
}

template <typename Value, std::size_t count>
const char* name_in(const Named<Value> (&all)[count], Value value) {
    for (const auto& one : all) {
        if (value == one.value) return one.name;
    }
    return "";
}

/// Sets a member of a member of a species, once.
template <auto read, auto... path>
void once(Words& w, const std::string& value, const std::string& what, const std::string&) {
    auto& place = (w.species.*....*path);
    if (place) throw UsageError(what + " is given twice");
    place = read(value, what);
}

template <const auto& units>
double quantity(const std::string& value, const std::string& what) {
    return parse_quantity(value, what, units);
}

template <const auto& all>
auto one_of(const std::string& value, const std::string& what) {
    return value_of(all, value, what);
}

template <Amount::Kind kind, const auto& units>
void amount(Words& w, const std::string& value, const std::string& what, const std::string& text) {
    if (w.species.amount) {
        throw UsageError(
            fmt::format("medium '{}': more than one amount; give volume, mass or number", text));
    }
    w.species.amount = {kind, parse_quantity(value, what, units)};
}

using Of = Species;
using Sizes = ParticleSizes;
using Shape = GrainShape;

const std::vector<Key> kKeys = {
    {"radius", once<parse_length_um, &Of::sizes, &Sizes::effective_radius_um>},
    {"variance", once<parse_number, &Of::sizes, &Sizes::effective_variance>},
    {"distribution", once<parse_kind, &Of::sizes, &Sizes::distribution>},
    {"density", once<quantity<kDensities>, &Of::density_g_cm3>},
    {"layer-density", once<parse_layer_density, &Of::layer_density_kg_m3>},
    {"volume", amount<Amount::Kind::volume_fraction, kShares>},
    {"mass", amount<Amount::Kind::mass_fraction, kMassShares>},
    {"number", amount<Amount::Kind::number_per_cm3, kNumbersPerCm3>},
    {"shape", [](Words& w, const std::string& value, const std::string& what,
                 const std::string&) { w.species.shape.kind = value_of(kShapes, value, what); }},
    {"aspect", once<parse_number, &Of::shape, &Shape::aspect>},
    {"method",
     [](Words& w, const std::string& value, const std::string& what, const std::string&) {
         w.species.shape.by_t_matrix = value_of(kMethods, value, what);
     }},
    {"asymmetry", once<parse_number, &Of::shape, &Shape::asymmetry>},
    {"absorption", once<parse_number, &Of::shape, &Shape::absorption>},
    {"phase", once<one_of<kPhases>, &Of::phase>},
    {"coating",
     [](Words& w, const std::string& value, const std::string&, const std::string& text) {
         try {  // keys are taken from the end, coatings written from inside out
             w.species.coatings.insert(w.species.coatings.begin(), coating(value));
         } catch (const UsageError& error) {
             throw UsageError(fmt::format("medium '{}': {}", text, error.what()));
         }
     }},
};

std::vector<std::string> key_names() {
    std::vector<std::string> names(std::size(kKeys));
    std::transform(std::begin(kKeys), std::end(kKeys), names.begin(),
                   [](const Key& key) { return key.name; });
    names.insert(names.end(), size_word_names().begin(), size_word_names().end());
    return names;
}

const Key* find_key(const std::string& name) {
    for (const Key& key : kKeys) {
        if (name == key.name) return &key;
    }
    return nullptr;
}

/// The key that was meant, perhaps by the name of its option (`effective-radius`).
std::string nearest_key(const std::string& name) {
    for (const Key& key : kKeys) {
        if (name.find(key.name) != std::string::npos) return key.name;
    }
    const auto nearest = materials::nearest_names(name, key_names(), 1);
    return nearest.empty() ? "" : nearest.front();
}

[[noreturn]] void refuse_key(const std::string& key, const std::string& text) {
    if (key == "pvc" || key == "cpvc") {
        throw UsageError(fmt::format(
            "medium '{}': write the pigment volume concentration as the pigment's share "
            "of the dry film, TiO2,radius=0.13,volume=40% in PMMA; beyond the critical "
            "one (cpvc) the film has pores: ' + index:1,radius=0.1,volume=10%'",
            text));
    }
    const std::string nearest = nearest_key(key);
    throw UsageError(fmt::format(
        "medium '{}': unknown key '{}'; allowed: {}{}", text, key, fmt::join(key_names(), ", "),
        nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

std::string describe(const Amount& amount) {
    switch (amount.kind) {
        case Amount::Kind::volume_fraction:
            return fmt::format(",volume={}", amount.value);
        case Amount::Kind::mass_fraction:
            return fmt::format(",mass={}", amount.value);
        case Amount::Kind::number_per_cm3:
            break;
    }
    return fmt::format(",number={}/cm3", amount.value);
}

void validate(const Coating& coating, const std::string& text) {
    validate(coating.material);
    for (const double size : {coating.thickness_um, coating.share_of_radius}) {
        if (size >= 0.0 && std::isfinite(size)) continue;
        throw UsageError(
            fmt::format("medium '{}': thickness {} of coating {} is out of range; "
                        "allowed: >= 0, finite",
                        text, size, describe(coating.material)));
    }
}

void validate_shape(const Species& species, const std::string& text) {
    const GrainShape& shape = species.shape;
    const auto refuse = [&](const std::string& reason) {
        throw UsageError(fmt::format("medium '{}': {}", text, reason));
    };
    const double aspect = shape.aspect.value_or(1.0), g = shape.asymmetry.value_or(0.0),
                 absorption = shape.absorption.value_or(1.0);
    if (!(aspect >= 0.1 && aspect <= 20.0))
        refuse(fmt::format("aspect {} is out of range; allowed: 0.1 to 20, width over length",
                           aspect));
    if (!(g > -1.0 && g < 1.0))
        refuse(fmt::format("asymmetry {} is out of range; allowed: above -1, below 1", g));
    if (!(absorption >= 0.5 && absorption <= 3.0)) {
        refuse(
            fmt::format("absorption {} is out of range; allowed: 0.5 to 3, B of Libois et al. "
                        "(2013), 1.25 for spheres, 1.6 for snow",
                        absorption));
    }
    if (shape.aspect && shape.kind == GrainShape::Kind::sphere)
        refuse("spheres have no aspect; give a shape, e.g. shape=hexagonal-plate");
    if (shape == GrainShape{}) return;
    if (shape.by_t_matrix) {
        if (shape.kind != GrainShape::Kind::spheroid)
            refuse("method=t-matrix is for shape=spheroid");
        if (shape.asymmetry || shape.absorption ||
            species.phase.value_or(PhaseForm::mie) != PhaseForm::mie)
            refuse(
                "asymmetry=, absorption= and phase= are of corrections; method=t-matrix has its "
                "own");
        if (!species.coatings.empty()) refuse("spheroids by the T-matrix have no coatings");
        return;
    }
    if (species.phase == PhaseForm::mie) {
        refuse(
            "grains that are no spheres have no phase function of Mie theory; allowed: "
            "phase=henyey-greenstein, double-henyey-greenstein");
    }
    if (!species.coatings.empty()) refuse("corrections of shape are for grains without coatings");
}

void validate(const Amount& amount, const std::string& text) {
    const bool is_share = amount.kind != Amount::Kind::number_per_cm3;
    const bool allowed =
        amount.value >= 0.0 && std::isfinite(amount.value) && (!is_share || amount.value <= 1.0);
    if (allowed) return;
    const char* name = amount.kind == Amount::Kind::volume_fraction ? "volume fraction"
                       : amount.kind == Amount::Kind::mass_fraction ? "mass fraction"
                                                                    : "number per cm3";
    throw UsageError(fmt::format("medium '{}': {} {} is out of range; allowed: {}", text, name,
                                 amount.value, is_share ? "0 to 1 (or 100%)" : ">= 0, finite"));
}

/// Writes the words that follow the sizes.
std::string rest_of_keys(const Species& species) {
    std::string text;
    for (const Coating& coating : species.coatings) text += ",coating=" + describe(coating);
    const GrainShape& shape = species.shape;
    if (shape.kind != GrainShape::Kind::sphere)
        text += fmt::format(",shape={}", name_in(kShapes, shape.kind));
    if (shape.aspect) text += fmt::format(",aspect={}", *shape.aspect);
    if (shape.by_t_matrix) text += ",method=t-matrix";
    if (shape.asymmetry) text += fmt::format(",asymmetry={}", *shape.asymmetry);
    if (shape.absorption) text += fmt::format(",absorption={}", *shape.absorption);
    if (species.phase) text += fmt::format(",phase={}", name_in(kPhases, *species.phase));
    if (species.density_g_cm3) text += fmt::format(",density={}", *species.density_g_cm3);
    if (species.layer_density_kg_m3)
        text += fmt::format(",layer-density={}", *species.layer_density_kg_m3);
    if (species.amount) text += describe(*species.amount);
    return text;
}

}  // namespace

Coating coating(const std::string& text) {
    const std::size_t at = text.rfind('@');
    if (at == std::string::npos) {
        throw UsageError(fmt::format(
            "coating '{}' has no thickness; write coating={}@5nm or, as a share of the core's "
            "radius, coating={}@10% (the last @ of a layer is followed by the layer's depth)",
            text, text, text));
    }
    Coating coating{.material = host(trimmed_text(text.substr(0, at)))};
    const std::string size = trimmed_text(text.substr(at + 1));
    const std::string what = fmt::format("thickness of coating '{}'", text);
    // Without a unit nobody knows whether a length or a share is meant.
    constexpr auto lengths = std::span(kLengthsUm).first(kLengthsUm.size() - 1);
    if (size.ends_with('%')) {
        coating.share_of_radius = parse_quantity(size, what, std::span(kShares).first(1));
    } else {
        coating.thickness_um = parse_quantity(size, what, lengths);
    }
    validate(coating, text);
    return coating;
}

std::string describe(const Coating& coating) {
    if (coating.share_of_radius == 0.0)
        return fmt::format("{}@{}um", describe(coating.material), coating.thickness_um);
    // The shortest percentage that is read as this share.
    double percent = 100.0 * coating.share_of_radius;
    const double short_one = parse_number(fmt::format("{:.15g}", percent), "share");
    if (short_one / 100.0 == coating.share_of_radius) percent = short_one;
    return fmt::format("{}@{}%", describe(coating.material), percent);
}

double parse_length_um(std::string_view text, const std::string& what) {
    return parse_quantity(text, what, kLengthsUm);
}

double parse_layer_density(std::string_view text, const std::string& what) {
    constexpr Unit kLayerDensities[] = {{"kg/m3", 1, 1}, {"g/cm3", 1000, 1}, {"", 1, 1}};
    return parse_quantity(text, what, kLayerDensities);
}

mie::SizeDistribution sizes_of(const Species& species, const ParticleOptions& of_scene) {
    const ParticleSizes& own = species.sizes;
    mie::SizeDistribution sizes = of_scene.sizes;
    if (own.effective_radius_um) sizes.effective_radius_um = *own.effective_radius_um;
    if (own.effective_variance) sizes.effective_variance = *own.effective_variance;
    if (own.distribution) {
        sizes.kind = *own.distribution;
        sizes.exponent = own.exponent.value_or(sizes.exponent);
        sizes.radii_um = own.radii_um;
        sizes.number_density = own.number_density;
    }
    return sizes;
}

bool states_radius(const Species& species) {
    const ParticleSizes& sizes = species.sizes;
    return sizes.effective_radius_um || sizes.specific_surface_m2_per_kg ||
           sizes.distribution == Kind::junge || sizes.distribution == Kind::tabulated;
}

void validate_keys(const Species& species, const std::string& text) {
    const auto refuse = [&](const char* key, double value, const char* allowed) {
        throw UsageError(fmt::format("medium '{}': {} {} is out of range; allowed: {}", text, key,
                                     value, allowed));
    };
    const ParticleSizes& sizes = species.sizes;
    const double radius_um = sizes.effective_radius_um.value_or(1.0);
    if (!(radius_um > 0.0 && std::isfinite(radius_um)))
        refuse("radius", radius_um, "finite and > 0, in um");
    const double variance = sizes.effective_variance.value_or(0.2);
    if (!(variance > 0.0 && variance <= 10.0)) refuse("variance", variance, "above 0, up to 10");
    const double surface = sizes.specific_surface_m2_per_kg.value_or(1.0);
    if (!(surface > 0.0 && std::isfinite(surface)))
        refuse("ssa", surface, "finite and > 0, in m2/kg");
    if (sizes.distribution == Kind::tabulated || sizes.distribution == Kind::junge) {
        try {
            mie::radius_range(sizes_of(species, {}));
        } catch (const UsageError& error) {
            throw UsageError(fmt::format("medium '{}': {}", text, error.what()));
        }
    }
    for (const Coating& coating : species.coatings) validate(coating, text);
    validate_shape(species, text);
    const double density = species.density_g_cm3.value_or(1.0);
    if (!(density > 0.0 && density <= 30.0))
        refuse("density", density, "above 0, up to 30, in g/cm3");
    const double of_layer = species.layer_density_kg_m3.value_or(1.0);
    if (!(of_layer > 0.0 && of_layer <= 3e4))
        refuse("layer-density", of_layer, "above 0, up to 30000, in kg/m3");
    if (species.amount) validate(*species.amount, text);
}

std::string describe_keys(const Species& species) {
    const ParticleSizes& sizes = species.sizes;
    std::string text;
    if (sizes.effective_radius_um) text += fmt::format(",radius={}", *sizes.effective_radius_um);
    if (sizes.specific_surface_m2_per_kg)
        text += fmt::format(",ssa={}m2/kg", *sizes.specific_surface_m2_per_kg);
    if (sizes.distribution == Kind::junge && sizes.radii_um.size() == 2)
        return text +
               fmt::format(",junge={},from={},to={}", sizes.exponent.value_or(0.0),
                           sizes.radii_um[0], sizes.radii_um[1]) +
               rest_of_keys(species);
    if (sizes.distribution == Kind::tabulated)
        return text + ",sizes=" + sizes.file + rest_of_keys(species);
    if (sizes.effective_variance) text += fmt::format(",variance={}", *sizes.effective_variance);
    if (sizes.distribution) text += ",distribution=" + name_of(*sizes.distribution);
    return text + rest_of_keys(species);
}

std::string take_keys(const std::string& text, bool only_keys, Species& species) {
    std::string rest = text;
    const std::string table = ",sizes:";  // another way to write sizes=FILE
    if (const std::size_t at = rest.find(table); at != std::string::npos)
        rest.replace(at, table.size(), ",sizes=");
    Words words{species};
    for (;;) {
        // Values may have commas (coating=index:1.5,0.01@5nm), keys have none.
        const std::string outside = blank_in_parentheses(rest);
        const std::size_t equals = outside.rfind('=');
        if (equals == std::string::npos) break;
        const std::size_t comma = outside.rfind(',', equals);
        if (comma == std::string::npos) break;
        const std::string name = trimmed_text(rest.substr(comma + 1, equals - comma - 1));
        const Key* key = find_key(name);
        const std::string value = trimmed_text(rest.substr(equals + 1));
        const auto& sizes = size_word_names();
        if (std::find(sizes.begin(), sizes.end(), name) != sizes.end()) {
            if (!words.sizes.emplace(name, value).second)
                throw UsageError(fmt::format("medium '{}': {} is given twice", text, name));
        } else if (key == nullptr) {
            if (only_keys) refuse_key(name, text);
            break;
        }
        if (key != nullptr)
            key->set(words, value, fmt::format("medium '{}': {}", text, name), text);
        rest = trimmed_text(rest.substr(0, comma));
    }
    set_sizes(words.sizes, species, text);
    return rest;
}

}  // namespace miebrdf
