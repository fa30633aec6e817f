#include "pipeline/measured/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "materials/index/units.h"
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
    {"albedo", {Quantity::reflectance, Geometry::unknown}},
    {"r_total", {Quantity::reflectance, Geometry::unknown}},
    {"t", {Quantity::transmittance, Geometry::unknown}},
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
    return find_kind(bare);
}

/// Words of which no share of the light can be made; "=" before those that are whole words, "=="
/// before those that are whole names ("lamp black" is a pigment).
constexpr std::pair<std::string_view, std::string_view> kRefused[] = {
    {"absorptance", "the share that is absorbed"},
    {"absorptivity", "an absorption coefficient"},
    {"absorption", "absorption"},
    {"coefficient", "a coefficient"},
    {"=mua", "an absorption coefficient"},
    {"=mu a", "an absorption coefficient"},
    {"=mus", "a scattering coefficient"},
    {"=musp", "a scattering coefficient"},
    {"=mu s", "a scattering coefficient"},
    {"single scattering", "a single-scattering albedo"},
    {"scattering", "scattering"},
    {"asymmetry", "an asymmetry parameter"},
    {"anisotropy", "an asymmetry parameter"},
    {"==g", "an asymmetry parameter"},
    {"phase function", "a phase function"},
    {"emissi", "emission"},
    {"emittance", "emission"},
    {"irrad", "irradiance"},
    {"radian", "radiance"},
    {"=rad", "radiance"},
    {"exitance", "light of a source"},
    {"luminance", "luminance"},
    {"illumina", "light of a source"},
    {"==lamp", "light of a source"},
    {"==light", "light of a source"},
    {"==light source", "light of a source"},
    {"=flux", "light of a source"},
    {"==power", "light of a source"},
    {"extinction", "extinction"},
    {"attenuation", "extinction"},
    {"=dn", "numbers of a detector"},
    {"digital n", "numbers of a detector"},
    {"counts", "numbers of a detector"},
    {"=count", "numbers of a detector"},
    {"==scope", "numbers of a detector"},
    {"=chan", "numbers of channels"},
    {"channel", "numbers of channels"},
    {"=pixel", "numbers of channels"},
    {"==dark", "numbers of a detector"},
    {"==signal", "numbers of a detector"},
    {"intensity", "numbers of a detector"},
    {"voltage", "numbers of a detector"},
    {"responsivity", "a responsivity"},
    {"quantum", "an efficiency"},
    {"efficiency", "an efficiency"},
    {"=eqe", "an efficiency"},
    {"==qe", "an efficiency"},
    {"==haze", "haze"},
    {"==gloss", "gloss"},
    {"==kappa", "part of a refractive index"},
    {"==k", "part of a refractive index"},
    {"==n", "part of a refractive index, or a number of measurements"},
    {"refractive", "part of a refractive index"},
    {"fluorescence", "emission"},
    {"photoluminescence", "emission"},
    {"raman", "Raman scattering"},
    {"temperature", "a temperature"},
};

/// A unit in brackets, "Signal (mV)", "mu_s' [1/mm]", "E (W/m2)", which no share of the light has;
/// empty where there is none. Single letters and numbers, "film (2 mm)", may tell samples apart.
std::string unit_in(std::string_view name) {
    static constexpr std::string_view kUnits[] = {
        "w",  "mw", "uw",  "\xc2\xb5w", "v",  "mv",  "a",         "ma",     "cd",
        "lm", "lx", "lux", "k",         "j",  "mj",  "s",         "ms",     "m",
        "cm", "mm", "um",  "nm",        "m2", "cm2", "mm2",       "sr",     "g",
        "kg", "l",  "mol", "hz",        "ev", "db",  "\xc2\xb5m", "counts", "photons"};
    const std::size_t open = name.find_first_of("([{");
    const std::size_t close = std::min(name.find_first_of(")]}"), name.size());
    if (open == std::string_view::npos || close <= open + 1) return {};
    const std::string inside = materials::lower_case(name.substr(open + 1, close - open - 1));
    if (inside.front() >= '0' && inside.front() <= '9' && !inside.starts_with("1/")) return {};
    std::size_t known = 0, steradians = 0, longest = 0;
    std::string between = inside;
    std::replace_if(
        between.begin(), between.end(),
        [](char c) { return c == '/' || c == '*' || c == '^' || c == '-' || c == '.'; }, ' ');
    for (const std::string_view word : materials::split_words(between, " ")) {
        if (materials::parse_number(word)) continue;
        if (std::find(std::begin(kUnits), std::end(kUnits), word) == std::end(kUnits)) return {};
        ++known;
        steradians += word == "sr";
        longest = std::max(longest, word.size());
    }
    const bool is_fraction = inside.find('/') != std::string::npos || known > 1 ||
                             inside.find("-1") != std::string::npos;
    return known > steradians && (is_fraction || longest > 1) ? inside : std::string();
}

/// The words of a name outside brackets, in lower case: "Norm. DN (Ref.)" -> " norm dn ".
std::string plain_words(std::string_view name) {
    std::string words = " ";
    int depth = 0;
    for (const char c : materials::lower_case(name)) {
        if (c == '(' || c == '[' || c == '{') ++depth;
        const bool is_letter = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (depth == 0 && is_letter) words += c;
        if (!is_letter && words.back() != ' ') words += ' ';
        if (c == ')' || c == ']' || c == '}') depth = std::max(0, depth - 1);
    }
    return words.back() == ' ' ? words : words + ' ';
}

/// Whether a word begins so; "=word" asks for the whole word, "==word" for the whole name.
bool has_word(const std::string& words, std::string_view asked) {
    if (asked.starts_with("==")) return words == fmt::format(" {} ", asked.substr(2));
    const bool whole = asked.starts_with('=');
    const std::string text = " " + std::string(asked.substr(whole ? 1 : 0)) + (whole ? " " : "");
    return words.find(text) != std::string::npos;
}

/// Logarithms of shares and Kubelka and Munk's function, in the spellings of spectrometers.
std::optional<ValueMeaning> converted_meaning(std::string_view name, const std::string& words) {
    std::string text = materials::lower_case(name);
    std::erase_if(text, [](char c) { return c == ' ' || c == '_' || c == '{' || c == '}'; });
    const auto has = [&](std::string_view part) { return text.find(part) != std::string::npos; };
    const ValueMeaning reflected{{Quantity::reflectance, Geometry::unknown},
                                 Conversion::absorbance},
        transmitted{{Quantity::transmittance, Geometry::unknown}, Conversion::absorbance};
    if (has("tgt./ref.")) return ValueMeaning{reflected.kind};  // Spectral Evolution
    if (has("kubelka") || text == "f(r)" || text == "km" || text == "k-m" || text == "kmunits")
        return ValueMeaning{reflected.kind, Conversion::kubelka_munk};
    if (text.starts_with("k/s"))
        return ValueMeaning{{}, Conversion::none, "a ratio of absorption to scattering"};
    const bool may_be_logarithm = has("log") || has("ln");
    for (const auto& [log, conversion] :
         {std::pair("log", Conversion::absorbance), std::pair("log10", Conversion::absorbance),
          std::pair("ln", Conversion::natural_absorbance)}) {
        if (!may_be_logarithm) break;
        for (const auto& [letter, meaning] :
             {std::pair('r', reflected), std::pair('t', transmitted)}) {
            for (const char* form : {"{}(1/{})", "{}1/{}", "-{}({})", "-{}{}"}) {
                if (!text.starts_with(fmt::format(fmt::runtime(form), log, letter))) continue;
                return ValueMeaning{meaning.kind, conversion};
            }
        }
    }
    const bool absorbance = has_word(words, "absorbanc") || has_word(words, "absorbanz") ||
                            has_word(words, "extinktion") || has_word(words, "=abs") ||
                            has_word(words, "=od") || has_word(words, "optical density") ||
                            words == " a ";
    if (!absorbance) return std::nullopt;
    const bool of_reflected = has_word(words, "reflect") || has_word(words, "apparent") ||
                              has_word(words, "pseudo") || has("(r)");
    return of_reflected ? reflected : transmitted;
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
    if (role == Role::sample && !unit_in(name).empty()) {  // Avantes: "Sample [counts]"
        column.role = Role::refused;
        column.refused = "numbers of a detector";
        return column;
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
    const auto meaning = value_meaning(name);
    if (!meaning) return column;
    column.role = meaning->refused.empty() ? Role::value : Role::refused;
    column.refused = meaning->refused;
    column.conversion = meaning->conversion;
    if (meaning->refused.empty()) column.kind = meaning->kind;
    return column;
}

std::optional<ValueMeaning> value_meaning(std::string_view given) {
    const std::string name = in_english(given), bare = bare_name(name), words = plain_words(name);
    if (bare == "t" && name.find_first_of("CK") != std::string::npos)
        return ValueMeaning{{}, Conversion::none, "a temperature"};  // "T (K)"
    if (const auto kind = kind_of(bare)) return ValueMeaning{*kind};
    if (auto meaning = converted_meaning(name, words)) return meaning;
    const bool is_factor = has_word(words, "radiance factor") || has_word(words, "reflectance fac");
    for (const auto& [word, what] : kRefused) {
        if (!is_factor && has_word(words, word))
            return ValueMeaning{{}, Conversion::none, std::string(what)};
    }
    if (const std::string unit = unit_in(name); !unit.empty())
        return ValueMeaning{{}, Conversion::none, fmt::format("a quantity in {}", unit)};
    const NamedGeometry geometry = geometry_in(name);
    if (has_word(words, "transmi") || has_word(words, "=trans"))
        return ValueMeaning{{Quantity::transmittance, Geometry::unknown}};
    if (has_word(words, "=brdf") || has_word(words, "bidirectional reflectance dist"))
        return ValueMeaning{{Quantity::brdf, Geometry::directions}};
    if (geometry.geometry == Geometry::directions && is_factor)
        return ValueMeaning{{Quantity::reflectance_factor, Geometry::directions}};
    const auto of_reflection = [&](std::string_view word) { return has_word(words, word); };
    if (is_factor || of_reflection("reflect") || of_reflection("=refl") ||
        of_reflection("remission"))
        return ValueMeaning{{Quantity::reflectance, geometry.geometry}};
    return std::nullopt;
}

double converted(double number, Conversion conversion) {
    switch (conversion) {
        case Conversion::none:
            return number;
        case Conversion::absorbance:
            return std::pow(10.0, -number);
        case Conversion::natural_absorbance:
            return std::exp(-number);
        case Conversion::kubelka_munk:
            break;
    }
    // R = 1 + F - sqrt(F^2 + 2F), written without the difference.
    return 1.0 / (1.0 + number + std::sqrt(number * number + 2.0 * number));
}

double conversion_slope(double number, Conversion conversion) {
    const double value = converted(number, conversion);
    switch (conversion) {
        case Conversion::none:
            return 1.0;
        case Conversion::absorbance:
            return -std::numbers::ln10 * value;
        case Conversion::natural_absorbance:
            return -value;
        case Conversion::kubelka_munk:
            break;
    }
    return -value / std::sqrt(number * number + 2.0 * number);
}

std::string words_of(Conversion conversion, MeasuredQuantity quantity) {
    const std::string of = word_of(quantity);
    switch (conversion) {
        case Conversion::none:
            return "";
        case Conversion::absorbance:
            return fmt::format("absorbance A, read as {} 10^-A", of);
        case Conversion::natural_absorbance:
            return fmt::format("natural absorbance A, read as {} e^-A", of);
        case Conversion::kubelka_munk:
            break;
    }
    return "Kubelka and Munk's F, read as reflectance 1 + F - sqrt(F^2 + 2F) of a sample without "
           "end";
}

std::string refusal_of(std::string_view name, const std::string& what) {
    return fmt::format(
        "'{}' is {}: no reflectance or transmittance can be made of it. Export reflectance, "
        "transmittance or absorbance; if the name is wrong, say what the values are with the "
        "option quantity",
        name, what);
}

std::optional<std::string> sigma_of(std::string_view name) {
    static constexpr std::string_view kWords[] = {
        "sigma", "std", "stdev",       "std_dev",        "stddev", "standard_deviation",
        "sd",    "se",  "uncertainty", "standard_error", "error",  "unc",
        "err",   "sem"};
    const std::string bare = bare_name(name), whole = materials::lower_case(name);
    for (const std::string_view word : kWords) {
        if (bare == word) return std::string();
        // "log(1/R)_std": brackets that are part of the name.
        for (const char before : {'_', ' '}) {
            const std::string after = before + std::string(word);
            if (whole.ends_with(after))
                return bare_name(name.substr(0, name.size() - after.size()));
        }
        const std::string end = "_" + std::string(word), start = std::string(word) + "_";
        if (bare.ends_with(end)) return bare.substr(0, bare.size() - end.size());
        if (bare.starts_with(start)) return bare.substr(start.size());
    }
    return std::nullopt;
}

}  // namespace miebrdf::measured
