// A table of densities on the unit square, bilinear between its nodes: drawn from, and inverted, as
// RGL's readers do (powitacq, Mitsuba 3 and pbrt-v4 agree).
#pragma once

#include <cstddef>
#include <vector>

namespace miebrdf::exports {

struct Point2 {
    double x = 0.0, y = 0.0;
};

class BilinearWarp {
  public:
    /// @param values  ny rows of nx >= 0, x fastest; both at least 2. Normalised here.
    BilinearWarp(std::vector<double> values, std::size_t nx, std::size_t ny);

    /// Uniform (u, v) to a point with the table's density.
    Point2 sample(Point2 uniform) const;
    /// The inverse of sample.
    Point2 invert(Point2 point) const;
    /// Per unit area; its mean over the square is 1. 0 when the table is all zero.
    double density(Point2 point) const;

  private:
    struct Cell {
        std::size_t column, row;
        double x, y;  ///< inside the cell, [0, 1]
    };
    Cell locate(Point2 point) const;
    const double& at(std::size_t column, std::size_t row) const {
        return values_[row * nx_ + column];
    }

    std::vector<double> values_;
    std::size_t nx_, ny_;
    std::vector<double> row_integral_;  ///< running along x, for each row
    std::vector<double> integral_;      ///< running along y, of the row totals
};

}  // namespace miebrdf::exports
