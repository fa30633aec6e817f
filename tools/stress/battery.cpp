#include "tools/stress/battery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

namespace miebrdf::stress {

void Log::run(const std::string& test_case, const std::function<void(const Case&)>& action) {
    const Case one(suite_, test_case, checks_);
    try {
        action(one);
    } catch (const std::exception& error) {
        one.at_most(std::string("threw: ") + error.what(), 1, 0,
                    "a valid request must have an answer");
    }
}

void Log::refused(const std::string& test_case, const std::function<void()>& action) {
    double value = 1;
    try {
        action();
    } catch (const std::exception&) {
        value = 0;
    }
    Case(suite_, test_case, checks_)
        .at_most("accepted without complaint", value, 0, "outside what has a meaning: must throw");
}

double outside(double value, double low, double high) {
    if (std::isnan(value)) return value;
    return std::max({0.0, low - value, value - high});
}

double relative_difference(double a, double b) {
    const double scale = std::max(std::abs(a), std::abs(b));
    if (scale == 0) return 0;
    if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<double>::quiet_NaN();
    return std::abs(a - b) / scale;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    auto other = b.begin();
    return worst(a, [&](double one) { return relative_difference(one, *other++); });
}

double largest_jump(const std::vector<double>& a, const std::vector<double>& b) {
    double jump = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = std::abs(a[i] - b[i]);
        if (!(d <= jump)) jump = d;
        largest = std::max(largest, std::abs(a[i]));
    }
    return jump / largest;
}

std::string text_of(Index index) { return fmt::format("{}+{}i", index.real(), index.imag()); }

std::vector<SwitchPoint> find_switches(double from, double to, int steps,
                                       const std::function<long(double)>& state) {
    std::vector<SwitchPoint> found;
    double below = from;
    long before = state(from);
    for (int i = 1; i <= steps; ++i) {
        const double above = from * std::pow(to / from, double(i) / steps);
        const long after = state(above);
        SwitchPoint point{below, above};
        below = above;
        if (after == std::exchange(before, after)) continue;
        const long left = state(point.below);
        for (double middle = 0.5 * (point.below + point.above);
             middle > point.below && middle < point.above;
             middle = 0.5 * (point.below + point.above)) {
            (state(middle) == left ? point.below : point.above) = middle;
        }
        found.push_back(point);
    }
    return found;
}

std::string tally(const std::vector<Check>& checks) {
    std::string text = "| suite | checks | not ok | closest to its bound |\n|---|---|---|---|\n",
                failures;
    for (auto first = checks.begin(); first != checks.end();) {
        const auto end = std::find_if(first, checks.end(),
                                      [&](const Check& c) { return c.suite != first->suite; });
        int failed = 0;
        const Check* closest = nullptr;
        for (auto c = first; c != end; ++c) {
            if (!c->ok()) {
                ++failed;
                failures += fmt::format("- {} / {}: {} is {:.3g}, bound {:.3g} ({})\n", c->suite,
                                        c->test_case, c->quantity, c->value, c->bound, c->cause);
            } else if (c->bound > 0 && c->value > 0 &&
                       (closest == nullptr ||
                        c->value / c->bound > closest->value / closest->bound)) {
                closest = &*c;
            }
        }
        text += fmt::format("| {} | {} | {} | {} |\n", first->suite, end - first, failed,
                            closest == nullptr
                                ? std::string("-")
                                : fmt::format("{}, {}: {:.1e} of {:.1e}", closest->test_case,
                                              closest->quantity, closest->value, closest->bound));
        first = end;
    }
    return text + (failures.empty() ? "" : "\nNot ok:\n\n" + failures);
}

}  // namespace miebrdf::stress
