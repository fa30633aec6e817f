// The Mueller matrix of layers at one wavelength, solved once and then evaluated at any directions.
#pragma once

#include <miebrdf/brdf_source.h>

#include <span>
#include <vector>

#include "pipeline/solve/smooth_part.h"
#include "rte/first_order/first_order.h"
#include "rte/stack/layered_reflection.h"

namespace miebrdf {

/// Element (row, column) of a solved table as series in azimuth; NaN where nothing is physical.
SmoothPart smooth_element(const rte::TabulatedOrders& table, int components, int row, int column);

/// Every element as SmoothPart has the BRDF: light scattered more than once from tables, the first
/// order exactly at every direction.
class MuellerPart {
  public:
    /// @param table  at SmoothPart::nodes()
    MuellerPart(const rte::TabulatedOrders& table, int components);

    int components() const { return components_; }

    /// Mueller matrices of the BRDF in 1/sr, at directions that share their cosines.
    /// @param first_order  of the stack as it was solved
    /// @param first    what is scattered once of element 11, of each direction: the matrix of
    ///                 the first order is brought to this, which has narrow features corrected
    /// @param matrix   receives values[d * stride + row * components + column]
    void evaluate(const rte::FirstOrder& first_order, std::span<const Direction> directions,
                  std::span<const double> first, double* matrix, std::size_t stride) const;

  private:
    int components_;
    std::vector<SmoothPart> elements_;
};

}  // namespace miebrdf
