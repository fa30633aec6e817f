// Completes every list of measurements, whatever it was read from: options, checks, order.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <tuple>

#include "materials/readers/text.h"
#include "pipeline/measured/reader.h"

namespace miebrdf::measured {
namespace {

/// Reflectances of glossy or fluorescent samples, and factors near a mirror direction, exceed 1; of
/// shares none reaches twice the light, which is what values in percent do.
constexpr double kLargestShare = 2.0;
/// Below this no instrument for materials measures: micrometres were taken for nanometres.
constexpr double kLeastWavelengthNm = 30.0;
/// A step is called a gap when it is this many times both its neighbours.
constexpr double kGap = 3.5;

std::string place(const Measurements& list, const MeasuredValue& value) {
    return value.line > 0 ? fmt::format("{}:{}", list.file, value.line) : list.file;
}

[[noreturn]] void refuse_value(const Measurements& list, const MeasuredValue& value,
                               const std::string& reason) {
    throw materials::ImportError(list.file, value.line, reason);
}

void keep_column(Measurements& list, const std::string& column) {
    const auto same = [&](const std::string& name) {
        return materials::lower_case(name) == materials::lower_case(column);
    };
    const auto found = std::find_if(list.samples.begin(), list.samples.end(), same);
    if (found == list.samples.end()) {
        std::vector<std::string> names = list.samples;
        constexpr std::size_t kShown = 12;
        if (names.size() > kShown) {
            names.resize(kShown);
            names.emplace_back("...");
        }
        throw UsageError("column", column,
                         fmt::format("of {}: {}", list.file, fmt::join(names, ", ")));
    }
    const auto kept = static_cast<std::size_t>(found - list.samples.begin());
    std::erase_if(list.values, [&](const MeasuredValue& v) { return v.sample != kept; });
    for (MeasuredValue& value : list.values) value.sample = 0;
    list.samples = {*found};
}

void check_options(const MeasuredOptions& options) {
    const auto cosine = [](const char* name, const std::optional<double>& mu) {
        if (mu && !(*mu > 0.0 && *mu <= 1.0)) throw UsageError(name, *mu, "(0, 1]");
    };
    cosine("mu_in", options.mu_in);
    cosine("mu_out", options.mu_out);
    const auto positive = [](const char* name, const std::optional<double>& number) {
        if (number && !(*number > 0.0 && std::isfinite(*number)))
            throw UsageError(name, *number, "above 0");
    };
    positive("wavelength_nm", options.wavelength_nm);
    positive("sigma", options.sigma);
    positive("relative_sigma", options.relative_sigma);
}

void fill(double& number, const std::optional<double>& given) {
    if (std::isnan(number) && given) number = *given;
}

void fill_in(MeasuredValue& value, const MeasuredOptions& options) {
    if (!options.quantity.empty()) {
        const MeasuredKind kind = measured_kind(options.quantity);
        // "lab" is three quantities, which the file tells apart.
        if (kind.quantity != MeasuredQuantity::lab_l) value.quantity = kind.quantity;
        if (kind.geometry != MeasuredGeometry::unknown) value.geometry = kind.geometry;
    }
    fill(value.wavelength_nm, options.wavelength_nm);
    if (value.geometry == MeasuredGeometry::hemispherical) value.mu_in = MeasuredValue::kNone;
    if (value.geometry == MeasuredGeometry::d8_sci || value.geometry == MeasuredGeometry::d8_sce)
        value.mu_in = cosine_of(8.0);
    if (value.geometry == MeasuredGeometry::d45_0) {
        value.mu_in = cosine_of(45.0);
        value.mu_out = 1.0;
    }
    const bool takes_in = value.geometry != MeasuredGeometry::hemispherical;
    const bool takes_out = value.geometry == MeasuredGeometry::directions ||
                           value.geometry == MeasuredGeometry::hdrf ||
                           value.geometry == MeasuredGeometry::unknown;
    if (takes_in) fill(value.mu_in, options.mu_in);
    if (takes_out) fill(value.mu_out, options.mu_out);
    if (takes_out) fill(value.azimuth_deg, options.azimuth_deg);
    if (value.geometry == MeasuredGeometry::unknown && !std::isnan(value.mu_in)) {
        value.geometry =
            std::isnan(value.mu_out) ? MeasuredGeometry::directional : MeasuredGeometry::directions;
    }
    if (std::isnan(value.sigma) && (options.sigma || options.relative_sigma)) {
        value.sigma = std::hypot(options.sigma.value_or(0.0),
                                 options.relative_sigma.value_or(0.0) * value.value);
    }
}

void check_value(const Measurements& list, const MeasuredValue& value) {
    if (!std::isfinite(value.value)) refuse_value(list, value, "a value is not finite");
    if (!std::isnan(value.wavelength_nm) && !(value.wavelength_nm > 0.0)) {
        refuse_value(list, value,
                     fmt::format("wavelength {} nm; allowed: above 0", value.wavelength_nm));
    }
    if (!std::isnan(value.sigma) && !(value.sigma >= 0.0 && std::isfinite(value.sigma)))
        refuse_value(list, value, fmt::format("sigma {}; allowed: 0 or more", value.sigma));
    for (const double mu : {value.mu_in, value.mu_out}) {
        if (std::isnan(mu) || (mu > 0.0 && mu <= 1.0)) continue;
        refuse_value(
            list, value,
            fmt::format("a direction {:.4g} degrees from the normal (cosine {:.4g}); "
                        "allowed: less than 90",
                        std::acos(std::clamp(mu, -1.0, 1.0)) * 180.0 / std::numbers::pi, mu));
    }
    if (is_share(value.quantity) && value.value > kLargestShare &&
        value.geometry != MeasuredGeometry::directions) {
        refuse_value(list, value,
                     fmt::format("{} is {}; allowed: up to {}, a share of 1. Values in percent: "
                                 "say so with the option percent, or in the name of the column, "
                                 "as in 'reflectance (%)'",
                                 word_of(value.quantity), value.value, kLargestShare));
    }
}

/// How many values something is true of, said once with the first of them.
struct Doubtful {
    std::size_t count = 0;
    const MeasuredValue* first = nullptr;

    void add(const MeasuredValue& value) {
        if (count++ == 0) first = &value;
    }
    void say(Measurements& list, const std::string& what) const {
        if (count == 0) return;
        const std::string more = count == 1 ? "" : fmt::format(" ({} values in all)", count);
        list.doubts.push_back(fmt::format("{}: {}{}", place(list, *first), what, more));
    }
};

void doubt_values(Measurements& list) {
    Doubtful above, below, nowhere;
    for (const MeasuredValue& value : list.values) {
        const bool flux = value.quantity == MeasuredQuantity::reflectance ||
                          value.quantity == MeasuredQuantity::transmittance;
        if (flux && value.value > 1.0) above.add(value);
        if (value.value < 0.0 && value.quantity < MeasuredQuantity::lab_l) below.add(value);
        if (std::isnan(value.wavelength_nm) && value.quantity < MeasuredQuantity::lab_l)
            nowhere.add(value);
    }
    above.say(list,
              "a share above 1: no sample without fluorescence returns more than it gets; the "
              "calibration of the white standard may be off");
    below.say(list, "a negative value: the dark signal or the calibration may be off");
    nowhere.say(list, "no wavelength; give it with the option wavelength");
}

auto key_of(const MeasuredValue& v) {
    const auto comparable = [](double x) { return std::isnan(x) ? -1.0 : x; };
    return std::tuple(v.sample, v.quantity, v.geometry, comparable(v.wavelength_nm),
                      comparable(v.mu_in));
}

/// Same sample, quantity, geometry and wavelength twice: dropped where the values agree (a table
/// may repeat what does not depend on one of its columns), else refused.
void refuse_repeated(Measurements& list) {
    std::vector<MeasuredValue> kept;
    for (const MeasuredValue& value : list.values) {
        const bool many = value.geometry == MeasuredGeometry::directions ||
                          value.geometry == MeasuredGeometry::hdrf || !std::isnan(value.mu_out);
        if (kept.empty() || many || key_of(kept.back()) != key_of(value) ||
            std::isnan(value.wavelength_nm)) {
            kept.push_back(value);
            continue;
        }
        if (kept.back().value == value.value) continue;
        refuse_value(
            list, value,
            fmt::format("{} nm is there twice in '{}': {} (line {}) and {}; average them, or give "
                        "each measurement a column of its own",
                        value.wavelength_nm, list.samples[value.sample], kept.back().value,
                        kept.back().line, value.value));
    }
    list.values = std::move(kept);
}

void doubt_gaps(Measurements& list) {
    std::vector<double> nm;
    const auto flush = [&](const MeasuredValue& last) {
        std::vector<double> steps;
        for (std::size_t i = 1; i < nm.size(); ++i) steps.push_back(nm[i] - nm[i - 1]);
        for (std::size_t i = 0; i < steps.size() && steps.size() >= 4; ++i) {
            const double before = steps[i == 0 ? 1 : i - 1];
            const double after = steps[i + 1 == steps.size() ? i - 1 : i + 1];
            // Grids may become coarser: both neighbours of a gap are finer.
            if (!(steps[i] > kGap * std::max(before, after))) continue;
            list.doubts.push_back(fmt::format(
                "{}: '{}' has nothing between {:g} and {:g} nm, "
                "beside steps of {:.4g} nm",
                list.file, list.samples[last.sample], nm[i], nm[i + 1], std::max(before, after)));
            break;
        }
        nm.clear();
    };
    for (std::size_t i = 0; i < list.values.size(); ++i) {
        const MeasuredValue& value = list.values[i];
        const bool next = i > 0 && (value.sample != list.values[i - 1].sample ||
                                    value.quantity != list.values[i - 1].quantity);
        if (next) flush(list.values[i - 1]);
        if (std::isnan(value.wavelength_nm)) continue;
        if (nm.empty() || value.wavelength_nm > nm.back()) nm.push_back(value.wavelength_nm);
    }
    if (!list.values.empty()) flush(list.values.back());
}

std::string range_of(double low, double high) {
    return low == high ? fmt::format("{:g}", low) : fmt::format("{:g} to {:g}", low, high);
}

/// "reflectance d8-sci" -> "31 values, 400 to 700 nm, .04 to .9" for each kind that there is.
void describe(Measurements& list) {
    std::map<std::pair<MeasuredQuantity, MeasuredGeometry>, std::vector<const MeasuredValue*>> all;
    for (const MeasuredValue& v : list.values) all[{v.quantity, v.geometry}].push_back(&v);
    for (const auto& [kind, values] : all) {
        const auto range = [&values = values](double MeasuredValue::*member) -> std::string {
            double low = INFINITY, high = -INFINITY;
            for (const MeasuredValue* v : values) {
                if (std::isnan(v->*member)) continue;
                low = std::min(low, v->*member);
                high = std::max(high, v->*member);
            }
            return low > high ? "" : range_of(low, high);
        };
        std::string text = fmt::format("{} value{}", values.size(), values.size() == 1 ? "" : "s");
        for (const auto& [member, before, after] :
             {std::tuple(&MeasuredValue::wavelength_nm, "", " nm"),
              std::tuple(&MeasuredValue::mu_in, "mu_in ", ""),
              std::tuple(&MeasuredValue::mu_out, "mu_out ", ""),
              std::tuple(&MeasuredValue::azimuth_deg, "azimuth ", " degrees"),
              std::tuple(&MeasuredValue::value, "from ", "")}) {
            const std::string shown = range(member);
            if (!shown.empty()) text += fmt::format(", {}{}{}", before, shown, after);
        }
        const std::string geometry = word_of(kind.second);
        list.facts.emplace_back(
            fmt::format("{}, {}", word_of(kind.first),
                        geometry.empty() ? "the file does not say the geometry" : geometry),
            text);
    }
}

}  // namespace

double share_factor(Measurements& list, const MeasuredOptions& options, bool file_says_percent,
                    std::string_view where) {
    const bool percent = options.percent.value_or(file_says_percent);
    if (percent) {
        list.facts.emplace_back(
            "unit", options.percent ? "percent, as asked for" : fmt::format("percent ({})", where));
    }
    return percent ? 0.01 : 1.0;
}

void add_spectrum(Measurements& list, const std::string& sample, MeasuredKind kind, double mu_in,
                  std::span<const double> wavelength_nm, std::span<const double> values,
                  std::span<const int> lines) {
    const std::size_t index = list.samples.size();
    list.samples.push_back(sample);
    for (std::size_t i = 0; i < wavelength_nm.size(); ++i) {
        MeasuredValue value;
        value.quantity = kind.quantity;
        value.geometry = kind.geometry;
        value.wavelength_nm = wavelength_nm[i];
        value.mu_in = mu_in;
        value.value = values[i];
        value.sample = index;
        value.line = lines.empty() ? 0 : lines[i];
        list.values.push_back(value);
    }
}

void add_lab(Measurements& list, MeasuredGeometry geometry, const std::array<double, 3>& lab,
             int line) {
    using enum MeasuredQuantity;
    for (std::size_t c = 0; c < lab.size(); ++c) {
        MeasuredValue value;
        value.quantity = std::array{lab_l, lab_a, lab_b}[c];
        value.geometry = geometry;
        value.value = lab[c];
        value.sample = list.samples.size() - 1;
        value.line = line;
        list.values.push_back(value);
    }
}

void complete(Measurements& list, const MeasuredOptions& options) {
    check_options(options);
    if (!options.column.empty()) keep_column(list, options.column);
    if (list.values.empty()) throw materials::ImportError(list.file, 0, "has no values");
    double longest = 0.0;
    for (MeasuredValue& value : list.values) {
        fill_in(value, options);
        check_value(list, value);
        if (value.wavelength_nm > longest) longest = value.wavelength_nm;
    }
    if (longest > 0.0 && longest < kLeastWavelengthNm) {
        throw materials::ImportError(
            list.file, 0,
            fmt::format("wavelengths up to {:g} nm; are they micrometres? Name the column "
                        "wavelength_um",
                        longest));
    }
    const auto before = [](const MeasuredValue& a, const MeasuredValue& b) {
        return key_of(a) < key_of(b);
    };
    const auto order = [](const MeasuredValue& v) {
        const double nm = std::isnan(v.wavelength_nm) ? -1.0 : v.wavelength_nm;
        return std::tuple(v.sample, v.quantity, v.geometry, nm);
    };
    const auto in_file = [&](const MeasuredValue& a, const MeasuredValue& b) {
        return order(a) < order(b);
    };
    // Directions keep the order of the file; repeated values of spectra must be neighbours.
    const bool spectra = std::none_of(list.values.begin(), list.values.end(),
                                      [](const auto& v) { return !std::isnan(v.mu_out); });
    if (spectra)
        std::stable_sort(list.values.begin(), list.values.end(), before);
    else
        std::stable_sort(list.values.begin(), list.values.end(), in_file);
    refuse_repeated(list);
    doubt_values(list);
    doubt_gaps(list);
    describe(list);
}

}  // namespace miebrdf::measured
