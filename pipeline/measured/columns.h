// What names mean: of columns, of units of ordinates, of types of measurement. Every reader asks
// here for the quantity, how its numbers become shares of 1, and whether any can be made of them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <miebrdf/index.h>
#include <miebrdf/measured.h>

namespace miebrdf::measured {

/// How a number becomes a share of 1.
enum class Conversion {
    none,
    absorbance,          ///< 10^-A
    natural_absorbance,  ///< e^-A
    kubelka_munk,        ///< F = (1 - R)^2 / 2R of a sample without end
};
double converted(double number, Conversion conversion);
/// The derivative of converted().
double conversion_slope(double number, Conversion conversion);
/// "absorbance A, read as transmittance 10^-A"; empty for none.
std::string words_of(Conversion conversion, MeasuredQuantity quantity);

struct ValueMeaning {
    MeasuredKind kind;
    Conversion conversion = Conversion::none;
    /// What it is of which no share of the light can be made: "radiance". Empty: it is read.
    std::string refused = {};
};
/// What values of this name are: "R", "%T", "Absorbance (AU)", "log(1/R)", "Reflectance factor of
/// the panel". Nothing: the name does not say.
std::optional<ValueMeaning> value_meaning(std::string_view name);
/// The sentence that refuses them.
std::string refusal_of(std::string_view name, const std::string& what);

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
    refused,  ///< no share of the light can be made of it
};

/// The role of a column, as its name says it.
struct ColumnRole {
    Role role = Role::other;
    std::optional<materials::Unit> unit = {};  ///< of wavelengths; nothing: it does not say
    std::optional<MeasuredKind> kind = {};     ///< of values; nothing: "value"
    Conversion conversion = Conversion::none;  ///< of values
    std::string refused = {};                  ///< as in ValueMeaning
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
