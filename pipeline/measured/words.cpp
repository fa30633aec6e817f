// The words for quantities and geometries, in options and in files of instruments.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <miebrdf/error.h>
#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "pipeline/measured/reader.h"

namespace miebrdf {
namespace {

using Quantity = MeasuredQuantity;
using Geometry = MeasuredGeometry;

constexpr std::pair<std::string_view, MeasuredKind> kKinds[] = {
    {"plane_albedo", {Quantity::reflectance, Geometry::directional}},
    {"spherical_albedo", {Quantity::reflectance, Geometry::hemispherical}},
    {"hemispherical", {Quantity::reflectance, Geometry::hemispherical}},
    {"plane_transmittance", {Quantity::transmittance, Geometry::directional}},
    {"spherical_transmittance", {Quantity::transmittance, Geometry::hemispherical}},
    {"unscattered_transmittance", {Quantity::transmittance, Geometry::unscattered}},
    {"brdf", {Quantity::brdf, Geometry::directions}},
    {"reflection", {Quantity::reflectance_factor, Geometry::directions}},
    {"reflectance_factor", {Quantity::reflectance_factor, Geometry::directions}},
    {"hdrf", {Quantity::reflectance_factor, Geometry::hdrf}},
    {"d8-sci", {Quantity::reflectance, Geometry::d8_sci}},
    {"d8-sce", {Quantity::reflectance, Geometry::d8_sce}},
    {"45-0", {Quantity::reflectance_factor, Geometry::d45_0}},
    {"lab", {Quantity::lab_l, Geometry::unknown}},
    {"reflectance", {Quantity::reflectance, Geometry::unknown}},
    {"transmittance", {Quantity::transmittance, Geometry::unknown}},
};

}  // namespace

std::optional<MeasuredKind> measured::find_kind(std::string_view word) {
    for (const auto& [name, kind] : kKinds) {
        if (name == word) return kind;
    }
    return std::nullopt;
}

MeasuredKind measured_kind(std::string_view word) {
    if (const auto kind = measured::find_kind(word)) return *kind;
    std::string allowed;
    for (const auto& [name, kind] : kKinds) {
        allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", name);
    }
    throw UsageError("quantity", std::string(word), allowed);
}

std::string word_of(MeasuredQuantity quantity) {
    switch (quantity) {
        case Quantity::reflectance:
            return "reflectance";
        case Quantity::transmittance:
            return "transmittance";
        case Quantity::brdf:
            return "brdf";
        case Quantity::reflectance_factor:
            return "reflectance_factor";
        case Quantity::lab_l:
            return "lab_l";
        case Quantity::lab_a:
            return "lab_a";
        case Quantity::lab_b:
            break;
    }
    return "lab_b";
}

std::string word_of(MeasuredGeometry geometry) {
    switch (geometry) {
        case Geometry::unknown:
            return "";
        case Geometry::directional:
            return "directional";
        case Geometry::d8_sci:
            return "d8-sci";
        case Geometry::d8_sce:
            return "d8-sce";
        case Geometry::d45_0:
            return "45-0";
        case Geometry::hemispherical:
            return "hemispherical";
        case Geometry::unscattered:
            return "unscattered";
        case Geometry::hdrf:
            return "hdrf";
        case Geometry::directions:
            break;
    }
    return "directions";
}

bool is_share(MeasuredQuantity quantity) {
    return quantity == Quantity::reflectance || quantity == Quantity::transmittance ||
           quantity == Quantity::reflectance_factor;
}

namespace measured {

NamedGeometry geometry_in(std::string_view words) {
    std::string text = materials::lower_case(words);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '_' || c == '-' || c == '/'; }, ' ');
    const auto has = [&](std::string_view word) { return text.find(word) != std::string::npos; };
    if (has("45 0") || has("0 45") || has("45°0") || has("45:0")) return {Geometry::d45_0};
    const bool sphere = has("d 8") || has("8 d") || has("d8") || has("sphere") || has("specular");
    if (sphere && (has("sce") || has("spex") || has("exclu"))) return {Geometry::d8_sce};
    if (sphere && (has("sci") || has("spin") || has("inclu"))) return {Geometry::d8_sci};
    if (has("bidirectional") || has("biconical")) return {Geometry::directions};
    if (has("hemispherical") && has("directional")) {
        // "Directional (10 Degree) Hemispherical": the number before the word.
        const std::size_t degree = text.find("deg");
        if (degree != std::string::npos) {
            const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
            std::size_t end = degree;
            while (end > 0 && !is_digit(text[end - 1])) --end;
            std::size_t begin = end;
            while (begin > 0 && is_digit(text[begin - 1])) --begin;
            const auto angle = materials::parse_number(text.substr(begin, end - begin));
            if (angle && *angle < 90.0) return {Geometry::directional, cosine_of(*angle)};
        }
        return {Geometry::directional};
    }
    return {};
}

}  // namespace measured
}  // namespace miebrdf
