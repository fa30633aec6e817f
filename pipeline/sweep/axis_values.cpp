#include "pipeline/sweep/axis_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "materials/database/names.h"
#include "materials/readers/text_table.h"
#include "pipeline/scene/number_list.h"

namespace miebrdf::sweep {
namespace {

constexpr double kLongestAxis = 1'000'000;

/// "50:1000:10" of "50:1000:10 log", with what follows it.
struct RangeText {
    std::string range, spacing;
};

RangeText split_spacing(const std::string& text) {
    const std::string whole = trimmed_text(text);
    const std::size_t blank = whole.find_first_of(" \t");
    if (blank == std::string::npos) return {whole, ""};
    return {whole.substr(0, blank), trimmed_text(whole.substr(blank))};
}

/// first, last, count.
std::array<double, 3> ends_and_count(const std::string& name, const RangeText& text) {
    const std::vector<std::string> parts = split_list(text.range, ':');
    if (parts.size() != 3) {
        throw UsageError(fmt::format(
            "axis {}: '{}' is not a range; write first:last:count {}, e.g. 50:1000:10 {}", name,
            text.range, text.spacing, text.spacing));
    }
    std::array<double, 3> ends{};
    for (std::size_t i = 0; i < 3; ++i) ends[i] = parse_number(parts[i], "axis " + name);
    const double count = ends[2];
    if (!(count >= 1 && count <= kLongestAxis && count == std::floor(count))) {
        throw UsageError(fmt::format("axis {}: {} is not a number of values; allowed: 1 to {}",
                                     name, count, kLongestAxis));
    }
    if (count == 1 && ends[0] != ends[1]) {
        throw UsageError(
            fmt::format("axis {}: one value cannot reach from {} to {}", name, ends[0], ends[1]));
    }
    return ends;
}

std::vector<double> counted_range(const std::string& name, const RangeText& text) {
    const auto [first, last, count] = ends_and_count(name, text);
    const bool is_log = text.spacing == "log";
    if (is_log && !(first > 0.0 && last > 0.0)) {
        throw UsageError(fmt::format("axis {}: '{} log' goes through numbers that are not positive",
                                     name, text.range));
    }
    std::vector<double> numbers;
    for (int i = 0; i < int(count); ++i) {
        const double t = count > 1 ? i / (count - 1) : 0.0;
        const double value =
            is_log ? first * std::pow(last / first, t) : first + t * (last - first);
        // People read twelve digits of these; the ends are as they were typed.
        numbers.push_back(i == 0                ? first
                          : i + 1 == int(count) ? last
                                                : std::stod(fmt::format("{:.12g}", value)));
    }
    return numbers;
}

/// Numbers where all are, else words; "15%" stays as it is put into a scene.
Axis axis_of_texts(const std::string& name, const std::vector<std::string>& texts) {
    std::vector<double> numbers;
    for (const std::string& text : texts) {
        const auto number = materials::table_number(text);
        if (!number || text.ends_with('%')) return {.name = name, .words = texts, .unit = ""};
        numbers.push_back(*number);
    }
    return axis_of(name, numbers);
}

}  // namespace

std::string unit_in(const std::string& name) {
    static constexpr std::array<std::pair<const char*, const char*>, 9> kEndings = {
        {{"_kg_m3", "kg m-3"},
         {"_kg_m2", "kg m-2"},
         {"_deg", "degree"},
         {"_um", "um"},
         {"_nm", "nm"},
         {"_mm", "mm"},
         {"_cm", "cm"},
         {"_ppb", "1e-9"},
         {"_ppm", "1e-6"}}};
    for (const auto& [ending, unit] : kEndings) {
        const std::string_view end(ending);
        if (name.size() > end.size() && name.ends_with(end)) return unit;
    }
    return "";
}

std::string quotient_of_units(const std::string& unit, const std::string& by) {
    std::string quotient = unit == "1" ? "" : unit;
    // Products of units with whole exponents, such as "kg m-2", are turned part by part.
    const bool is_product = by.find_first_of("/*^.()%") == std::string::npos;
    for (const std::string& part : is_product ? split_list(by, ' ') : std::vector{by}) {
        if (part.empty() || part == "1") continue;
        const std::size_t sign = part.find('-', 1), digit = part.find_last_not_of("0123456789");
        std::string inverse = is_product ? part + "-1" : "(" + part + ")-1";
        if (is_product && part.starts_with("1e-")) {
            inverse = "1e" + part.substr(3);
        } else if (is_product && sign != std::string::npos) {
            const std::string power = part.substr(sign + 1);
            inverse = part.substr(0, sign) + (power == "1" ? "" : power);
        } else if (is_product && digit + 1 < part.size()) {
            inverse = part.substr(0, digit + 1) + "-" + part.substr(digit + 1);
        }
        quotient += (quotient.empty() ? "" : " ") + inverse;
    }
    return quotient.empty() ? "1" : quotient;
}

Axis axis_of(const std::string& name, std::vector<double> numbers) {
    Axis axis{.name = name, .words = {}, .numbers = std::move(numbers), .unit = unit_in(name)};
    for (const double number : axis.numbers) {
        if (!std::isfinite(number))
            throw UsageError(fmt::format("axis {}: {} is not a finite number", name, number));
        axis.words.push_back(fmt::format("{}", number));
    }
    return axis;
}

Axis parse_axis(const std::string& name, const std::string& text) {
    const RangeText parts = split_spacing(text);
    if (parts.spacing == "log" || parts.spacing == "linear") {
        Axis axis = axis_of(name, counted_range(name, parts));
        axis.is_logarithmic = parts.spacing == "log";
        return axis;
    }
    if (!parts.spacing.empty() && text.find(',') == std::string::npos) {
        throw UsageError(fmt::format(
            "axis {}: '{}' is not a spacing; allowed: log, linear, both after first:last:count",
            name, parts.spacing));
    }
    try {
        return axis_of(name, name == "wavelength_nm" ? parse_wavelengths_nm(text)
                                                     : parse_number_list(text, "axis " + name));
    } catch (const UsageError& error) {
        if (text.find(':') != std::string::npos) {
            throw UsageError(fmt::format(
                "{}; for a number of values in place of a step add the spacing: \"0:0.3:7 linear\"",
                error.what()));
        }
        if (name == "wavelength_nm") throw;
        throw UsageError(
            fmt::format("{}; texts are written as a list, [\"TiO2\", \"ZnO\"]", error.what()));
    }
}

std::vector<Axis> read_columns(const std::string& file, const std::vector<std::string>& columns) {
    const std::string text = materials::text_of(materials::read_bytes(file), file);
    materials::TextTable lines(text, file);
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> names;
    while (lines.next()) {
        if (names.empty()) {
            lines.take_names();
            names = lines.fields();
            continue;
        }
        if (lines.fields().size() != names.size()) {
            lines.refuse(
                fmt::format("{} fields under {} names", lines.fields().size(), names.size()));
        }
        rows.push_back(lines.fields());
    }
    if (rows.empty()) {
        lines.refuse("has no samples; a line of names comes first, then one for each sample");
    }
    std::vector<Axis> axes;
    for (const std::string& wanted : columns.empty() ? names : columns) {
        const auto found = std::find(names.begin(), names.end(), wanted);
        if (found == names.end()) {
            throw UsageError(fmt::format("'{}' has no column '{}'; it has: {}", file, wanted,
                                         fmt::join(names, ", ")));
        }
        std::vector<std::string> texts;
        texts.reserve(rows.size());
        for (const auto& row : rows) texts.push_back(row[std::size_t(found - names.begin())]);
        axes.push_back(axis_of_texts(wanted, texts));
    }
    return axes;
}

void require_monotonic(const Axis& axis) {
    const std::vector<double>& x = axis.numbers;
    for (std::size_t i = 1; i < x.size(); ++i) {
        if ((x[i] > x[i - 1]) == (x[1] > x[0]) && x[i] != x[i - 1]) continue;
        throw UsageError(fmt::format("axis {}: {} follows {}; values must ascend or descend",
                                     axis.name, x[i], x[i - 1]));
    }
    for (std::size_t i = 0; axis.is_text() && i < axis.words.size(); ++i) {
        if (std::count(axis.words.begin(), axis.words.end(), axis.words[i]) == 1) continue;
        throw UsageError(fmt::format("axis {}: '{}' is there twice", axis.name, axis.words[i]));
    }
}

}  // namespace miebrdf::sweep
