// The refracting boundary or the opaque surface on top of a scene: from words, and back.
#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <cctype>

#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_parts.h"

namespace miebrdf {

namespace {

rte::MicrofacetDistribution slopes_named(const std::string& name, const std::string& where) {
    if (name == "beckmann") return rte::MicrofacetDistribution::beckmann;
    if (name == "ggx") return rte::MicrofacetDistribution::ggx;
    throw UsageError(
        fmt::format("{}: unknown distribution '{}'; allowed: beckmann, ggx", where, name));
}

constexpr const char* name_of(rte::MicrofacetDistribution distribution) {
    return distribution == rte::MicrofacetDistribution::ggx ? "ggx" : "beckmann";
}

}  // namespace

std::optional<rte::SurfaceOptions> rough_surface(const std::string& text) {
    const auto parts = split_list(text);
    const bool names_slopes =
        parts.size() == 2 && std::isalpha(static_cast<unsigned char>(parts[1][0])) != 0;
    if (parts.empty() || parts.front().empty() || (parts.size() > 1 && !names_slopes)) {
        throw UsageError(
            fmt::format("roughness '{}': allowed: one value of ALPHA (0: no surface), "
                        "alone or with its slopes: ALPHA,beckmann; ALPHA,ggx",
                        text));
    }
    rte::SurfaceOptions surface{.beckmann_alpha = parse_number(parts[0], "roughness")};
    const double alpha = surface.beckmann_alpha;
    if (!(alpha >= 0.0 && alpha <= 2.0)) throw UsageError("roughness", alpha, "0 (no lobe) to 2");
    if (names_slopes) surface.distribution = slopes_named(parts[1], "roughness '" + text + "'");
    if (alpha == 0.0) return std::nullopt;
    return surface;
}

std::string describe(const rte::SurfaceOptions& surface) {
    const bool is_usual = surface.distribution == rte::MicrofacetDistribution::beckmann;
    return fmt::format("{}{}", surface.beckmann_alpha, is_usual ? "" : ",ggx");
}

rte::Boundary boundary(const std::string& text) {
    if (text == "smooth") return {};
    const std::string rough = "rough:";
    const auto parts = split_list(text.starts_with(rough) ? text.substr(rough.size()) : "");
    if (parts.empty() || parts.size() > 2 || parts.front().empty()) {
        throw UsageError(fmt::format(
            "boundary '{}': allowed: smooth, rough:ALPHA, rough:ALPHA,beckmann, rough:ALPHA,ggx",
            text));
    }
    rte::Boundary boundary{.roughness = parse_number(parts[0], "boundary roughness")};
    rte::validate(boundary);
    if (parts.size() == 2)
        boundary.distribution = slopes_named(parts[1], "boundary '" + text + "'");
    return boundary.is_rough() ? boundary : rte::Boundary{};
}

std::string describe(const rte::Boundary& boundary) {
    if (!boundary.is_rough()) return "smooth";
    return fmt::format("rough:{},{}", boundary.roughness, name_of(boundary.distribution));
}

}  // namespace miebrdf
