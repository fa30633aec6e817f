// What scatters light from node to node and from nodes to cosines, in several Fourier orders side
// by side (rte/math/matrices_side_by_side.h).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "rte/grid/directions.h"

namespace miebrdf::rte {

class FourierModes;

/// Sums over degrees of Y_l(mu) a_l Y_l(mu_q), in the normalisation of FourierMode::scaled_nodes;
/// mu is a node or, below these, a requested cosine. Keeps the tables of Y that it has seen, at
/// most 2 MB.
class KernelsSideBySide {
  public:
    /// @param requested  cosines
    /// @return whether any of these is another one than before; tables are forgotten then
    bool set(const ZenithGrid& grid, const Eigen::VectorXd& requested, int degrees);

    int nodes() const { return int(grid_.size()); }
    int rows() const { return int(grid_.size() + requested_.size()); }

    /// Of the orders from `first` on, degrees l - m even and odd apart: nodes + cosines rows, nodes
    /// columns, stored by columns; of each order zero where it has no degrees. Of elements between
    /// nodes those below the diagonal are set, and some others.
    /// @param strengths  alpha (2l+1) chi_l of all degrees
    /// @param requested  as of `set`
    /// @param modes      for tables that have not been seen yet
    /// @param memory     for as many elements as a kernel
    template <typename Doubles>
    void form(int first, const Eigen::VectorXd& strengths, const RequestedDirections& requested,
              FourierModes& modes, Doubles* even, Doubles* odd, Doubles* memory);

  private:
    /// Y column by column, element by element so many orders.
    struct Table {
        int first = 0, orders = 0;
        Eigen::VectorXd values = {};
    };

    const double* table_of(int first, int orders, const RequestedDirections& requested,
                           FourierModes& modes);

    int degrees_ = 0;
    ZenithGrid grid_;
    Eigen::VectorXd requested_;
    std::vector<Table> tables_;
    Table passing_;  ///< of orders that are too many to be kept
};

}  // namespace miebrdf::rte
