#include "pipeline/scene/species_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <vector>

#include <miebrdf/error.h>
#include "materials/database/names.h"
#include "pipeline/scene/number_list.h"

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

Kind parse_kind(const std::string& text, const std::string& species) {
    try {
        return mie::parse_size_distribution(text);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("medium '{}': {}", species, error.what()));
    }
}

/// Sets what is not set yet.
template <typename Value>
void set_once(std::optional<Value>& place, const Value& value, const std::string& key,
              const std::string& species) {
    if (place) throw UsageError(fmt::format("medium '{}': {} is given twice", species, key));
    place = value;
}

void set_amount(Species& species, Amount amount, const std::string& text) {
    if (species.amount) {
        throw UsageError(
            fmt::format("medium '{}': more than one amount; give volume, mass or number", text));
    }
    species.amount = amount;
}

/// A log-normal law as laboratories give it: the median radius by one measure of particles, and the
/// geometric standard deviation.
struct LogNormalWords {
    std::optional<double> median_um, sigma_g;
    std::optional<std::string> by;
};

/// A species on its way in.
struct Words {
    Species& species;
    LogNormalWords log_normal = {};
};

/// A key that follows a species, and what it sets.
struct Key {
    const char* name;
    void (*set)(Words& words, const std::string& value, const std::string& what,
                const std::string& text);
};

const std::vector<Key> kKeys = {
    {"radius",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_once(w.species.sizes.effective_radius_um, parse_length_um(value, what), "radius",
                  text);
     }},
    {"variance",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_once(w.species.sizes.effective_variance, parse_number(value, what), "variance", text);
     }},
    {"distribution",
     [](Words& w, const std::string& value, const std::string&, const std::string& text) {
         set_once(w.species.sizes.distribution, parse_kind(value, text), "distribution", text);
     }},
    {"density",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_once(w.species.density_g_cm3, parse_quantity(value, what, kDensities), "density",
                  text);
     }},
    {"volume",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_amount(w.species,
                    {Amount::Kind::volume_fraction, parse_quantity(value, what, kShares)}, text);
     }},
    {"mass",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_amount(w.species,
                    {Amount::Kind::mass_fraction, parse_quantity(value, what, kMassShares)}, text);
     }},
    {"number",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_amount(w.species,
                    {Amount::Kind::number_per_cm3, parse_quantity(value, what, kNumbersPerCm3)},
                    text);
     }},
    {"median",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_once(w.log_normal.median_um, parse_length_um(value, what), "median", text);
     }},
    {"sigma_g",
     [](Words& w, const std::string& value, const std::string& what, const std::string& text) {
         set_once(w.log_normal.sigma_g, parse_number(value, what), "sigma_g", text);
     }},
    {"by", [](Words& w, const std::string& value, const std::string&,
              const std::string& text) { set_once(w.log_normal.by, value, "by", text); }},
};

std::vector<std::string> key_names() {
    std::vector<std::string> names;
    for (const Key& key : kKeys) names.emplace_back(key.name);
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

/// Effective radius and variance of a log-normal law. With s = ln sigma_g and the median r by
/// number, the mean of r^3 over the mean of r^2 is r exp(5/2 s^2), the variance exp(s^2) - 1
/// (Hansen & Travis 1974, eq. 2.60); medians by area and by volume are r exp(2 s^2), r exp(3 s^2)
/// (Hatch & Choate, J. Franklin Inst. 207, 369 (1929)).
void set_log_normal(const LogNormalWords& words, Species& species, const std::string& text) {
    if (!words.median_um && !words.sigma_g && !words.by) return;
    const auto refuse = [&](const std::string& reason) {
        throw UsageError(
            fmt::format("medium '{}': {}; write median=0.1,sigma_g=1.6 (by=volume where "
                        "the median is not that of numbers)",
                        text, reason));
    };
    if (!words.median_um || !words.sigma_g) refuse("median and sigma_g belong together");
    ParticleSizes& sizes = species.sizes;
    if (sizes.effective_radius_um || sizes.effective_variance ||
        (sizes.distribution && *sizes.distribution != Kind::log_normal))
        refuse("median and sigma_g say radius, variance and distribution");
    const double sigma_g = *words.sigma_g;
    constexpr double kLargestSigma = 4.5;  // a variance of 9.6
    if (!(sigma_g > 1.0 && sigma_g <= kLargestSigma))
        refuse(fmt::format("sigma_g {}; allowed: above 1, up to {}", sigma_g, kLargestSigma));
    const std::string by = words.by.value_or("number");
    const bool is_volume = by == "volume" || by == "mass";
    if (by != "number" && by != "area" && !is_volume)
        refuse(fmt::format("by '{}'; allowed: number, area, volume, mass", by));
    const double s2 = std::pow(std::log(sigma_g), 2);
    const double power = is_volume ? -0.5 : by == "area" ? 0.5 : 2.5;
    sizes.effective_radius_um = *words.median_um * std::exp(power * s2);
    sizes.effective_variance = std::expm1(s2);
    sizes.distribution = Kind::log_normal;
}

}  // namespace

double parse_length_um(std::string_view text, const std::string& what) {
    return parse_quantity(text, what, kLengthsUm);
}

mie::SizeDistribution sizes_of(const Species& species, const ParticleOptions& of_scene) {
    const ParticleSizes& own = species.sizes;
    mie::SizeDistribution sizes = of_scene.sizes;
    if (own.effective_radius_um) sizes.effective_radius_um = *own.effective_radius_um;
    if (own.effective_variance) sizes.effective_variance = *own.effective_variance;
    if (own.distribution) {
        sizes.kind = *own.distribution;
        sizes.radii_um.clear();
        sizes.number_density.clear();
    }
    return sizes;
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
    if (sizes.distribution == Kind::tabulated) {
        throw UsageError(fmt::format(
            "medium '{}': a table of sizes belongs to the scene, not to a layer", text));
    }
    const double density = species.density_g_cm3.value_or(1.0);
    if (!(density > 0.0 && density <= 30.0))
        refuse("density", density, "above 0, up to 30, in g/cm3");
    if (species.amount) validate(*species.amount, text);
}

std::string describe_keys(const Species& species) {
    const ParticleSizes& sizes = species.sizes;
    std::string text;
    if (sizes.effective_radius_um) text += fmt::format(",radius={}", *sizes.effective_radius_um);
    if (sizes.effective_variance) text += fmt::format(",variance={}", *sizes.effective_variance);
    if (sizes.distribution) text += ",distribution=" + name_of(*sizes.distribution);
    if (species.density_g_cm3) text += fmt::format(",density={}", *species.density_g_cm3);
    if (species.amount) text += describe(*species.amount);
    return text;
}

std::string take_keys(const std::string& text, bool only_keys, Species& species) {
    std::string rest = text;
    Words words{species};
    for (;;) {
        const std::string outside = blank_in_parentheses(rest);
        const std::size_t comma = outside.rfind(',');
        if (comma == std::string::npos) break;
        const std::size_t equals = outside.find('=', comma);
        if (equals == std::string::npos) break;
        const std::string name = trimmed_text(rest.substr(comma + 1, equals - comma - 1));
        const Key* key = find_key(name);
        if (key == nullptr) {
            if (only_keys) refuse_key(name, text);
            break;
        }
        key->set(words, trimmed_text(rest.substr(equals + 1)),
                 fmt::format("medium '{}': {}", text, name), text);
        rest = trimmed_text(rest.substr(0, comma));
    }
    set_log_normal(words.log_normal, species, text);
    return rest;
}

}  // namespace miebrdf
