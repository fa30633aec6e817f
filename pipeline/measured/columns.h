// Names of the columns of tables, and what these hold.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <miebrdf/index.h>
#include <miebrdf/measured.h>

namespace miebrdf::measured {

enum class Role {
    other,
    wavelength,
    theta_in,
    theta_out,
    mu_in,
    mu_out,
    azimuth_deg,  ///< ours: 0 = mirror side
    phi,          ///< relative azimuth of an unknown zero
    phi_in,
    phi_out,
    quantity,  ///< a word in each row, like the next two
    geometry,
    sample,
    sigma,
    value,
};

/// The role of a column, as its name says it.
struct ColumnRole {
    Role role = Role::other;
    std::optional<materials::Unit> unit = {};  ///< of wavelengths; nothing: it does not say
    std::optional<MeasuredKind> kind = {};     ///< of values; nothing: "value"
    bool radians = false;                      ///< of angles
    bool times_mu_out = false;                 ///< BRDF times the cosine of reflection

    /// Where a value belongs: a line of names has one of these.
    bool is_axis() const { return role >= Role::wavelength && role <= Role::phi_out; }
};
ColumnRole column_role(std::string_view name);

/// The value whose standard error a column holds: "reflectance_sigma", "std(R)" -> the other name;
/// empty for "sigma" alone. Nothing: it is no standard error.
std::optional<std::string> sigma_of(std::string_view name);

}  // namespace miebrdf::measured
