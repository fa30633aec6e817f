// Error against run time as a picture: one SVG for a case, for papers and for the page.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/measurement.h"

namespace miebrdf::bench {

/// Colour and marker of every method, the same in all plots of one page.
class MethodStyles {
  public:
    explicit MethodStyles(const std::vector<Measurement>& all);

    struct Style {
        std::string colour;  ///< #rrggbb
        int marker = 0;      ///< 0 disc, 1 square, 2 triangle, 3 diamond
    };
    Style of(const std::string& method) const;

  private:
    std::vector<std::string> methods_;
};

/// Log-log plot of the points of one case: a line for each method, every point labelled with its
/// knob, points of the Pareto front ringed and joined by a dotted staircase. Errors below 1e-17
/// (exact zeros too) and above 10, and times below 1 us, are drawn at these limits; points without
/// an answer are listed below the plot. Methods of chance have whiskers: their 95 % confidence
/// intervals, open below where they hold an error of 0. Self-contained: no fonts, scripts or styles
/// from outside.
std::string curve_plot_svg(const std::string& title, const std::vector<Measurement>& points,
                           const MethodStyles& styles);

}  // namespace miebrdf::bench
