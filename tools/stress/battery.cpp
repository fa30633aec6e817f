#include "tools/stress/battery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

namespace miebrdf::stress {

void Log::at_most(const std::string& test_case, const std::string& quantity, double value,
                  double bound, const std::string& cause) {
    checks_.push_back({suite_, test_case, quantity, value, bound, cause});
}

void Log::refused(const std::string& test_case, const std::function<void()>& action) {
    double value = 1;
    try {
        action();
    } catch (const std::exception&) {
        value = 0;
    }
    at_most(test_case, "accepted without complaint", value, 0,
            "outside what has a meaning: must throw");
}

void Log::run(const std::string& test_case, const std::function<void()>& action) {
    try {
        action();
    } catch (const std::exception& error) {
        at_most(test_case, std::string("threw: ") + error.what(), 1, 0,
                "a valid request must have an answer");
    }
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
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double d = relative_difference(a[i], b[i]);
        if (!(d <= worst)) worst = d;
    }
    return worst;
}

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

std::vector<Check> run_battery(const Options& options,
                               const std::function<void(const std::string&)>& watch) {
    using Suite = void (*)(const Options&, std::vector<Check>&);
    const std::pair<const char*, Suite> suites[] = {{"spheres", spheres},
                                                    {"ensembles", ensembles},
                                                    {"half-spaces", half_spaces},
                                                    {"coats", coats},
                                                    {"boundaries", boundaries},
                                                    {"surfaces", surfaces},
                                                    {"materials", materials},
                                                    {"refusals", refusals},
                                                    {"photons", photons},
                                                    {"sphere switches", sphere_switches},
                                                    {"transfer switches", transfer_switches},
                                                    {"promises", promises}};
    std::vector<Check> checks;
    for (const auto& [name, suite] : suites) {
        if (watch) watch(name);
        suite(options, checks);
    }
    return checks;
}

std::string tally(const std::vector<Check>& checks) {
    std::vector<std::string> suites;
    for (const Check& c : checks) {
        if (std::find(suites.begin(), suites.end(), c.suite) == suites.end())
            suites.push_back(c.suite);
    }
    std::string text = "| suite | checks | not ok | closest to its bound |\n|---|---|---|---|\n",
                failures;
    for (const std::string& suite : suites) {
        int count = 0, failed = 0;
        const Check* closest = nullptr;
        for (const Check& c : checks) {
            if (c.suite != suite) continue;
            ++count;
            if (!c.ok()) {
                ++failed;
                failures += fmt::format("- {} / {}: {} is {:.3g}, bound {:.3g} ({})\n", c.suite,
                                        c.test_case, c.quantity, c.value, c.bound, c.cause);
            } else if (c.bound > 0 && c.value > 0 &&
                       (closest == nullptr ||
                        c.value / c.bound > closest->value / closest->bound)) {
                closest = &c;
            }
        }
        text += fmt::format("| {} | {} | {} | {} |\n", suite, count, failed,
                            closest == nullptr
                                ? std::string("-")
                                : fmt::format("{}, {}: {:.1e} of {:.1e}", closest->test_case,
                                              closest->quantity, closest->value, closest->bound));
    }
    return text + (failures.empty() ? "" : "\nNot ok:\n\n" + failures);
}

}  // namespace miebrdf::stress
