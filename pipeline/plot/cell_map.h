// The coloured cells of a map, written briefly.
#pragma once

#include <map>
#include <string>

#include "pipeline/plot/svg.h"

namespace miebrdf::plot {

/// Collects cells and draws those of one colour as one shape: a map of some thousand cells in 256
/// colours takes some 30 to 60 bytes for each cell instead of 140.
class CellMap {
  public:
    void add_rectangle(Point corner, double width, double height, const std::string& colour);
    /// Part of a ring around `centre`; angles counter-clockwise from the right, ascending.
    void add_sector(Point centre, double inner, double outer, double first_deg, double last_deg,
                    const std::string& colour);

    void draw(SvgDrawing& drawing, Edges edges) const;

  private:
    std::map<std::string, std::string> paths_;  ///< by colour: the same data give the same bytes
};

}  // namespace miebrdf::plot
