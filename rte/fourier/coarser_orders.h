// Azimuthal orders of a solution with fewer nodes, for the finer one to go on with.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/phase/phase_mode.h"

namespace miebrdf::rte {

/// R^m of light scattered more than once, out x in, for m = 0, 1, ...; empty for orders left out.
using OrderList = std::vector<Eigen::MatrixXd>;

/// A finer solution repeats the orders of a coarser one until two in a row differ by less than a
/// tolerance, relative to order 0, or order 0 itself by less than a tenth of it; the rest it takes
/// over. Both converge alike in every order as long as the phase functions are smooth: of 442
/// random coated scenes with 10 to 48 nodes, compared at 25 pairs, the worst order was apart 0.2
/// times as far as order 0 in the median, 3.3 times in one of a hundred, 7.6 times at most. Where a
/// peak is cut off they do not, and nothing must be taken over. Few pairs may agree by accident:
/// they need probes (RequestedDirections).
class CoarserOrders {
  public:
    /// @param orders  of the coarser solution; empty: nothing is taken over
    CoarserOrders(const OrderList& orders, double tolerance)
        : orders_(orders), tolerance_(tolerance) {}

    /// Takes note of order m of the finer solution.
    void compare(int order, const Eigen::MatrixXd& finer, const RequestedDirections& requested);

    /// The coarser R^m, or null where the finer one has to be computed.
    const Eigen::MatrixXd* settled(int order) const;

    /// How far the orders that agreed were apart, relative to order 0: no order that was taken over
    /// is known better.
    double difference() const { return difference_; }

  private:
    const OrderList& orders_;
    double tolerance_;
    double order_zero_ = 0.0;
    double difference_ = 0.0;
    int alike_ = 0;
};

}  // namespace miebrdf::rte
