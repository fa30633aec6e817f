// Media and layers from words, and back.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_parts.h"
#include "pipeline/scene/species_keys.h"

namespace miebrdf {
namespace {

/// The kind that a text begins with; a text without a known one names a material.
const MediumKind& kind_of_text(const std::string& text) {
    const std::size_t colon = text.find(':');
    if (colon != std::string::npos) {
        for (const MediumKind& kind : medium_kinds()) {
            if (kind.name == text.substr(0, colon) && kind.kind != Species::Kind::material &&
                !kind.form.empty())
                return kind;
        }
    }
    return medium_kinds().front();
}

void require_ranges(const std::string& text, const MediumKind& kind,
                    const std::vector<double>& parameters) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
        const MediumParameter& parameter = kind.parameters[i];
        if (parameter.is_allowed(parameters[i])) continue;
        throw UsageError(fmt::format("medium '{}': {} {} is out of range; allowed: {}", text,
                                     parameter.name, parameters[i], parameter.allowed));
    }
}

/// Sizes and amounts belong to spheres.
void require_particles(const std::string& text, const MediumKind& kind, const Species& species) {
    if (!kind.given) return;
    const std::string keys = describe_keys(kind.without_own_keys(species));
    if (keys.empty()) return;
    if (!kind.own_keys.empty())
        throw UsageError(fmt::format("medium '{}': leave '{}' out; {}", text, keys, kind.own_keys));
    throw UsageError(
        fmt::format("medium '{}': {}: media have no particles, leave '{}' out; sizes and amounts "
                    "belong to media that go through Mie theory: materials, source:KEY, index:N,K",
                    text, kind.name, keys));
}

/// Takes `key=number` of a parameter off the end; 0 where it is not there.
double take_parameter(const MediumParameter& parameter, const std::string& text,
                      std::vector<std::string>& parts) {
    const std::string prefix = std::string(parameter.key) + "=";
    if (parts.empty() || !parts.back().starts_with(prefix)) return 0.0;
    const double value = parse_number(parts.back().substr(prefix.size()),
                                      fmt::format("medium '{}': {}", text, parameter.key));
    parts.pop_back();
    return value;
}

/// The numbers after the colon, one for each parameter of the kind.
std::vector<double> read_parameters(const std::string& text, const std::string& values,
                                    const MediumKind& kind) {
    std::vector<std::string> parts =
        kind.kind == Species::Kind::index ? split_index(values) : split_list(values);
    std::vector<double> by_key;  // those stand last
    for (const MediumParameter& parameter : kind.parameters) {
        if (parameter.key != nullptr) by_key.push_back(take_parameter(parameter, text, parts));
    }
    const std::size_t in_order = kind.parameters.size() - by_key.size();
    std::vector<double> parameters;
    for (const std::string& part : parts) {
        if (part.find('=') != std::string::npos) {
            throw UsageError(
                fmt::format("medium '{}': write {}, e.g. {}", text, kind.form, kind.example));
        }
        parameters.push_back(parse_number(part, fmt::format("medium '{}'", text)));
    }
    while (parameters.size() < in_order && kind.parameters[parameters.size()].by_default)
        parameters.push_back(*kind.parameters[parameters.size()].by_default);
    if (parameters.size() != in_order) {
        throw UsageError(
            fmt::format("medium '{}': write {}, e.g. {}", text, kind.form, kind.example));
    }
    parameters.insert(parameters.end(), by_key.begin(), by_key.end());
    require_ranges(text, kind, parameters);
    while (parameters.size() > in_order && parameters.back() == 0.0) parameters.pop_back();
    return parameters;
}

std::size_t least_parameters(const MediumKind& kind) {
    return static_cast<std::size_t>(
        std::count_if(kind.parameters.begin(), kind.parameters.end(),
                      [](const MediumParameter& parameter) { return parameter.key == nullptr; }));
}

/// The parameters as they are typed after the colon.
std::string describe_parameters(const Species& species) {
    const std::vector<MediumParameter>& known = kind_of(species).parameters;
    std::string text;
    for (std::size_t i = 0; i < species.parameters.size(); ++i) {
        const bool has_key = i < known.size() && known[i].key != nullptr;
        if (has_key && species.parameters[i] == 0.0) continue;
        if (!text.empty()) text += ",";
        if (has_key) text += std::string(known[i].key) + "=";
        text += fmt::format("{}", species.parameters[i]);
    }
    return text;
}

/// Whether what follows the colon begins with no number.
bool names_file(const std::string& values) {
    const std::vector<std::string> parts = split_list(values);
    if (parts.empty() || parts.front().empty()) return false;
    try {
        parse_number(parts.front(), "file");
    } catch (const UsageError&) {
        return true;
    }
    return false;
}

/// Reads the words before the keys.
void read_species(const std::string& text, const MediumKind& kind, Species& species) {
    if (text.empty()) {
        throw UsageError("an empty medium; write a material's name, e.g. TiO2, or hg:0.9,0.7");
    }
    species.kind = kind.kind;
    const std::string values =
        kind.kind == Species::Kind::material ? text : text.substr(text.find(':') + 1);
    if (kind.read) {
        kind.read(values, species);
    } else if (kind.read_file && names_file(values)) {
        kind.read_file(values, species);
    } else {
        species.parameters = read_parameters(text, values, kind);
    }
}

/// The parts of a text between ` + `.
std::vector<std::string> split_mixture(const std::string& text) {
    const std::string plus = " + ", outside = blank_in_parentheses(text);
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (std::size_t at = outside.find(plus); at != std::string::npos;
         at = outside.find(plus, begin)) {
        parts.push_back(text.substr(begin, at - begin));
        begin = at + plus.size();
    }
    parts.push_back(text.substr(begin));
    return parts;
}

bool is_mass(const Species& species) {
    return species.amount && species.amount->kind == Amount::Kind::mass_fraction;
}

void require_sum(const std::string& text, const Medium& medium, Amount::Kind kind,
                 const char* name) {
    double sum = 0.0;
    for (const Species& species : medium.species) {
        if (species.amount && species.amount->kind == kind) sum += species.amount->value;
    }
    constexpr double kRounding = 1e-12;
    if (sum <= 1.0 + kRounding) return;
    throw UsageError(fmt::format("medium '{}': the {} fractions add up to {}; allowed: up to 1",
                                 text, name, sum));
}

/// How kinds with an extinction are written.
std::vector<std::string> mixable_forms() {
    std::vector<std::string> forms;
    for (const MediumKind& kind : medium_kinds()) {
        const bool is_listed = !kind.form.empty() && kind.kind != Species::Kind::material;
        if (is_listed && (!kind.given || kind.has_extinction)) forms.push_back(kind.form);
    }
    return forms;
}

bool is_slide(const Species& species) { return species.kind == Species::Kind::slide; }

Host host_of_slide(const Species& slide) {
    return {{}, {slide.parameters[0], slide.parameters[1]}};
}

void require_amounts(const Medium& medium) {
    const std::string text = describe(medium);
    const bool has_slide = std::any_of(medium.species.begin(), medium.species.end(), is_slide);
    if (has_slide &&
        (medium.species.size() > 1 || medium.host != host_of_slide(medium.species[0]))) {
        throw UsageError(fmt::format(
            "medium '{}': a slide is a layer of its own with an index of its own; write it as one, "
            "slide:1.5@1mm, above or below the others",
            text));
    }
    for (const Species& species : medium.species) {
        if (species.amount && species.amount->kind == Amount::Kind::volume_fraction &&
            !kind_of(species).fills_layer && species.amount->value > kDensestPacking) {
            throw UsageError(fmt::format(
                "medium '{}': volume fraction {} is out of range; allowed: up to {}, the densest "
                "packing of equal spheres",
                text, species.amount->value, kDensestPacking));
        }
    }
    require_sum(text, medium, Amount::Kind::volume_fraction, "volume");
    require_sum(text, medium, Amount::Kind::mass_fraction, "mass");
    if (medium.species.size() == 1) {
        // One would read its coefficients as those of the layer, the other as those before
        // dilution.
        if (medium.species[0].kind != Species::Kind::turbid || !medium.species[0].amount) return;
        throw UsageError(fmt::format(
            "medium '{}': a turbid medium alone fills its layer, and its coefficients are those of "
            "the layer; leave its amount out, or add what fills the rest: turbid:0.01,1.2,0.8,"
            "volume=20% + paste:acrylic_white,volume=80%",
            text));
    }
    std::size_t without = 0, by_mass = 0;
    for (const Species& species : medium.species) {
        if (!has_extinction(species)) {
            throw UsageError(
                fmt::format("medium '{}': {} has optics and no extinction, so its share in a "
                            "mixture is not known; allowed in a mixture: materials, source:KEY, {}",
                            text, describe(species), fmt::join(mixable_forms(), ", ")));
        }
        without += species.amount ? 0 : 1;
        by_mass += is_mass(species) ? 1 : 0;
    }
    const bool is_rest = without == 1 && by_mass + 1 == medium.species.size();
    if (without == 0 || is_rest) return;
    throw UsageError(fmt::format(
        "medium '{}': {} of {} species without an amount; give each volume=, mass= or number=, "
        "e.g. volume=15% or number=1e9/cm3; where all but one are mass fractions, that one is the "
        "rest",
        text, without, medium.species.size()));
}

/// Coatings have thicknesses, and the name of a file may have an @.
bool ends_in_depth(const std::string& text) {
    const std::size_t at = text.rfind('@');
    std::error_code no_name;
    if (at == std::string::npos || text.find("coating=") < at ||
        std::filesystem::exists(text.substr(text.find(':') + 1), no_name))
        return false;
    try {
        depth(text.substr(at + 1));
        return true;
    } catch (const UsageError&) {
        return false;
    }
}

}  // namespace

Species species(const std::string& text) {
    Species species;
    const MediumKind& kind = kind_of_text(text);
    const std::string before_keys = take_keys(text, !kind.given, species);
    if (!kind.has_extinction) require_particles(text, kind, species);
    read_species(before_keys, kind, species);
    if (is_slide(species) && !species.amount)
        species.amount = Amount{Amount::Kind::volume_fraction, 0.0};
    require_particles(text, kind, species);  // what a file takes depends on what it has
    validate_keys(species, text);
    return species;
}

Medium medium(const std::string& text) {
    if (ends_in_depth(text)) {
        throw UsageError(fmt::format(
            "medium '{}': {} is the depth of a layer, and this one has none; write the layer as a "
            "coat: --coat \"{}\", above a base or a substrate",
            text, text.substr(text.rfind('@')), text));
    }
    Medium medium;
    std::string mixture = text;
    const std::string in = " in ";
    const std::size_t at = text.rfind(in);
    std::error_code no_name;  // a long mixture cannot be the name of a file
    if (at != std::string::npos &&
        !std::filesystem::exists(text.substr(text.find(':') + 1), no_name)) {
        medium.host = host(trimmed_text(text.substr(at + in.size())));
        mixture = text.substr(0, at);
    }
    for (const std::string& part : split_mixture(mixture))
        medium.species.push_back(species(trimmed_text(part)));
    if (is_slide(medium.species.front()) && !medium.host)
        medium.host = host_of_slide(medium.species.front());
    require_amounts(medium);
    return medium;
}

Host host(const std::string& text) {
    const std::string prefix = "index:";
    double n = 0.0;
    const bool is_number = std::isdigit(static_cast<unsigned char>(text.empty() ? 'x' : text[0])) &&
                           text.find_first_not_of("0123456789.,eE+-ij") == std::string::npos;
    Host host;
    if (!is_number && !text.starts_with(prefix)) {
        if (text.empty()) throw UsageError("host: empty; write PMMA or index:1.5");
        host.name = text;
        return host;
    }
    const auto parts = split_index(is_number ? text : text.substr(prefix.size()));
    if (parts.empty() || parts.size() > 2)
        throw UsageError(fmt::format("host '{}': write a material's name or index:N,K", text));
    n = parse_number(parts[0], fmt::format("host '{}'", text));
    const double k =
        parts.size() == 2 ? parse_number(parts[1], fmt::format("host '{}'", text)) : 0.0;
    host.index = {n, k};
    validate(host);
    return host;
}

void validate(const Host& host) {
    const double n = host.index.real(), k = host.index.imag();
    // The index may be that of a host or of a mirror.
    if (!(n > 0.0 && n <= kLargestIndex))
        throw UsageError(fmt::format("'{}', its n", describe(host)), n, "> 0, up to 1e6");
    if (!(k >= 0.0 && k <= kLargestIndex))
        throw UsageError(fmt::format("'{}', its k", describe(host)), k, ">= 0, up to 1e6");
}

void validate(const Species& species) {
    const MediumKind& kind = kind_of(species);
    const std::string text = describe(species);
    if (species.parameters.size() < least_parameters(kind) ||
        species.parameters.size() > kind.parameters.size()) {
        std::vector<std::string> names;
        for (const MediumParameter& parameter : kind.parameters) names.push_back(parameter.name);
        throw UsageError(fmt::format("medium '{}': parameters: {} given; allowed: {} ({})", text,
                                     species.parameters.size(), names.size(),
                                     fmt::join(names, ", ")));
    }
    require_ranges(text, kind, species.parameters);
    require_particles(text, kind, species);
    validate_keys(species, text);
    try {
        kind.check(species);
    } catch (const std::exception& error) {
        throw UsageError(fmt::format("medium '{}': {}", text, error.what()));
    }
}

void validate(const Medium& medium) {
    if (medium.species.empty()) {
        throw UsageError("an empty medium; write a material's name, e.g. TiO2, or hg:0.9,0.7");
    }
    for (const Species& species : medium.species) validate(species);
    if (medium.host) validate(*medium.host);
    require_amounts(medium);
}

std::string describe(const Species& species) {
    const std::string keys =
        describe_keys(is_slide(species) ? kind_of(species).without_own_keys(species) : species);
    if (species.kind == Species::Kind::material) return species.name + keys;
    if (!species.name.empty())
        return fmt::format("{}:{}{}", kind_of(species).name, species.name, keys);
    return fmt::format("{}:{}{}", kind_of(species).name, describe_parameters(species), keys);
}

std::string describe(const Host& host) {
    if (!host.name.empty()) return host.name;
    if (host.index.imag() == 0.0) return fmt::format("index:{}", host.index.real());
    return fmt::format("index:{},{}", host.index.real(), host.index.imag());
}

std::string describe(const Medium& medium) {
    std::string text;
    for (const Species& species : medium.species)
        text += (text.empty() ? "" : " + ") + describe(species);
    const bool has_own = medium.species.size() == 1 && is_slide(medium.species[0]) &&
                         medium.host == host_of_slide(medium.species[0]);
    if (medium.host && !has_own) text += " in " + describe(*medium.host);
    return text;
}

bool needs_mie(const Species& species) { return !kind_of(species).given; }

bool has_extinction(const Species& species) {
    return needs_mie(species) || kind_of(species).has_extinction;
}

bool needs_mie(const Medium& medium) {
    return std::any_of(medium.species.begin(), medium.species.end(),
                       [](const Species& species) { return needs_mie(species); });
}

std::vector<MediumForm> medium_forms() {
    std::vector<MediumForm> forms;
    for (const MediumKind& kind : medium_kinds()) {
        if (!kind.form.empty()) forms.push_back({kind.form, kind.example, kind.help});
    }
    return forms;
}

Layer layer(const std::string& text) {
    const std::size_t at = text.rfind('@');
    // `coating=SiO2@5nm` without a depth behind it is refused as a coating without thickness.
    const std::size_t coating = text.rfind("coating=", at);
    const bool is_of_coating = coating != std::string::npos && text.find('@', coating) == at;
    if (!is_of_coating && at != std::string::npos && text.find('=', at) != std::string::npos) {
        throw UsageError(
            fmt::format("coat '{}': what belongs to the medium comes before the depth, e.g. "
                        "TiO2,radius=0.1@1",
                        text));
    }
    if (at == std::string::npos) {
        throw UsageError(fmt::format(
            "coat '{}' has no depth; write MEDIUM@DEPTH, e.g. AlGaAs7@0.1 (optical depth at 550 "
            "nm) or TiO2,volume=15%@40um",
            text));
    }
    try {
        return {medium(text.substr(0, at)), depth(text.substr(at + 1))};
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("coat '{}': {}", text, error.what()));
    }
}

}  // namespace miebrdf
