#include "pipeline/measured/columns.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {
namespace {

using Quantity = MeasuredQuantity;
using Geometry = MeasuredGeometry;

constexpr std::pair<std::string_view, Role> kRoles[] = {
    {"mu_in", Role::mu_in},        {"mu_i", Role::mu_in},
    {"mu_0", Role::mu_in},         {"mu0", Role::mu_in},
    {"mu_out", Role::mu_out},      {"mu_r", Role::mu_out},
    {"mu", Role::mu_out},          {"quantity", Role::quantity},
    {"geometry", Role::geometry},  {"sample", Role::sample},
    {"sample_name", Role::sample}, {"name", Role::sample},
    {"specimen", Role::sample},    {"sample_id", Role::sample},
    {"sampleid", Role::sample},    {"id", Role::sample},
    {"value", Role::value},        {"sza", Role::theta_in},
    {"vza", Role::theta_out},      {"saa", Role::phi_in},
    {"vaa", Role::phi_out},        {"raa", Role::phi},
    {"dphi", Role::phi},           {"aoi", Role::theta_in},
    {"aos", Role::theta_out},      {"inc", Role::theta_in},
    {"emi", Role::theta_out},      {"incidence", Role::theta_in},
    {"emission", Role::theta_out},
};

template <std::size_t N>
bool is_one_of(std::string_view word, const std::string_view (&words)[N]) {
    return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// Names of directions: an angle and a side in either order, `theta_i`, `thetar`,
/// `solar_zenith_angle`, `incident azimuth`, `relative_azimuth`.
std::optional<Role> direction_role(const std::string& bare) {
    static constexpr std::string_view kZenith[] = {"theta", "zenith", "polar"};
    static constexpr std::string_view kAzimuth[] = {"phi", "azimuth", "azimuthal", "azi"};
    static constexpr std::string_view kIn[] = {"i",         "in",    "inc",          "incident",
                                               "incidence", "0",     "source",       "sun",
                                               "solar",     "light", "illumination", "input"};
    static constexpr std::string_view kOut[] = {
        "r",           "out",        "s",        "o",         "v",        "e",       "refl",
        "reflected",   "reflection", "scatter",  "scattered", "view",     "viewing", "observer",
        "observation", "sensor",     "detector", "emission",  "emergent", "exit",    "output"};
    static constexpr std::string_view kFill[] = {"angle", "direction", "of"};
    static constexpr std::string_view kRelative[] = {"relative", "rel", "delta", "difference"};
    bool zenith = false, azimuth = false, in = false, out = false, angle = false, relative = false;
    std::size_t begin = 0;
    while (begin <= bare.size()) {
        const std::size_t end = std::min(bare.find('_', begin), bare.size());
        std::string_view word = std::string_view(bare).substr(begin, end - begin);
        begin = end + 1;
        for (const auto& [name, is_azimuth] :
             {std::pair<std::string_view, bool>{"theta", false}, {"phi", true}}) {
            if (!word.starts_with(name) || word.size() == name.size()) continue;
            (is_azimuth ? azimuth : zenith) = true;  // "thetai"
            word.remove_prefix(name.size());
        }
        if (is_one_of(word, kZenith)) {
            zenith = true;
        } else if (is_one_of(word, kAzimuth)) {
            azimuth = true;
        } else if (is_one_of(word, kIn)) {
            in = true;
        } else if (is_one_of(word, kOut)) {
            out = true;
        } else if (is_one_of(word, kRelative)) {
            relative = true;
        } else if (is_one_of(word, kFill)) {
            angle = true;
        } else {
            return std::nullopt;
        }
    }
    if ((in && out) || (zenith && azimuth)) return std::nullopt;
    if (azimuth && (relative || (!in && !out))) return Role::phi;
    if (relative || (!in && !out) || !(zenith || azimuth || angle)) return std::nullopt;
    if (azimuth) return in ? Role::phi_in : Role::phi_out;
    return in ? Role::theta_in : Role::theta_out;
}

/// Names of values that are no words of measured_kind().
constexpr std::pair<std::string_view, MeasuredKind> kValues[] = {
    {"r", {Quantity::reflectance, Geometry::unknown}},
    {"refl", {Quantity::reflectance, Geometry::unknown}},
    {"reflectivity", {Quantity::reflectance, Geometry::unknown}},
    {"total_reflectance", {Quantity::reflectance, Geometry::unknown}},
    {"albedo", {Quantity::reflectance, Geometry::unknown}},
    {"r_total", {Quantity::reflectance, Geometry::unknown}},
    {"t", {Quantity::transmittance, Geometry::unknown}},
    {"trans", {Quantity::transmittance, Geometry::unknown}},
    {"total_transmittance", {Quantity::transmittance, Geometry::unknown}},
    {"t_total", {Quantity::transmittance, Geometry::unknown}},
    {"sci", {Quantity::reflectance, Geometry::d8_sci}},
    {"spin", {Quantity::reflectance, Geometry::d8_sci}},
    {"r_sci", {Quantity::reflectance, Geometry::d8_sci}},
    {"d8_sci", {Quantity::reflectance, Geometry::d8_sci}},
    {"sce", {Quantity::reflectance, Geometry::d8_sce}},
    {"spex", {Quantity::reflectance, Geometry::d8_sce}},
    {"r_sce", {Quantity::reflectance, Geometry::d8_sce}},
    {"d8_sce", {Quantity::reflectance, Geometry::d8_sce}},
    {"45_0", {Quantity::reflectance_factor, Geometry::d45_0}},
    {"r_45_0", {Quantity::reflectance_factor, Geometry::d45_0}},
    {"brf", {Quantity::reflectance_factor, Geometry::directions}},
    {"radiance_factor", {Quantity::reflectance_factor, Geometry::directions}},
    {"fr", {Quantity::brdf, Geometry::directions}},
    {"f_r", {Quantity::brdf, Geometry::directions}},
    {"fr11", {Quantity::brdf, Geometry::directions}},
    {"f_r11", {Quantity::brdf, Geometry::directions}},
    {"m11", {Quantity::brdf, Geometry::directions}},
    {"l", {Quantity::lab_l, Geometry::unknown}},
    {"l*", {Quantity::lab_l, Geometry::unknown}},
    {"lab_l", {Quantity::lab_l, Geometry::unknown}},
    {"a*", {Quantity::lab_a, Geometry::unknown}},
    {"lab_a", {Quantity::lab_a, Geometry::unknown}},
    {"b*", {Quantity::lab_b, Geometry::unknown}},
    {"lab_b", {Quantity::lab_b, Geometry::unknown}},
};

/// "Wellenlänge [nm]" -> "wavelength [nm]", whatever its encoding; "Reflexionsgrad" likewise.
std::string in_english(std::string_view name) {
    static constexpr std::pair<std::string_view, std::string_view> kWords[] = {
        {"wellenl", "wavelength"},          {"longueur d", "wavelength"},
        {"longitud de onda", "wavelength"}, {"lunghezza d", "wavelength"},
        {"reflexion", "reflectance"},       {"reflectancia", "reflectance"},
        {"riflettanza", "reflectance"},     {"transmissionsgrad", "transmittance"}};
    const std::string text = materials::lower_case(name);
    for (const auto& [word, english] : kWords) {
        if (!text.starts_with(word)) continue;
        const std::size_t unit = name.find_first_of("([{%");
        return std::string(english) +
               (unit == std::string_view::npos ? "" : " " + std::string(name.substr(unit)));
    }
    return std::string(name);
}

std::optional<MeasuredKind> kind_of(const std::string& bare) {
    for (const auto& [name, kind] : kValues) {
        if (name == bare) return kind;
    }
    try {
        return measured_kind(bare);
    } catch (const UsageError&) {
        return std::nullopt;
    }
}

}  // namespace

ColumnRole column_role(std::string_view given) {
    ColumnRole column;
    const std::string name = in_english(given), bare = bare_name(name),
                      text = materials::lower_case(name);
    // A unit alone ("nm") names wavelengths; a single letter ("A") may be an albedo.
    const auto spectral = materials::spectral_name(name);
    if (spectral && text.size() > 1) {
        column.role = Role::wavelength;
        column.unit = spectral->unit;
        if (!column.unit && text.find("micron") != std::string::npos)
            column.unit = materials::Unit::micrometre;
        return column;
    }
    if (text == "azimuth_deg") return {Role::azimuth_deg};
    std::optional<Role> role = direction_role(bare);
    if (bare.starts_with("cos_")) {  // "cos_theta_i"
        const auto of = direction_role(bare.substr(4));
        if (of == Role::theta_in) role = Role::mu_in;
        if (of == Role::theta_out) role = Role::mu_out;
    }
    for (const auto& [known, of_known] : kRoles) {
        if (known == bare) role = of_known;
    }
    if (role) {
        column.role = *role;
        column.radians = text.find("rad") != std::string::npos;
        return column;
    }
    if (sigma_of(name)) return {Role::sigma};
    for (const std::string_view word : {"brdf_cos", "brdfcos", "ccbrdf", "cosine_corrected_brdf"}) {
        if (bare != word) continue;
        column.role = Role::value;
        column.kind = MeasuredKind{Quantity::brdf, Geometry::directions};
        column.times_mu_out = true;
        return column;
    }
    column.kind = kind_of(bare);
    if (column.kind) column.role = Role::value;
    return column;
}

std::optional<std::string> sigma_of(std::string_view name) {
    static constexpr std::string_view kWords[] = {
        "sigma", "std", "stdev", "std_dev", "sd", "uncertainty", "standard_error", "error", "unc"};
    const std::string bare = bare_name(name);
    for (const std::string_view word : kWords) {
        if (bare == word) return std::string();
        const std::string end = "_" + std::string(word), start = std::string(word) + "_";
        if (bare.ends_with(end)) return bare.substr(0, bare.size() - end.size());
        if (bare.starts_with(start)) return bare.substr(start.size());
    }
    return std::nullopt;
}

}  // namespace miebrdf::measured
