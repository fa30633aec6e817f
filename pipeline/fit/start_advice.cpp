#include "pipeline/fit/start_advice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "pipeline/fit/unknowns.h"

namespace miebrdf::fitting {
namespace {

std::vector<double> starts_of(const std::vector<Unknown>& unknowns) {
    std::vector<double> numbers;
    for (const Unknown& unknown : unknowns) numbers.push_back(unknown.start);
    return numbers;
}

/// Of the fitted number, rounded to three digits where that is between both.
double rounded_within(const Unknown& unknown, double works, double fails) {
    const double x = number_of(unknown, works), beyond = number_of(unknown, fails);
    if (x == 0.0) return x;
    const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - 2.0);
    const double rounded = x < beyond ? std::floor(x / unit) * unit : std::ceil(x / unit) * unit;
    return rounded >= unknown.low && rounded <= unknown.high ? rounded : x;
}

}  // namespace

double spread_number(const std::vector<Unknown>& unknowns, std::size_t unknown, int index) {
    double root = 1.5;
    for (int i = 0; i < 50; ++i) root = std::pow(1.0 + root, 1.0 / (double(unknowns.size()) + 1.0));
    const double step = std::pow(root, -double(unknown + 1));
    const double share = 0.5 + index * step - std::floor(0.5 + index * step);
    const Range range = fitted_range(unknowns[unknown]);
    return range.low + share * (range.high - range.low);
}

std::string start_that_works(const std::vector<Unknown>& unknowns, const CanBe& can_be) {
    constexpr int kBisections = 4, kPoints = 8;
    for (std::size_t u = 0; u < unknowns.size(); ++u) {
        const Unknown& unknown = unknowns[u];
        const Range range = fitted_range(unknown);
        const auto with = [&](double t) {
            std::vector<double> numbers = starts_of(unknowns);
            numbers[u] = number_of(unknown, t);
            return numbers;
        };
        double fails = fitted_of(unknown, unknown.start);
        for (const double share : {0.5, 0.05, 0.95}) {
            double works = range.low + share * (range.high - range.low);
            if (!can_be(with(works))) continue;
            for (int i = 0; i < kBisections; ++i) {
                const double middle = 0.5 * (works + fails);
                (can_be(with(middle)) ? works : fails) = middle;
            }
            return fmt::format(
                "; the fit cannot start from {0} = {1:.6g}, but from {0} = {2:.6g}: write {0} = "
                "\"{2:.6g} in ...\"",
                unknown.name, unknown.start, rounded_within(unknown, works, fails));
        }
    }
    for (int index = 1; unknowns.size() > 1 && index <= kPoints; ++index) {
        std::vector<double> numbers;
        std::vector<std::string> words;
        for (std::size_t u = 0; u < unknowns.size(); ++u) {
            numbers.push_back(number_of(unknowns[u], spread_number(unknowns, u, index)));
            words.push_back(fmt::format("{} = {:.6g}", unknowns[u].name, numbers.back()));
        }
        if (can_be(numbers))
            return fmt::format("; the fit can start from {}", fmt::join(words, ", "));
    }
    return {};
}

}  // namespace miebrdf::fitting
