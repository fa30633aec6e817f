// The content of one of RGL's measured materials, read without trusting it: the checked tables that
// an evaluation may rely on, and densities to draw from.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/formats/common/byte_reader.h"

namespace miebrdf {

struct Point2 {
    double x = 0.0, y = 0.0;
};

/// A table of densities on the unit square, bilinear between its nodes: drawn from, and inverted,
/// as RGL's readers do (powitacq, Mitsuba 3 and pbrt-v4 agree).
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

/// A stack of equal tables, one for each incident angle (and channel), where they are in the file.
struct RglSlices {
    RealView<float> values;
    std::size_t nx = 0, ny = 0;

    double at(std::size_t slice, std::size_t x, std::size_t y) const {
        return values[(slice * ny + y) * nx + x];
    }
    double bilinear(std::size_t slice, Point2 p) const {
        const double x = std::clamp(p.x, 0.0, 1.0) * static_cast<double>(nx - 1);
        const double y = std::clamp(p.y, 0.0, 1.0) * static_cast<double>(ny - 1);
        const std::size_t c = std::min(nx - 2, static_cast<std::size_t>(x));
        const std::size_t r = std::min(ny - 2, static_cast<std::size_t>(y));
        const double s = x - static_cast<double>(c), t = y - static_cast<double>(r);
        return (1 - t) * ((1 - s) * at(slice, c, r) + s * at(slice, c + 1, r)) +
               t * ((1 - s) * at(slice, c, r + 1) + s * at(slice, c + 1, r + 1));
    }
};

/// Views into the file's content, which must outlive them.
struct RglTables {
    std::vector<float> theta;   ///< incident angles, radians, ascending in [0, pi/2]; at least one
    RglSlices ndf, sigma;       ///< one slice
    RglSlices vndf, luminance;  ///< a slice for each incident angle
    RglSlices spectra;          ///< for each incident angle, a slice for each channel
    std::vector<double> wavelength_nm;  ///< empty for RGB
    std::vector<std::string> channels;
    bool jacobian = false;  ///< spectra are to be multiplied by that of the half vector
};

/// @throws InputError  for an anisotropic material, fields that are missing, of another shape than
/// the others or not finite
RglTables read_rgl_tables(std::string_view content);

}  // namespace miebrdf
