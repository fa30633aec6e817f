#include "pipeline/fit/unknowns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf {
namespace fitting {

double fitted_of(const Unknown& unknown, double x) {
    switch (unknown.scale) {
        case Unknown::Scale::linear:
            return x;
        case Unknown::Scale::logarithm:
            return std::log(x);
        case Unknown::Scale::log_of_one_minus:
            return std::log1p(-x);
    }
    return x;
}

double number_of(const Unknown& unknown, double t) {
    double x = t;
    if (unknown.scale == Unknown::Scale::logarithm) x = std::exp(t);
    if (unknown.scale == Unknown::Scale::log_of_one_minus) x = -std::expm1(t);
    return std::clamp(x, unknown.low, unknown.high);
}

double slope(const Unknown& unknown, double x) {
    switch (unknown.scale) {
        case Unknown::Scale::linear:
            return 1.0;
        case Unknown::Scale::logarithm:
            return x;
        case Unknown::Scale::log_of_one_minus:
            return x - 1.0;
    }
    return 1.0;
}

Range fitted_range(const Unknown& unknown) {
    const double a = fitted_of(unknown, unknown.low), b = fitted_of(unknown, unknown.high);
    return {std::min(a, b), std::max(a, b)};
}

std::vector<Slot> slots_of(const std::vector<Unknown>& unknowns, std::size_t wavelengths) {
    std::vector<Slot> slots;
    for (std::size_t u = 0; u < unknowns.size(); ++u) {
        const std::size_t count = unknowns[u].per_wavelength ? wavelengths : 1;
        for (std::size_t w = 0; w < count; ++w) slots.push_back({u, w});
    }
    return slots;
}

void validate(const Unknown& unknown) {
    const auto refuse = [&](const std::string& reason) {
        throw UsageError(fmt::format("unknown '{}': {}", unknown.name, reason));
    };
    const auto is_of_name = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    };
    if (unknown.name.empty() || std::isdigit(static_cast<unsigned char>(unknown.name[0])) ||
        !std::all_of(unknown.name.begin(), unknown.name.end(), is_of_name))
        refuse("a name is letters, digits and _, and begins with a letter");
    if (!(std::isfinite(unknown.low) && std::isfinite(unknown.high) && unknown.low < unknown.high))
        refuse(fmt::format("bounds {}:{}; allowed: two finite numbers, the lower one first",
                           unknown.low, unknown.high));
    if (!(unknown.start >= unknown.low && unknown.start <= unknown.high))
        refuse(fmt::format("the start {} is outside its bounds {}:{}; move one of them",
                           unknown.start, unknown.low, unknown.high));
    if (unknown.scale == Unknown::Scale::logarithm && !(unknown.low > 0.0))
        refuse(
            fmt::format("the lower bound {} has no logarithm; give one above 0, or leave 'log' "
                        "out",
                        unknown.low));
    if (unknown.scale == Unknown::Scale::log_of_one_minus && !(unknown.high < 1.0))
        refuse(fmt::format("log(1 - x) needs an upper bound below 1, e.g. 0.9999999; given: {}",
                           unknown.high));
}

}  // namespace fitting

Unknown unknown(const std::string& name, const std::string& text) {
    constexpr std::string_view kPerWavelength = "per wavelength,";
    const auto refuse = [&] {
        throw UsageError(
            fmt::format("unknown '{}': '{}'; write START in LOW:HIGH, then perhaps log or "
                        "log1m, with 'per "
                        "wavelength,' before it if it differs at each: \"100 in 20:1000 log\"",
                        name, text));
    };
    Unknown result{.name = name};
    std::string rest = trimmed_text(text);
    if (rest.starts_with(kPerWavelength)) {
        result.per_wavelength = true;
        rest.erase(0, kPerWavelength.size());
    }
    std::istringstream words{rest};
    std::string start, in, bounds, scale, more;
    words >> start >> in >> bounds >> scale >> more;
    const std::size_t colon = bounds.find(':');
    if (in != "in" || colon == std::string::npos || !more.empty()) refuse();
    if (scale == "log") {
        result.scale = Unknown::Scale::logarithm;
    } else if (scale == "log1m") {
        result.scale = Unknown::Scale::log_of_one_minus;
    } else if (!scale.empty()) {
        refuse();
    }
    const std::string what = fmt::format("unknown '{}'", name);
    result.start = parse_number(start, what);
    result.low = parse_number(bounds.substr(0, colon), what);
    result.high = parse_number(bounds.substr(colon + 1), what);
    fitting::validate(result);
    return result;
}

}  // namespace miebrdf
