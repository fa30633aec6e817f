#include "rte/fourier/order_tail.h"

#include <algorithm>

namespace miebrdf::rte {
namespace {

// Slower series are not trusted to be geometric.
constexpr double slowest_ratio = 0.7;
constexpr double several = 2.5;

double ratio(double value, double to) { return to > 0.0 ? value / to : 1.0; }

}  // namespace

double OrderSizes::next(const Eigen::Ref<const Eigen::MatrixXd>& reflection) {
    const Eigen::VectorXd largest = reflection.cwiseAbs().colwise().maxCoeff().transpose();
    if (of_order_zero_.size() == 0) of_order_zero_ = largest;
    double size = 0.0;
    for (Eigen::Index i = 0; i < largest.size(); ++i) {
        if (largest[i] > 0.0) size = std::max(size, largest[i] / of_order_zero_[i]);
    }
    return size;
}

bool OrderTail::ends_with(double largest) {
    if (count_ == 0) order_zero_ = largest;
    const double fall = std::max(ratio(largest, last_), ratio(last_, before_last_));
    const bool is_geometric = count_ >= 3 && fall <= slowest_ratio;
    // The rest of an unknown series: some multiple of its last terms.
    remaining_ = several * ratio(std::max(largest, count_ > 0 ? last_ : largest), order_zero_);
    if (is_geometric) {
        const double envelope = std::max(largest, fall * last_);
        remaining_ = 2.0 * ratio(envelope, order_zero_) * fall / (1.0 - fall);
    }
    if (order_zero_ == 0.0) remaining_ = 0.0;
    const bool ends = count_ > 0 && remaining_ <= tolerance_;
    before_last_ = last_;
    last_ = largest;
    ++count_;
    return ends;
}

}  // namespace miebrdf::rte
