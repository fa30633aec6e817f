#include "pipeline/number_list.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "materials/units.h"
#include "pipeline/error.h"

namespace miebrdf {
namespace {

constexpr std::size_t kLongestList = 1'000'000;  // beyond this it is a typing mistake

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Splits `first:last:step` and hands every number of the range to `append`.
void append_range(std::string_view part, const std::string& what,
                  const std::function<double(std::string_view)>& parse,
                  std::vector<double>& numbers) {
    const std::vector<std::string> ends = split_list(part, ':');
    if (ends.size() != 3) {
        throw UsageError(fmt::format("{}: '{}' is no range; write first:last:step, e.g. 400:700:10",
                                     what, part));
    }
    const double first = parse(ends[0]);
    const double last = parse(ends[1]);
    const double step = parse_number(ends[2], what + ", step");
    if (!(step * (last - first) > 0.0 || (first == last && step != 0.0))) {
        throw UsageError(fmt::format("{}: a step of {} does not lead from {} to {}", what, step,
                                     first, last));
    }
    // The end belongs to the list although first + i step meets it only within rounding.
    const double steps = std::floor((last - first) / step * (1.0 + 1e-12) + 1e-9);
    if (!(steps + 1.0 + static_cast<double>(numbers.size()) <= kLongestList)) {
        throw UsageError(fmt::format("{}: '{}' has {:.0f} numbers; at most {} are allowed", what, part,
                                     steps + 1.0, kLongestList));
    }
    for (double i = 0; i <= steps; ++i) {
        const double value = first + i * step;
        numbers.push_back(std::abs(value - last) <= 1e-9 * std::abs(step) ? last : value);
    }
}

std::vector<double> parse_list(std::string_view text, const std::string& what,
                               const std::function<double(std::string_view)>& parse) {
    std::vector<double> numbers;
    for (const std::string& part : split_list(text)) {
        if (part.find(':') != std::string::npos) {
            append_range(part, what, parse, numbers);
        } else {
            numbers.push_back(parse(part));
        }
    }
    return numbers;
}

}  // namespace

double parse_number(std::string_view text, const std::string& what) {
    const std::string_view digits = trimmed(text);
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

std::vector<std::string> split_list(std::string_view text, char separator) {
    std::vector<std::string> parts;
    std::size_t start = 0;
    while (start <= text.size()) {
        const std::size_t end = std::min(text.find(separator, start), text.size());
        parts.emplace_back(trimmed(text.substr(start, end - start)));
        start = end + 1;
    }
    return parts;
}

std::vector<double> parse_number_list(std::string_view text, const std::string& what) {
    return parse_list(text, what, [&](std::string_view part) { return parse_number(part, what); });
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
    } catch (const std::invalid_argument& error) {
        throw UsageError(fmt::format(
            "{}; write 550, 550nm, 0.55um, 5500A, 2.25eV, a range 400:700:10 or rgb", error.what()));
    }
}

std::vector<double> parse_wavelengths_nm(std::string_view text) {
    // Chen et al. do not say at which wavelengths their R, G and B are; these fit their Table 1
    // best (docs/maths-surface.md).
    if (trimmed(text) == "rgb") return {620.0, 535.0, 480.0};
    return parse_list(text, "wavelength", parse_wavelength_nm);
}

}  // namespace miebrdf
