#include "tools/bench/log_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace miebrdf::bench {

LogAxis::LogAxis(double lowest, double highest, double from, double to)
    : low_(std::log10(lowest)), high_(std::log10(highest)), from_(from), to_(to) {
    const double room = std::max(0.15, 0.05 * (high_ - low_));
    low_ -= room;
    high_ += room;
}

double LogAxis::position(double value) const {
    return from_ + (std::log10(value) - low_) / (high_ - low_) * (to_ - from_);
}

std::vector<int> LogAxis::decades() const {
    const int first = static_cast<int>(std::ceil(low_)), last = static_cast<int>(std::floor(high_));
    const int step = std::max(1, (last - first + 9) / 10);
    std::vector<int> result;
    for (int d = first; d <= last; d += step) result.push_back(d);
    return result;
}

std::vector<double> LogAxis::ticks() const {
    const std::vector<int> whole = decades();
    std::vector<double> result;
    result.reserve(whole.size());
    for (const int d : whole) result.push_back(std::pow(10.0, d));
    if (whole.size() > 2) return result;
    for (int d = static_cast<int>(std::floor(low_)); d <= high_; ++d) {
        for (const double part : {2.0, 5.0}) {
            const double value = part * std::pow(10.0, d);
            if (std::log10(value) >= low_ && std::log10(value) <= high_) result.push_back(value);
        }
    }
    std::sort(result.begin(), result.end());
    return result;
}

std::string LogAxis::time_label(double seconds) {
    static const char* const kUnits[] = {"ns", "us", "ms", "s"};
    const double nanoseconds = 1e9 * seconds;
    const int unit =
        std::clamp(static_cast<int>(std::floor(std::log10(nanoseconds * (1 + 1e-9)) / 3)), 0, 3);
    return fmt::format("{:.6g} {}", nanoseconds / std::pow(1000.0, unit), kUnits[unit]);
}

}  // namespace miebrdf::bench
