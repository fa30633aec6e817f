#include "materials/index/units.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <miebrdf/error.h>
#include "materials/index/words.h"

namespace miebrdf::materials {
namespace {

constexpr std::array<std::pair<const char*, Unit>, 31> kSpellings{{
    {"nm", Unit::nanometre},
    {"nanometre", Unit::nanometre},
    {"nanometer", Unit::nanometre},
    {"nanometers", Unit::nanometre},
    {"nanometres", Unit::nanometre},
    {"um", Unit::micrometre},
    {"\xc2\xb5m", Unit::micrometre},
    {"\xb5m", Unit::micrometre},  // Latin-1
    {"\xce\xbcm", Unit::micrometre},
    {"micron", Unit::micrometre},
    {"microns", Unit::micrometre},
    {"micrometre", Unit::micrometre},
    {"micrometer", Unit::micrometre},
    {"micrometers", Unit::micrometre},
    {"micrometres", Unit::micrometre},
    {"a", Unit::angstrom},
    {"aa", Unit::angstrom},
    {"\xc3\x85", Unit::angstrom},
    {"\xe2\x84\xab", Unit::angstrom},
    {"ang", Unit::angstrom},
    {"angstrom", Unit::angstrom},
    {"angstroms", Unit::angstrom},
    {"ev", Unit::electronvolt},
    {"cm-1", Unit::per_centimetre},
    {"cm^-1", Unit::per_centimetre},
    {"1/cm", Unit::per_centimetre},
    {"wavenumber", Unit::per_centimetre},
    {"per_cm", Unit::per_centimetre},
    {"/cm", Unit::per_centimetre},
    {"thz", Unit::terahertz},
    {"terahertz", Unit::terahertz},
}};

}  // namespace

const char* name_of(Unit unit) {
    switch (unit) {
        case Unit::nanometre:
            return "nm";
        case Unit::micrometre:
            return "um";
        case Unit::angstrom:
            return "angstrom";
        case Unit::electronvolt:
            return "eV";
        case Unit::per_centimetre:
            return "cm-1";
        case Unit::terahertz:
            return "THz";
    }
    return "nm";
}

std::optional<Unit> parse_unit(std::string_view text) {
    const std::string asked = lower_case(text);
    for (const auto& [spelling, unit] : kSpellings) {
        if (asked == spelling) return unit;
    }
    if (without_blanks(text) == "\xc3\x85") return Unit::angstrom;
    return std::nullopt;
}

bool is_reciprocal(Unit unit) {
    return unit == Unit::electronvolt || unit == Unit::per_centimetre || unit == Unit::terahertz;
}

double to_nm(double value, Unit unit) {
    switch (unit) {
        case Unit::nanometre:
            return value;
        case Unit::micrometre:
            return value * 1000.0;
        case Unit::angstrom:
            return value / 10.0;
        case Unit::electronvolt:
            return kPlanckTimesLightEvNm / value;
        case Unit::per_centimetre:
            return 1e7 / value;
        case Unit::terahertz:
            return kLightNmThz / value;
    }
    return value;
}

double from_nm(double wavelength_nm, Unit unit) {
    if (unit == Unit::micrometre) return wavelength_nm / 1000.0;
    if (unit == Unit::angstrom) return wavelength_nm * 10.0;
    // nm stays as it is; reciprocal units have one formula for both ways.
    return to_nm(wavelength_nm, unit);
}

double from_nm_exactly(double wavelength_nm, Unit unit) {
    const double centre = from_nm(wavelength_nm, unit);
    double below = centre;
    double above = centre;
    for (int step = 0; step < 4; ++step) {
        if (to_nm(below, unit) == wavelength_nm) return below;
        if (to_nm(above, unit) == wavelength_nm) return above;
        below = std::nextafter(below, 0.0);
        above = std::nextafter(above, std::numeric_limits<double>::infinity());
    }
    return centre;
}

std::optional<double> parse_number(std::string_view text) {
    text = without_blanks(text);
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

double parse_wavelength_nm(std::string_view text, Unit without_unit) {
    const std::string_view asked = without_blanks(text);
    double value = 0;
    const auto [end, error] = std::from_chars(asked.data(), asked.data() + asked.size(), value);
    const std::string_view suffix =
        without_blanks(asked.substr(static_cast<std::size_t>(end - asked.data())));
    const std::optional<Unit> unit = suffix.empty() ? without_unit : parse_unit(suffix);
    if (error != std::errc() || !unit) {
        throw UsageError(fmt::format(
            "wavelength '{}': expected a number, alone or with nm, um, A, eV, cm-1 or THz", text));
    }
    const double wavelength_nm = to_nm(value, *unit);
    if (!(value > 0 && std::isfinite(value) && std::isfinite(wavelength_nm) && wavelength_nm > 0)) {
        throw UsageError(fmt::format("wavelength '{}' is not a positive finite number", text));
    }
    return wavelength_nm;
}

}  // namespace miebrdf::materials
