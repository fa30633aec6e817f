// Completes every list of measurements, whatever it was read from: options, checks, order.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
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

bool is_lab(MeasuredQuantity quantity) { return quantity >= MeasuredQuantity::lab_l; }

/// Texts of files reach terminals: control characters become blanks.
void make_printable(Measurements& list) {
    const auto clean = [](std::string& text) {
        text = materials::printable(materials::as_utf8(text));
    };
    for (std::string& name : list.samples) clean(name);
    for (std::string& doubt : list.doubts) clean(doubt);
    for (auto& [name, text] : list.facts) {
        clean(name);
        clean(text);
    }
}

/// Samples of one name stay apart: "P1", "P1 (2)".
void name_samples_apart(Measurements& list) {
    std::map<std::string, int> seen;
    std::size_t renamed = 0;
    std::string example;
    for (const std::string& name : list.samples) seen.emplace(name, 0);
    for (std::string& name : list.samples) {
        if (seen[name]++ == 0) continue;
        std::string other;
        int& number = seen[name];
        do {
            other = fmt::format("{} ({})", name, number++);
        } while (seen.count(other) != 0);
        --number;
        seen[other] = 1;
        if (renamed++ == 0) example = fmt::format("'{}' is '{}'", name, other);
        name = other;
    }
    if (renamed == 0) return;
    list.doubts.push_back(fmt::format("{}: {} sample{} with the name of another: the second {}",
                                      list.file, renamed, renamed > 1 ? "s" : "", example));
}

/// Of several kinds in a file the one asked for is kept; of one kind the words may say otherwise.
/// @throws UsageError  where none fits
void choose_quantity(Measurements& list, const MeasuredOptions& options) {
    if (options.quantity.empty()) return;
    const MeasuredKind asked = measured_kind(options.quantity);
    const bool asks_lab = is_lab(asked.quantity);
    std::set<std::pair<MeasuredQuantity, MeasuredGeometry>> kinds;
    for (const MeasuredValue& v : list.values)
        kinds.emplace(is_lab(v.quantity) ? MeasuredQuantity::lab_l : v.quantity, v.geometry);
    const auto lab = std::count_if(kinds.begin(), kinds.end(),
                                   [](const auto& kind) { return is_lab(kind.first); });
    if (asks_lab ? lab == 0 : std::size_t(lab) == kinds.size()) {
        std::string there;
        for (const auto& [quantity, geometry] : kinds)
            there += (there.empty() ? "" : ", ") +
                     std::string(is_lab(quantity) ? "lab" : word_of(quantity));
        throw UsageError("quantity", options.quantity, fmt::format("{} has: {}", list.file, there));
    }
    const auto keep = [&](auto is_kept) {
        std::erase_if(list.values, [&](const MeasuredValue& v) { return !is_kept(v); });
    };
    if (lab > 0) {
        keep([&](const MeasuredValue& v) { return is_lab(v.quantity) == asks_lab; });
        std::erase_if(kinds, [&](const auto& kind) { return is_lab(kind.first) != asks_lab; });
    }
    if (asks_lab || kinds.size() == 1) return;
    const auto has = [&](auto is) { return std::any_of(kinds.begin(), kinds.end(), is); };
    const auto same = [&](const auto& kind) {
        return kind.first == asked.quantity &&
               (asked.geometry == MeasuredGeometry::unknown || kind.second == asked.geometry);
    };
    const auto of_quantity = [&](const auto& kind) { return kind.first == asked.quantity; };
    if (has(same))
        keep([&](const MeasuredValue& v) { return same(std::pair(v.quantity, v.geometry)); });
    else if (has(of_quantity))
        keep([&](const MeasuredValue& v) { return v.quantity == asked.quantity; });
    else
        throw UsageError(fmt::format(
            "quantity '{}': {} has several quantities, and none of them is it; name a column",
            options.quantity, list.file));
}

/// Leaves out what has no value, and says how much.
void drop_missing(Measurements& list) {
    const MeasuredValue* first = nullptr;
    std::size_t count = 0;
    for (const MeasuredValue& v : list.values) {
        if (!std::isnan(v.value)) continue;
        if (count++ == 0) first = &v;
    }
    if (count == 0) return;
    if (count == list.values.size()) refuse_value(list, *first, "no number");
    list.doubts.push_back(fmt::format("{}: no number; left out{}", place(list, *first),
                                      count > 1 ? fmt::format(" ({} in all)", count) : ""));
    std::erase_if(list.values, [](const MeasuredValue& v) { return std::isnan(v.value); });
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

void fill(double& number, const std::optional<double>& given) {
    if (std::isnan(number) && given) number = *given;
}

void fill_in(MeasuredValue& value, const MeasuredOptions& options) {
    if (!options.quantity.empty()) {
        const MeasuredKind kind = measured_kind(options.quantity);
        // "lab" is three quantities, which the file tells apart.
        if (!is_lab(kind.quantity)) value.quantity = kind.quantity;
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
    if (!std::isnan(value.wavelength_nm) &&
        !(value.wavelength_nm > 0.0 && std::isfinite(value.wavelength_nm))) {
        refuse_value(
            list, value,
            fmt::format("wavelength {} nm; allowed: finite and above 0", value.wavelength_nm));
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
}

bool is_limited(const MeasuredValue& v) {
    return is_share(v.quantity) && v.geometry != MeasuredGeometry::directions;
}
/// A share that no sample has: noise of a detector, or percent.
bool is_wild(const MeasuredValue& v) { return is_limited(v) && std::abs(v.value) > kLargestShare; }

bool is_in_percent(const Measurements& list) {
    return std::any_of(list.facts.begin(), list.facts.end(), [](const auto& fact) {
        return fact.first == "unit" && fact.second.starts_with("percent");
    });
}

[[noreturn]] void refuse_percent(const Measurements& list, const MeasuredValue& value) {
    refuse_value(
        list, value,
        fmt::format(
            "{} is {}; allowed: up to {}, a share of 1. {}", word_of(value.quantity), value.value,
            kLargestShare,
            is_in_percent(list)
                ? "Glossy samples beside a white panel exceed it: give the option quantity as "
                  "reflection"
                : "Values in percent: say so with the option percent, or in the name of "
                  "the column, as in 'reflectance (%)'"));
}

/// Values that no sample has are left out where they are noise, and refused where they are percent:
/// of a spectrum in percent the middle value is too large, or the large ones follow each other
/// smoothly. @param list  sorted: each spectrum in one piece
void drop_wild(Measurements& list) {
    constexpr double kSmooth = 0.25;  // of a value: noise differs by more from the value beside it
    const std::vector<MeasuredValue>& all = list.values;
    std::size_t count = 0, first = 0;
    for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
        std::vector<double> shares;
        std::size_t wild = 0, smooth = 0, first_large = all.size();
        for (end = begin; end < all.size() && all[end].sample == all[begin].sample &&
                          all[end].quantity == all[begin].quantity;
             ++end) {
            const MeasuredValue& v = all[end];
            if (!is_limited(v)) continue;
            shares.push_back(v.value);
            if (!is_wild(v)) continue;
            if (count + wild == 0) first = end;
            ++wild;
            if (v.value > 0.0) first_large = std::min(first_large, end);
            const auto near = [&](std::size_t i) {
                return std::abs(all[i].value - v.value) <= kSmooth * std::abs(v.value);
            };
            if ((end > begin && near(end - 1)) ||
                (end + 1 < all.size() && all[end + 1].sample == v.sample && near(end + 1)))
                ++smooth;
        }
        if (wild == 0) continue;
        const auto middle = shares.begin() + std::ptrdiff_t(shares.size() / 2);
        std::nth_element(shares.begin(), middle, shares.end());
        const bool percent = *middle > 1.0 || 2 * smooth > wild;
        if (percent || wild == shares.size())
            refuse_percent(list, all[first_large < all.size() ? first_large : begin]);
        count += wild;
    }
    if (count == 0) return;
    list.doubts.push_back(
        fmt::format("{}: {} is {}, beyond {}: noise; left out ({} value{} in all)",
                    place(list, all[first]), word_of(all[first].quantity), all[first].value,
                    kLargestShare, count, count > 1 ? "s" : ""));
    std::erase_if(list.values, is_wild);
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
    // "(%)" above shares is the most frequent slip of tables.
    constexpr double kPercentOfShares = 0.0101;
    double largest = 0.0;
    const MeasuredValue* share = nullptr;
    for (const MeasuredValue& value : list.values) {
        if (!is_share(value.quantity)) continue;
        if (share == nullptr) share = &value;
        largest = std::max(largest, value.value);
    }
    const bool in_percent = std::any_of(list.facts.begin(), list.facts.end(), [](const auto& fact) {
        return fact.first == "unit" && fact.second.starts_with("percent (");
    });
    if (in_percent && share != nullptr && largest > 0.0 && largest <= kPercentOfShares) {
        list.doubts.push_back(
            fmt::format("{}: no value is above {:.4g} %: if these are shares of 1, say that they "
                        "are no percent",
                        place(list, *share), 100.0 * largest));
    }
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

void check(const MeasuredOptions& options) {
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
    check(options);
    materials::ReadingBudget::require_values(list.values.size(), list.file);
    make_printable(list);
    name_samples_apart(list);
    if (!options.column.empty()) keep_column(list, options.column);
    if (list.values.empty()) throw materials::ImportError(list.file, 0, "has no values");
    choose_quantity(list, options);
    drop_missing(list);
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
    drop_wild(list);
    doubt_values(list);
    doubt_gaps(list);
    describe(list);
}

}  // namespace miebrdf::measured
