#include "pipeline/plot/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace miebrdf::plot {

double round_step(double range, int count) {
    const double rough = range / count;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * power >= rough * 0.999) return factor * power;
    }
    return 10.0 * power;
}

std::string power_of_ten(int exponent) {
    const char* raised[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                            "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
    std::string text = exponent < 0 ? "10\u207b" : "10";
    for (const char digit : std::to_string(std::abs(exponent))) text += raised[digit - '0'];
    return text;
}

Axis::Axis(AxisOptions options, const std::vector<double>& values) : options_(std::move(options)) {
    span(values);
    if (options_.scale == Scale::linear) {
        add_linear_ticks();
    } else {
        add_log_ticks();
    }
}

void Axis::span(const std::vector<double>& values) {
    const bool log = options_.scale == Scale::logarithmic;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double value : values) {
        if (!std::isfinite(value) || (log && !(value > 0))) continue;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    lowest_ = options_.lowest.value_or(low);
    highest_ = options_.highest.value_or(high);
    if (!(std::isfinite(lowest_) && std::isfinite(highest_))) {
        throw std::invalid_argument(
            fmt::format("axis '{}': no {}value to show", options_.label, log ? "positive " : ""));
    }
    if (lowest_ == highest_ && !(options_.lowest && options_.highest)) {
        // A constant is shown from zero, so that nobody takes it for a small change: a quarter
        // below the top, or on zero itself. Shares (albedos) end at 1.
        const double constant = lowest_;
        lowest_ = log ? constant / 2 : std::min(1.25 * constant, 0.0);
        highest_ = log ? constant * 2 : std::max(1.25 * constant, constant == 0.0 ? 1.0 : 0.0);
        if (!log && constant <= 1.0) highest_ = std::min(highest_, 1.0);
    }
    if (!(lowest_ < highest_) || (log && !(lowest_ > 0))) {
        throw std::invalid_argument(fmt::format("axis '{}' from {} to {}; allowed: ascending{}",
                                                options_.label, lowest_, highest_,
                                                log ? " and positive" : ""));
    }
}

void Axis::add_multiples(double step) {
    const double first = std::ceil(lowest_ / step - 1e-9);
    const double last = std::floor(highest_ / step + 1e-9);
    for (int i = 0; first + i <= last; ++i) {
        const double value = first + i == 0 ? 0.0 : (first + i) * step;  // no "-0"
        ticks_.push_back({value, fmt::format("{:g}", value)});
    }
}

void Axis::add_linear_ticks() {
    const double step = options_.step.value_or(round_step(highest_ - lowest_, 5));
    // Rounding of a quotient must not add a whole step.
    if (!options_.lowest) lowest_ = step * std::floor(lowest_ / step + 1e-9);
    if (!options_.highest) highest_ = step * std::ceil(highest_ / step - 1e-9);
    add_multiples(step);
}

void Axis::add_log_ticks() {
    if (highest_ / lowest_ < 10) {  // too short for powers of ten: numbers as on a linear axis
        add_multiples(round_step(highest_ - lowest_, 8));
        return;
    }
    if (!options_.lowest) lowest_ = std::pow(10.0, std::floor(std::log10(lowest_) + 1e-9));
    if (!options_.highest) highest_ = std::pow(10.0, std::ceil(std::log10(highest_) - 1e-9));
    const int first = static_cast<int>(std::floor(std::log10(lowest_)));
    const int last = static_cast<int>(std::ceil(std::log10(highest_)));
    const bool plain = first >= -4 && last <= 4;  // 0.0001 to 10000
    const int every = 1 + (last - first) / 7;     // at most eight numbers
    // Chosen ends may leave a single power of ten between them, which is no scale to read.
    const double above = std::log10(highest_ * (1 + 1e-9)),
                 below = std::log10(lowest_ * (1 - 1e-9));
    const bool few = std::floor(above) - std::ceil(below) < 1;
    for (int exponent = first; exponent <= last; ++exponent) {
        for (int digit = 1; digit <= 9; ++digit) {
            const double value = digit * std::pow(10.0, exponent);
            if (value < lowest_ * (1 - 1e-9) || value > highest_ * (1 + 1e-9)) continue;
            std::string label;
            if (few && (digit == 1 || digit == 2 || digit == 5)) {
                label = fmt::format("{:g}", value);
            } else if (digit == 1 && exponent % every == 0) {
                label = plain ? fmt::format("{:g}", value) : power_of_ten(exponent);
            }
            if (digit == 1 || every == 1) ticks_.push_back({value, label});
        }
    }
}

double Axis::position(double value) const {
    if (options_.scale == Scale::linear) return (value - lowest_) / (highest_ - lowest_);
    if (!(value > 0)) return std::numeric_limits<double>::quiet_NaN();
    return std::log(value / lowest_) / std::log(highest_ / lowest_);
}

}  // namespace miebrdf::plot
