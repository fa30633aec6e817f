// Decides how many azimuthal orders a sum needs.
#pragma once

#include <Eigen/Core>

namespace miebrdf::rte {

/// What the azimuthal orders that are left out may amount to: their share of a solver's tolerance.
inline constexpr double share_of_orders = 0.25;

/// Sizes of successive azimuthal orders: |R^m|, the largest at each incidence relative to that of
/// order 0, and of these the largest. By incidence, as errors are: a bright zenith in the same
/// request says nothing of grazing light.
class OrderSizes {
  public:
    /// @param reflection  R^m, out x in; m = 0 first
    double next(const Eigen::Ref<const Eigen::MatrixXd>& reflection);

  private:
    Eigen::VectorXd of_order_zero_;
};

/// Watches the sizes of successive azimuthal orders and says when those still to come are below a
/// tolerance relative to order 0.
///
/// Orders of a smooth phase function fall like r^m: once two steps in a row have fallen by r <= 0.7
/// or more, the rest is a geometric series, 2 v r / (1 - r) with the 2 of 2 R^m cos(m azimuth). v
/// is the envelope max(v_m, r v_(m-1)), because one small order may be an accident of parity. Where
/// the orders fall otherwise, the rest is taken as 2.5 times the larger of the last two.
class OrderTail {
  public:
    explicit OrderTail(double tolerance) : tolerance_(tolerance) {}

    /// Takes the next order. True once the rest no longer matters.
    bool ends_with(double largest);

    /// What the orders still to come amount to, relative to order 0.
    double remaining() const { return remaining_; }

  private:
    double tolerance_;
    int count_ = 0;
    double order_zero_ = 0.0;
    double before_last_ = 0.0;
    double last_ = 0.0;
    double remaining_ = 0.0;
};

}  // namespace miebrdf::rte
