// A logarithmic axis: where a value lies, and which decades get a line.
#pragma once

#include <string>
#include <vector>

namespace miebrdf::bench {

class LogAxis {
  public:
    /// Covers [lowest, highest], both > 0, with a little room; `from` and `to` are positions of the
    /// ends in the drawing.
    LogAxis(double lowest, double highest, double from, double to);

    double position(double value) const;

    /// Powers of ten inside the axis, at most ten of them.
    std::vector<int> decades() const;

    /// The same as values, with 2 and 5 times each where the axis has only one or two of them.
    std::vector<double> ticks() const;

    /// "1 us", "20 ms", "100 s".
    static std::string time_label(double seconds);

  private:
    double low_, high_, from_, to_;  // low, high: log10 of the ends
};

}  // namespace miebrdf::bench
