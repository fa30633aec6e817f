#include "rte/fourier/coarser_orders.h"

#include <algorithm>
#include <cmath>

namespace miebrdf::rte {
namespace {

constexpr int enough = 2;  // orders in a row

// Largest (mu + mu') |R| over the requested pairs: bounded also at grazing angles.
double largest_bounded(const Eigen::Ref<const Eigen::MatrixXd>& reflection,
                       const RequestedDirections& requested) {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < reflection.cols(); ++i) {
        for (Eigen::Index o = 0; o < reflection.rows(); ++o) {
            const double sum = requested.mu[requested.out[o]] + requested.mu[requested.in[i]];
            largest = std::max(largest, sum * std::abs(reflection(o, i)));
        }
    }
    return largest;
}

}  // namespace

void CoarserOrders::compare(int order, const Eigen::MatrixXd& finer,
                            const RequestedDirections& requested) {
    if (order == 0) order_zero_ = largest_bounded(finer, requested);
    const auto at = std::size_t(order);
    if (at >= orders_.size() || orders_[at].size() != finer.size()) return;
    const double difference = largest_bounded(finer - orders_[at], requested);
    const bool is_alike = difference <= tolerance_ * order_zero_;
    alike_ = is_alike ? alike_ + 1 : 0;
    // Other orders are apart up to this times as far as order 0.
    constexpr double other_orders = 10.0;
    const bool is_first = order == 0 && other_orders * difference <= tolerance_ * order_zero_;
    if (is_first && order_zero_ > 0.0) {
        alike_ = enough;
        difference_ = other_orders * difference / order_zero_;
        return;
    }
    if (!is_alike || order_zero_ == 0.0) {
        difference_ = 0.0;
    } else {
        difference_ = std::max(difference_, difference / order_zero_);
    }
}

const Eigen::MatrixXd* CoarserOrders::settled(int order) const {
    const auto at = std::size_t(order);
    if (alike_ < enough || at >= orders_.size() || orders_[at].size() == 0) return nullptr;
    return &orders_[at];
}

}  // namespace miebrdf::rte
