// Media and layers from words, and back.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <cmath>
#include <utility>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/particle_sizes.h"

namespace miebrdf {
namespace {

/// The kind that a text begins with; a text without a known one names a material.
const MediumKind& kind_of_text(const std::string& text) {
    const std::size_t colon = text.find(':');
    if (colon != std::string::npos) {
        for (const MediumKind& kind : medium_kinds()) {
            if (kind.name == text.substr(0, colon) && kind.name != "material" && !kind.form.empty())
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

/// Sizes belong to spheres.
void require_particles(const std::string& text, const MediumKind& kind,
                       const ParticleSizes& sizes) {
    if (!kind.optics || sizes == ParticleSizes{}) return;
    throw UsageError(
        fmt::format("medium '{}': {}: media have no particles, leave '{}' out; sizes belong to "
                    "media that go through Mie theory: materials, source:KEY, index:N,K",
                    text, kind.name, describe(sizes)));
}

/// The numbers after the colon, one for each parameter of the kind.
std::vector<double> read_parameters(const std::string& text, const std::string& values,
                                    const MediumKind& kind) {
    std::vector<double> parameters;
    const std::vector<std::string> parts = split_list(values);
    if (parts.size() != kind.parameters.size()) {
        throw UsageError(
            fmt::format("medium '{}': write {}, e.g. {}", text, kind.form, kind.example));
    }
    for (const std::string& part : parts)
        parameters.push_back(parse_number(part, fmt::format("medium '{}'", text)));
    require_ranges(text, kind, parameters);
    return parameters;
}

/// A medium without sizes of its own.
Medium read_medium(const std::string& text, const MediumKind& kind) {
    if (text.empty()) {
        throw UsageError("an empty medium; write a material's name, e.g. TiO2, or hg:0.9,0.7");
    }
    Medium medium;
    medium.kind = kind.name;
    const std::string values = kind.name == "material" ? text : text.substr(text.find(':') + 1);
    if (kind.read) {
        kind.read(values, medium);
    } else {
        medium.parameters = read_parameters(text, values, kind);
    }
    return medium;
}

}  // namespace

Medium medium(const std::string& text) {
    const MediumKind& kind = kind_of_text(text);
    const SizedText parts = split_sizes(text, !kind.optics);
    require_particles(text, kind, parts.sizes);
    Medium medium = read_medium(parts.medium, kind);
    medium.sizes = parts.sizes;
    return medium;
}

void validate(const Medium& medium) {
    const MediumKind& kind = kind_of(medium);
    const std::string text = describe(medium);
    if (medium.parameters.size() != kind.parameters.size()) {
        std::vector<std::string> names;
        for (const MediumParameter& parameter : kind.parameters) names.push_back(parameter.name);
        throw UsageError(fmt::format("medium '{}': parameters: {} given; allowed: {} ({})", text,
                                     medium.parameters.size(), names.size(),
                                     fmt::join(names, ", ")));
    }
    require_ranges(text, kind, medium.parameters);
    require_particles(text, kind, medium.sizes);
    validate(medium.sizes, text);
    try {
        kind.check(medium);
    } catch (const std::exception& error) {
        throw UsageError(fmt::format("medium '{}': {}", text, error.what()));
    }
}

std::string describe(const Medium& medium) {
    const std::string sizes = describe(medium.sizes);
    if (medium.kind == "material") return medium.name + sizes;
    if (!medium.name.empty()) return fmt::format("{}:{}{}", medium.kind, medium.name, sizes);
    return fmt::format("{}:{}{}", medium.kind, fmt::join(medium.parameters, ","), sizes);
}

bool needs_mie(const Medium& medium) { return !kind_of(medium).optics; }

std::vector<MediumForm> medium_forms() {
    std::vector<MediumForm> forms;
    for (const MediumKind& kind : medium_kinds()) {
        if (!kind.form.empty()) forms.push_back({kind.form, kind.example, kind.help});
    }
    return forms;
}

Layer layer(const std::string& text) {
    const std::size_t at = text.rfind('@');
    if (at != std::string::npos && text.find('=', at) != std::string::npos) {
        throw UsageError(
            fmt::format("coat '{}': what belongs to the medium comes before the optical depth, "
                        "e.g. TiO2,radius=0.1@1",
                        text));
    }
    if (at == std::string::npos) {
        throw UsageError(
            fmt::format("coat '{}' has no optical depth; write MEDIUM@OPTICAL_DEPTH, "
                        "e.g. AlGaAs7@0.1",
                        text));
    }
    const double optical_depth = parse_number_or_infinity(text.substr(at + 1), "optical depth");
    if (!(optical_depth >= 0.0)) {
        throw UsageError(fmt::format("coat '{}': optical depth {} is out of range; allowed: >= 0",
                                     text, optical_depth));
    }
    return {medium(text.substr(0, at)), optical_depth};
}

}  // namespace miebrdf
