// The refracting boundary on top of a scene: from words, and back.
#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include "pipeline/scene/number_list.h"

namespace miebrdf {

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
    if (boundary.roughness == 0.0) throw UsageError("boundary", 0.0, "rough:0.02 to 1, or smooth");
    rte::validate(boundary);
    if (parts.size() == 1) return boundary;
    if (parts[1] != "beckmann" && parts[1] != "ggx") {
        throw UsageError(
            fmt::format("boundary '{}': unknown distribution '{}'; allowed: beckmann, "
                        "ggx",
                        text, parts[1]));
    }
    boundary.distribution = parts[1] == "ggx" ? rte::MicrofacetDistribution::ggx
                                              : rte::MicrofacetDistribution::beckmann;
    return boundary;
}

std::string describe(const rte::Boundary& boundary) {
    if (!boundary.is_rough()) return "smooth";
    const bool is_ggx = boundary.distribution == rte::MicrofacetDistribution::ggx;
    return fmt::format("rough:{},{}", boundary.roughness, is_ggx ? "ggx" : "beckmann");
}

}  // namespace miebrdf
