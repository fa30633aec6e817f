#include "pipeline/scene/number_list.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include <miebrdf/error.h>
#include "materials/index/units.h"
#include "materials/index/words.h"

namespace miebrdf {

namespace {

using materials::without_blanks;

constexpr std::size_t kLongestList = 1'000'000;  // beyond this it is a typing mistake

using Parse = std::function<double(std::string_view)>;

std::vector<std::string> split_range(std::string_view part, const std::string& what) {
    std::vector<std::string> ends = split_list(part, ':');
    if (ends.size() != 3) {
        throw UsageError(fmt::format(
            "{}: '{}' is not a range; write first:last:step, e.g. 400:700:10", what, part));
    }
    return ends;
}

/// 0.3 for 0.1 + 2 * 0.1 = 0.30000000000000004: people write steps in decimals.
double as_written(double value) { return std::stod(fmt::format("{:.14g}", value)); }

/// The numbers of `first:last:step`, the ends read by `parse`.
void append_range(std::string_view part, const std::string& what, const Parse& parse,
                  std::vector<double>& numbers) {
    const std::vector<std::string> ends = split_range(part, what);
    const double first = parse(ends[0]);
    const double last = parse(ends[1]);
    const double step = parse_number(ends[2], what + ", step");
    if (!(step * (last - first) > 0.0 || (first == last && step != 0.0))) {
        throw UsageError(
            fmt::format("{}: a step of {} does not lead from {} to {}", what, step, first, last));
    }
    if (!(std::abs(step) <= std::abs(last - first) * (1.0 + 1e-9)) && first != last) {
        throw UsageError(
            fmt::format("{0}: a step of {1} is longer than the way from {2} to {3}: {2} would be "
                        "the only number; write first:last:step, e.g. {2}:{3}:{4:.3g}",
                        what, step, first, last, 0.1 * (last - first)));
    }
    // The end belongs to the list although first + i step meets it only within rounding.
    const double steps = std::floor((last - first) / step * (1.0 + 1e-12) + 1e-9);
    if (!(steps + 1.0 + static_cast<double>(numbers.size()) <= kLongestList)) {
        throw UsageError(fmt::format("{}: '{}' has {:.0f} numbers; at most {} are allowed", what,
                                     part, steps + 1.0, kLongestList));
    }
    for (int i = 0; i <= static_cast<int>(steps); ++i) {
        const double value = i == 0 ? first : as_written(first + i * step);
        numbers.push_back(std::abs(value - last) <= 1e-9 * std::abs(step) ? last : value);
    }
}

/// The text behind the number, e.g. "eV".
std::string_view unit_text(std::string_view text) {
    const std::string_view digits = without_blanks(text);
    double value = 0.0;
    const char* last = digits.data() + digits.size();
    const char* end = std::from_chars(digits.data(), last, value).ptr;
    return without_blanks(digits.substr(static_cast<std::size_t>(end - digits.data())));
}

std::string_view without_unit(std::string_view text) {
    const std::string_view digits = without_blanks(text);
    return digits.substr(0, digits.size() - unit_text(text).size());
}

/// `2eV:3eV:0.25eV`: even steps in the unit of the step, which the ends must have too.
void append_wavelengths(std::string_view part, std::vector<double>& wavelengths_nm) {
    const std::vector<std::string> ends = split_range(part, "wavelength");
    const std::string_view written = unit_text(ends[2]);
    if (written.empty())
        return append_range(part, "wavelength", parse_wavelength_nm, wavelengths_nm);
    const auto unit = materials::parse_unit(written);
    for (const std::string& end : ends) {
        if (unit && materials::parse_unit(unit_text(end)) == unit) continue;
        throw UsageError(
            fmt::format("wavelength: '{}': a step with a unit needs both ends in that "
                        "unit, e.g. 2eV:3eV:0.25eV",
                        part));
    }
    const Parse parse = [](std::string_view end) { return parse_number(end, "wavelength"); };
    std::vector<double> values;
    append_range(fmt::format("{}:{}:{}", without_unit(ends[0]), without_unit(ends[1]),
                             without_unit(ends[2])),
                 "wavelength", parse, values);
    for (const double value : values) {
        if (!(value > 0)) {
            throw UsageError(fmt::format("wavelength: '{}' is not positive throughout", part));
        }
        wavelengths_nm.push_back(materials::to_nm(value, *unit));
    }
}

using AppendRange = std::function<void(std::string_view, std::vector<double>&)>;

std::vector<double> parse_list(std::string_view text, const Parse& parse,
                               const AppendRange& append) {
    std::vector<double> numbers;
    for (const std::string& part : split_list(text)) {
        if (part.find(':') != std::string::npos) {
            append(part, numbers);
        } else {
            numbers.push_back(parse(part));
        }
    }
    return numbers;
}

}  // namespace

double parse_number(std::string_view text, const std::string& what) {
    const std::string_view digits = without_blanks(text);
    const char* first = digits.data();
    const char* last = first + digits.size();
    if (!digits.empty() && *first == '+') ++first;
    double value = 0.0;
    const auto [end, error] = std::from_chars(first, last, value);
    if (digits.empty() || error != std::errc() || end != last) {
        throw UsageError(fmt::format("{}: '{}' is not a number", what, text));
    }
    if (!std::isfinite(value)) {
        throw UsageError(fmt::format("{}: {} is not a finite number", what, text));
    }
    return value;
}

double parse_number_or_infinity(std::string_view text, const std::string& what) {
    if (without_blanks(text) == "inf") return std::numeric_limits<double>::infinity();
    return parse_number(text, what);
}

double parse_quantity(std::string_view text, const std::string& what, std::span<const Unit> units) {
    const std::string_view whole = without_blanks(text);
    const std::string_view name = unit_text(whole);
    std::string known;
    for (const Unit& unit : units) {
        if (unit.name == name && name.size() < whole.size()) {
            const double number = parse_number(whole.substr(0, whole.size() - name.size()), what);
            return number * unit.times / unit.by;
        }
        if (!unit.name.empty()) known += (known.empty() ? "" : ", ") + std::string(unit.name);
    }
    if (name.size() == whole.size()) parse_number(whole, what);  // no number at all
    throw UsageError(
        fmt::format("{}: '{}' has no unit that is known here; allowed: {}", what, whole, known));
}

std::string blank_in_parentheses(std::string_view text) {
    std::string blanked(text);
    int depth = 0;
    for (char& c : blanked) {
        if (c == ')') --depth;
        if (depth < 0) break;
        const bool opens = c == '(';
        if (depth > 0) c = ' ';
        if (opens) ++depth;
    }
    return depth == 0 ? blanked : std::string(text);
}

std::vector<std::string> split_list(std::string_view text, char separator) {
    std::vector<std::string> parts;
    std::size_t start = 0;
    while (start <= text.size()) {
        const std::size_t end = std::min(text.find(separator, start), text.size());
        parts.emplace_back(without_blanks(text.substr(start, end - start)));
        start = end + 1;
    }
    return parts;
}

std::vector<std::string> split_index(std::string_view text) {
    std::string_view digits = without_blanks(text);
    if (digits.empty() || (digits.back() != 'i' && digits.back() != 'j')) return split_list(text);
    digits.remove_suffix(1);
    std::size_t sign = digits.find_last_of("+-");
    while (sign != std::string::npos && sign > 0 &&
           (digits[sign - 1] == 'e' || digits[sign - 1] == 'E'))
        sign = digits.find_last_of("+-", sign - 1);
    if (sign == std::string::npos || sign == 0) return split_list(text);
    if (digits[sign] == '-') {
        throw UsageError(fmt::format("'{}' is n - ik; here k > 0 absorbs: write {}+{}i or {},{}",
                                     text, digits.substr(0, sign), digits.substr(sign + 1),
                                     digits.substr(0, sign), digits.substr(sign + 1)));
    }
    return {trimmed_text(digits.substr(0, sign)), trimmed_text(digits.substr(sign + 1))};
}

std::vector<double> parse_number_list(std::string_view text, const std::string& what) {
    const Parse parse = [&](std::string_view part) { return parse_number(part, what); };
    return parse_list(text, parse, [&](std::string_view part, std::vector<double>& numbers) {
        append_range(part, what, parse, numbers);
    });
}

std::vector<double> parse_number_list(std::string_view text, const std::string& what, double lowest,
                                      double highest, bool lowest_open) {
    std::vector<double> numbers = parse_number_list(text, what);
    for (const double value : numbers) {
        const bool above = lowest_open ? value > lowest : value >= lowest;
        if (!(above && value <= highest)) {
            throw UsageError(fmt::format("{}: {} is out of range; allowed: {}{}, {}]", what, value,
                                         lowest_open ? "(" : "[", lowest, highest));
        }
    }
    return numbers;
}

double parse_wavelength_nm(std::string_view text) {
    try {
        return materials::parse_wavelength_nm(text);
    } catch (const UsageError& error) {
        throw UsageError(
            fmt::format("{}; write 550, 550nm, 0.55um, 5500A or 2.25eV", error.what()));
    }
}

std::vector<double> parse_wavelengths_nm(std::string_view text) {
    // Chen et al. do not say at which wavelengths their R, G and B are; these fit their Table 1
    // best (docs/maths-surface.md).
    if (without_blanks(text) == "rgb") return {620.0, 535.0, 480.0};
    return parse_list(text, parse_wavelength_nm, append_wavelengths);
}

}  // namespace miebrdf
