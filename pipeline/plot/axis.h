// The scale of an axis: where values go and which of them get a number.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace miebrdf::plot {

enum class Scale { linear, logarithmic };

struct AxisOptions {
    std::string label;  ///< with its unit
    Scale scale = Scale::linear;
    std::optional<double> lowest = {}, highest = {};  ///< else from the data
    std::optional<double> step =
        {};  ///< between the numbers of a linear axis; else 1, 2 or 5 times 10^k
};

struct Tick {
    double value;
    std::string label;  ///< empty: a small tick
};

/// An interval of values and its ticks.
class Axis {
  public:
    /// Spans the finite values (on a logarithmic axis the positive ones), rounded outwards to ticks
    /// where the options leave the ends open.
    /// @throws std::invalid_argument  when there is nothing to show, or the chosen ends do not
    /// ascend
    ///         (or are not positive on a logarithmic axis)
    Axis(AxisOptions options, const std::vector<double>& values);

    const std::string& label() const { return options_.label; }
    double lowest() const { return lowest_; }
    double highest() const { return highest_; }
    const std::vector<Tick>& ticks() const { return ticks_; }

    /// 0 at the lowest, 1 at the highest value; beyond them outside [0, 1]. Not finite for values
    /// that a logarithmic axis does not have.
    double position(double value) const;

  private:
    void span(const std::vector<double>& values);
    void add_multiples(double step);
    void add_linear_ticks();
    void add_log_ticks();

    AxisOptions options_;
    double lowest_ = 0.0, highest_ = 1.0;
    std::vector<Tick> ticks_;
};

/// 1, 2 or 5 times a power of ten, so that `range` has about `count` of them.
double round_step(double range, int count);

/// 10^exponent with a raised exponent, as Unicode text.
std::string power_of_ten(int exponent);

}  // namespace miebrdf::plot
