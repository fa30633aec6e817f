#include "pipeline/scene/medium.h"

#include <fmt/format.h>

#include <miebrdf/error.h>
#include "pipeline/scene/moments_file.h"
#include "pipeline/scene/number_list.h"

namespace miebrdf {
namespace {

/// The numbers after the colon of `kind:a,b`, exactly `count` of them.
std::vector<double> parameters(const std::string& text, const std::string& values,
                               std::size_t count, const std::string& form) {
    const std::vector<std::string> parts = split_list(values);
    if (parts.size() != count) {
        throw UsageError(fmt::format("medium '{}': write {}", text, form));
    }
    std::vector<double> numbers;
    numbers.reserve(parts.size());
    for (const std::string& part : parts) {
        numbers.push_back(parse_number(part, fmt::format("medium '{}'", text)));
    }
    return numbers;
}

double checked_albedo(const std::string& text, double albedo) {
    if (!(albedo >= 0.0 && albedo <= 1.0)) {
        throw UsageError(
            fmt::format("medium '{}': single-scattering albedo {} is out of range; "
                        "allowed: [0, 1]",
                        text, albedo));
    }
    return albedo;
}

Medium parse_henyey_greenstein(const std::string& text, const std::string& values) {
    const auto numbers = parameters(text, values, 2, "hg:ALBEDO,G, e.g. hg:0.9,0.7");
    if (!(numbers[1] > -1.0 && numbers[1] < 1.0)) {
        throw UsageError(fmt::format("medium '{}': asymmetry {} is out of range; allowed: (-1, 1)",
                                     text, numbers[1]));
    }
    return HenyeyGreensteinMedium{checked_albedo(text, numbers[0]), numbers[1]};
}

Medium parse_index(const std::string& text, const std::string& values) {
    const auto numbers = parameters(text, values, 2, "index:N,K, e.g. index:1.5,0.01");
    if (!(numbers[0] > 0.0 && numbers[1] >= 0.0)) {
        throw UsageError(
            fmt::format("medium '{}': refractive index {} + {}i is out of range; "
                        "allowed: n > 0, k >= 0",
                        text, numbers[0], numbers[1]));
    }
    return IndexMedium{{numbers[0], numbers[1]}};
}

/// `hg` of `hg:0.9,0.5`; the whole text where it has no colon.
std::string kind_of(const std::string& text) { return text.substr(0, text.find(':')); }

/// A medium without sizes of its own.
Medium parse_bare(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::string kind = kind_of(text);
    const std::string values = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (text.empty()) {
        throw UsageError("an empty medium; write a material's name, e.g. TiO2, or hg:0.9,0.7");
    }
    if (colon == std::string::npos) return DatabaseMedium{text};
    if (kind == "index") return parse_index(text, values);
    if (kind == "hg") return parse_henyey_greenstein(text, values);
    if (kind == "isotropic") {
        const auto numbers = parameters(text, values, 1, "isotropic:ALBEDO, e.g. isotropic:0.9");
        return IsotropicMedium{checked_albedo(text, numbers[0])};
    }
    if (kind == "rayleigh") {
        const auto numbers = parameters(text, values, 1, "rayleigh:ALBEDO, e.g. rayleigh:0.9");
        return RayleighMedium{checked_albedo(text, numbers[0])};
    }
    if (kind == "moments") {
        MomentsFile file = read_moments_file(values);
        return MomentsMedium{values, file.single_scattering_albedo, std::move(file.chi)};
    }
    return DatabaseMedium{text};  // source:KEY
}

/// Media that bring their optics: nothing of theirs depends on the sizes of particles.
bool brings_optics(const std::string& kind) {
    return kind == "hg" || kind == "isotropic" || kind == "rayleigh" || kind == "moments";
}

}  // namespace

Medium parse_medium(const std::string& text) {
    const std::string kind = kind_of(text);
    const bool is_given = kind != text && brings_optics(kind);
    const SizedText parts = split_sizes(text, !is_given);
    if (is_given && parts.sizes != LayerSizes{}) {
        throw UsageError(
            fmt::format("medium '{}': {}: media have no particles, leave '{}' out; sizes belong to "
                        "media that go through Mie theory: materials, source:KEY, index:N,K",
                        text, kind, describe(parts.sizes)));
    }
    return with_sizes(parse_bare(parts.medium), parts.sizes);
}

std::string describe(const Medium& medium) {
    struct Describer {
        std::string operator()(const DatabaseMedium& m) const { return m.name + describe(m.sizes); }
        std::string operator()(const IndexMedium& m) const {
            return fmt::format("index:{},{}{}", m.refractive_index.real(),
                               m.refractive_index.imag(), describe(m.sizes));
        }
        std::string operator()(const IsotropicMedium& m) const {
            return fmt::format("isotropic:{}", m.single_scattering_albedo);
        }
        std::string operator()(const RayleighMedium& m) const {
            return fmt::format("rayleigh:{}", m.single_scattering_albedo);
        }
        std::string operator()(const HenyeyGreensteinMedium& m) const {
            return fmt::format("hg:{},{}", m.single_scattering_albedo, m.asymmetry);
        }
        std::string operator()(const MomentsMedium& m) const { return "moments:" + m.path; }
    };
    return std::visit(Describer{}, medium);
}

bool needs_mie(const Medium& medium) {
    return std::holds_alternative<DatabaseMedium>(medium) ||
           std::holds_alternative<IndexMedium>(medium);
}

LayerSizes sizes_of(const Medium& medium) {
    if (const auto* named = std::get_if<DatabaseMedium>(&medium)) return named->sizes;
    if (const auto* constant = std::get_if<IndexMedium>(&medium)) return constant->sizes;
    return {};
}

Medium with_sizes(Medium medium, const LayerSizes& sizes) {
    if (auto* named = std::get_if<DatabaseMedium>(&medium)) named->sizes = sizes;
    if (auto* constant = std::get_if<IndexMedium>(&medium)) constant->sizes = sizes;
    return medium;
}

ParticleOptions particles_of(const Medium& medium, const ParticleOptions& of_scene) {
    ParticleOptions particles = of_scene;
    particles.sizes = resolved_sizes(sizes_of(medium), of_scene.sizes);
    return particles;
}

CoatMedium parse_coat(const std::string& text) {
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
    return {parse_medium(text.substr(0, at)), optical_depth};
}

}  // namespace miebrdf
