#include "tools/miebrdf/scene_family.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_words.h"

namespace miebrdf::program {
namespace {

constexpr double kMostMembers = 33;

Layer& top_layer(Request& request, const std::string& name) {
    if (request.scene.layers.empty()) {
        throw UsageError(fmt::format(
            "--vary {}: the scene has no layer; add one with --coat, or vary another number",
            name));
    }
    return request.scene.layers.back();
}

Medium& top_medium_of(Request& request) {
    Scene& scene = request.scene;
    return scene.layers.empty() ? scene.base : scene.layers.back().medium;
}

Species& first_species(Request& request, const std::string& name) {
    Medium& medium = top_medium_of(request);
    if (medium.species.empty() || !needs_mie(medium.species.front()))
        throw UsageError(fmt::format("--vary {}: the top layer has no particles", name));
    return medium.species.front();
}

struct DepthWords {
    const char *name, *unit;
};
DepthWords depth_words(const Depth& depth) {
    if (depth.kind == Depth::Kind::thickness_um) return {"thickness", "um"};
    if (depth.kind == Depth::Kind::mass_kg_per_m2) return {"mass per area", "kg/m2"};
    return {"optical depth", ""};
}

Amount& amount_of(Request& request, const std::string& name) {
    Species& species = first_species(request, name);
    if (!species.amount) {
        throw UsageError(
            fmt::format("--vary {}: '{}' has no amount; give one, e.g. volume=1% or mass=100ppb",
                        name, describe(species)));
    }
    return *species.amount;
}

DepthWords amount_words(const Amount& amount) {
    if (amount.kind == Amount::Kind::volume_fraction) return {"volume fraction", ""};
    if (amount.kind == Amount::Kind::mass_fraction) return {"mass fraction", ""};
    return {"number density", "1/cm3"};
}

const SceneWord& number_word(const std::string& name) {
    const SceneWord* word = find_scene_word(name);
    if (word == nullptr || word->kind != WordKind::single) {
        throw UsageError(fmt::format(
            "--vary: unknown name '{}'; allowed: depth, roughness, radius, concentration, and "
            "options of the scene that take one number (effective-variance, host-index, ...)",
            name));
    }
    return *word;
}

/// The quantity that is varied, and its unit.
DepthWords words_of(const std::string& name, Request request) {
    if (name == "depth") return depth_words(top_layer(request, name).depth);
    if (name == "concentration") return amount_words(amount_of(request, name));
    if (name == "radius") return {"effective radius", "um"};
    const SceneWord& word = number_word(name);
    return {word.name.c_str(), word.unit.c_str()};
}

}  // namespace

std::vector<double> Family::values_or_one() const {
    return values.empty() ? std::vector<double>{0.0} : values;
}

std::string Family::label(const Request& request) const {
    if (name.empty()) return "";
    const DepthWords words = words_of(name, request);
    std::string text = words.name;
    if (name == "depth") text += " of the top layer";
    if (name == "radius" || name == "concentration") {
        Request copy = request;
        text += " of " + first_species(copy, name).name;
    }
    if (*words.unit != '\0') text += fmt::format(" ({})", words.unit);
    return text;
}

std::string Family::apply(double value, Request& request) const {
    if (name.empty()) return "";
    const DepthWords words = words_of(name, request);
    if (name == "depth") {
        top_layer(request, name).depth.value = value;
    } else if (name == "radius") {
        first_species(request, name).sizes.effective_radius_um = value;
    } else if (name == "concentration") {
        amount_of(request, name).value = value;
    } else {
        miebrdf::apply(number_word(name), std::vector<WordValue>{value}, request);
    }
    return fmt::format("{} {:.4g}{}{}", words.name, value, *words.unit == '\0' ? "" : " ",
                       words.unit);
}

Family parse_family(const std::string& text) {
    const auto refuse = [&] {
        throw UsageError(
            fmt::format("--vary '{}': wanted: NAME=FROM:TO:COUNT with COUNT from 2 to "
                        "{}, e.g. depth=0:2:9, or as many values: depth=0.1,1,10",
                        text, kMostMembers));
    };
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) refuse();
    Family family{text.substr(0, equals), {}};
    std::vector<double> numbers;
    std::size_t from = equals + 1;
    if (text.find(',', from) != std::string::npos && text.find(':', from) == std::string::npos) {
        family.values = parse_number_list(text.substr(from), "--vary " + family.name);
        if (family.values.size() < 2 || family.values.size() > std::size_t(kMostMembers)) refuse();
        return family;
    }
    while (true) {
        const std::size_t colon = text.find(':', from);
        numbers.push_back(parse_number(text.substr(from, colon - from), "--vary " + family.name));
        if (colon == std::string::npos) break;
        from = colon + 1;
    }
    if (numbers.size() != 3) refuse();
    const double count = numbers[2];
    if (!(count >= 2.0 && count <= kMostMembers && count == double(int(count)))) refuse();
    if (numbers[0] == numbers[1]) refuse();
    for (int i = 0; i < int(count); ++i) {
        const double share = i / (count - 1.0);
        family.values.push_back((1.0 - share) * numbers[0] + share * numbers[1]);
    }
    return family;
}

}  // namespace miebrdf::program
