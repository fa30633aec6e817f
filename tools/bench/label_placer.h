// Where to write next to points that lie close to each other.
#pragma once

#include <cstddef>
#include <vector>

namespace miebrdf::bench {

struct Box {
    double left, top, right, bottom;
    double overlap(const Box& other) const;
};

/// Puts labels where they cover least of what is there already, near their point.
class LabelPlacer {
  public:
    explicit LabelPlacer(const Box& area) : area_(area) {}
    /// A point that labels should not cover.
    void block(double x, double y) { taken_.push_back({x - 4, y - 4, x + 4, y + 4}); }
    /// Where a text of so many characters goes; it is taken from now on.
    Box place(double x, double y, std::size_t characters);

  private:
    Box area_;
    std::vector<Box> taken_;
};

}  // namespace miebrdf::bench
