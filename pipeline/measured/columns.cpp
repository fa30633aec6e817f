#include "pipeline/measured/columns.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/sheet.h"

namespace miebrdf::measured {
namespace {

using Quantity = MeasuredQuantity;
using Geometry = MeasuredGeometry;

constexpr std::pair<std::string_view, Role> kRoles[] = {
    {"theta_in", Role::theta_in},
    {"theta_i", Role::theta_in},
    {"thetain", Role::theta_in},
    {"thetai", Role::theta_in},
    {"theta_0", Role::theta_in},
    {"incidence", Role::theta_in},
    {"incidence_angle", Role::theta_in},
    {"incident_angle", Role::theta_in},
    {"angle_in", Role::theta_in},
    {"sun_zenith", Role::theta_in},
    {"sza", Role::theta_in},
    {"theta_out", Role::theta_out},
    {"theta_r", Role::theta_out},
    {"theta_s", Role::theta_out},
    {"theta_o", Role::theta_out},
    {"theta_v", Role::theta_out},
    {"thetaout", Role::theta_out},
    {"thetar", Role::theta_out},
    {"thetas", Role::theta_out},
    {"emission", Role::theta_out},
    {"emission_angle", Role::theta_out},
    {"viewing_angle", Role::theta_out},
    {"reflection_angle", Role::theta_out},
    {"scatter_angle", Role::theta_out},
    {"angle_out", Role::theta_out},
    {"view_zenith", Role::theta_out},
    {"vza", Role::theta_out},
    {"mu_in", Role::mu_in},
    {"mu_i", Role::mu_in},
    {"mu_0", Role::mu_in},
    {"mu0", Role::mu_in},
    {"mu_out", Role::mu_out},
    {"mu_r", Role::mu_out},
    {"mu", Role::mu_out},
    {"phi", Role::phi},
    {"azimuth", Role::phi},
    {"relative_azimuth", Role::phi},
    {"delta_phi", Role::phi},
    {"dphi", Role::phi},
    {"raa", Role::phi},
    {"phi_in", Role::phi_in},
    {"phi_i", Role::phi_in},
    {"phiin", Role::phi_in},
    {"phii", Role::phi_in},
    {"azimuth_in", Role::phi_in},
    {"phi_out", Role::phi_out},
    {"phi_r", Role::phi_out},
    {"phi_s", Role::phi_out},
    {"phi_o", Role::phi_out},
    {"phi_v", Role::phi_out},
    {"phiout", Role::phi_out},
    {"phir", Role::phi_out},
    {"azimuth_out", Role::phi_out},
    {"quantity", Role::quantity},
    {"geometry", Role::geometry},
    {"sample", Role::sample},
    {"sample_name", Role::sample},
    {"name", Role::sample},
    {"specimen", Role::sample},
    {"value", Role::value},
};

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
    {"m11", {Quantity::brdf, Geometry::directions}},
    {"l", {Quantity::lab_l, Geometry::unknown}},
    {"l*", {Quantity::lab_l, Geometry::unknown}},
    {"lab_l", {Quantity::lab_l, Geometry::unknown}},
    {"a*", {Quantity::lab_a, Geometry::unknown}},
    {"lab_a", {Quantity::lab_a, Geometry::unknown}},
    {"b*", {Quantity::lab_b, Geometry::unknown}},
    {"lab_b", {Quantity::lab_b, Geometry::unknown}},
};

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

ColumnRole column_role(std::string_view name) {
    ColumnRole column;
    const std::string bare = bare_name(name), text = materials::lower_case(name);
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
    for (const auto& [known, role] : kRoles) {
        if (known != bare) continue;
        column.role = role;
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
