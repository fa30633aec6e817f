// How deep layers are: from words, and back.
#include <fmt/format.h>
#include <miebrdf/error.h>
#include <miebrdf/scene.h>

#include <array>
#include <cmath>
#include <utility>

#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_parts.h"

namespace miebrdf {
namespace {

constexpr std::array<Unit, 5> kThicknessesUm = {
    {{"nm", 1, 1000}, {"um", 1, 1}, {"µm", 1, 1}, {"mm", 1000, 1}, {"cm", 10000, 1}}};
constexpr std::array<Unit, 1> kMetres = {{{"m", 1000000, 1}}};
constexpr std::array<Unit, 4> kMasses = {
    {{"kg/m2", 1, 1}, {"g/m2", 1, 1000}, {"mg/m2", 1, 1000000}, {"g/cm2", 10, 1}}};

template <std::size_t count>
bool ends_in(const std::string& text, const std::array<Unit, count>& units) {
    for (const Unit& unit : units) {
        if (text.size() > unit.name.size() && text.ends_with(unit.name)) return true;
    }
    return false;
}

/// Where an optical depth holds: `450nm` or `grey`.
double depth_wavelength_nm(const std::string& text) {
    if (text == "grey" || text == "gray") return 0.0;
    return parse_wavelength_nm(text);
}

Depth read_depth(const std::string& text) {
    const std::string what = "depth";
    if (ends_in(text, kMasses))
        return {Depth::Kind::mass_kg_per_m2, parse_quantity(text, what, kMasses)};
    if (ends_in(text, kThicknessesUm))
        return {Depth::Kind::thickness_um, parse_quantity(text, what, kThicknessesUm)};
    if (ends_in(text, kMetres))
        return {Depth::Kind::thickness_um, parse_quantity(text, what, kMetres)};
    const std::size_t bracket = text.find('[');
    if (bracket == std::string::npos) return parse_number_or_infinity(text, "optical depth");
    if (text.back() != ']') throw UsageError("a bracket is not closed");
    return {Depth::Kind::optical_depth,
            parse_number_or_infinity(text.substr(0, bracket), "optical depth"),
            depth_wavelength_nm(text.substr(bracket + 1, text.size() - bracket - 2))};
}

}  // namespace

Depth grey(double optical_depth) { return {Depth::Kind::optical_depth, optical_depth, 0.0}; }

Depth depth(const std::string& text) {
    try {
        const Depth depth = read_depth(text);
        validate(depth);
        return depth;
    } catch (const UsageError& error) {
        throw UsageError(fmt::format(
            "depth '{}': {}; write an optical depth at 550 nm (0.1), at another wavelength "
            "(0.1[450nm]), the same at all (0.1[grey]), a thickness (40um, 2mm), a mass "
            "(2kg/m2) or inf",
            text, error.what()));
    }
}

void validate(const Depth& depth) {
    const bool may_be_infinite = depth.kind == Depth::Kind::optical_depth;
    const char* name = may_be_infinite                           ? "optical depth"
                       : depth.kind == Depth::Kind::thickness_um ? "thickness"
                                                                 : "mass per area";
    if (!(depth.value >= 0.0 && (may_be_infinite || std::isfinite(depth.value)))) {
        throw UsageError(fmt::format("{} {} is out of range; allowed: >= 0{}", name, depth.value,
                                     may_be_infinite ? "" : ", finite"));
    }
    if (!(depth.wavelength_nm >= 0.0 && std::isfinite(depth.wavelength_nm))) {
        throw UsageError(
            fmt::format("wavelength of an optical depth: {} nm; allowed: > 0, or 0 "
                        "for the same at all wavelengths",
                        depth.wavelength_nm));
    }
}

std::string describe(const Depth& depth) {
    switch (depth.kind) {
        case Depth::Kind::thickness_um:
            return fmt::format("{}um", depth.value);
        case Depth::Kind::mass_kg_per_m2:
            return fmt::format("{}kg/m2", depth.value);
        case Depth::Kind::optical_depth:
            break;
    }
    if (std::isinf(depth.value) || depth.wavelength_nm == kDepthWavelengthNm)
        return fmt::format("{}", depth.value);
    if (depth.wavelength_nm == 0.0) return fmt::format("{}[grey]", depth.value);
    return fmt::format("{}[{}nm]", depth.value, depth.wavelength_nm);
}

}  // namespace miebrdf
