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
    /// Tables are forgotten where any of these is another one than before.
    /// @param requested  cosines
    void set(const ZenithGrid& grid, const Eigen::VectorXd& requested, int degrees);

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

    /// The kernels A = E + O and B = E - O of light scattered to the same and to the opposite side,
    /// between nodes and from nodes to cosines, out of those that `form` gives, of which the upper
    /// triangles between nodes are completed: nodes x nodes and cosines x nodes, by columns.
    template <typename Doubles>
    void form_sides(Doubles* even, Doubles* odd, Doubles* same, Doubles* opposite,
                    Doubles* same_rows, Doubles* opposite_rows) const;

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
