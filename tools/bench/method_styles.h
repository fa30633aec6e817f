// How methods look in plots.
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

/// Outline of a marker at (x, y) in SVG's path language, about 2 r wide.
std::string marker_path(int marker, double x, double y, double r);

}  // namespace miebrdf::bench
