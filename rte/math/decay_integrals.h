// Integrals of one decaying exponential against another over a layer, without cancellation.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace miebrdf::math {

struct DecayIntegrals {
    double near;  ///< x int_0^1 exp(-x u) sinh(y (1 - u)) / sinh(y) du
    double far;   ///< x int_0^1 exp(-x u) sinh(y u) / sinh(y) du
};

/// Both for x = tau / mu >= 0 and y = k tau >= 0; y = 0 is the limit sinh(y u) / sinh(y) = u.
/// Relative error a few units in the last place everywhere, x = y included: three forms of the same
/// integrals, each used where nothing cancels.
DecayIntegrals decay_integrals(double x, double y);

/// Integrals for the cosines of a layer and one y after the other. All that depends on x alone is
/// found once, and once for all y.
class DecayIntegrator {
  public:
    using NodeArray = Eigen::Array<double, 15, 1>;
    /// The integrals of one x.
    struct Decay {
        double x, exp_minus_x;
        NodeArray weighted;  ///< x w exp(-x u) at Gauss nodes u, for x < 1
        explicit Decay(double x_);
    };

    /// x = optical_depth / mu; nothing happens if these are the x it has.
    void set(double optical_depth, const Eigen::VectorXd& mu);

    /// Both integrals at each x: of as many elements as there are cosines.
    void integrate(double y, Eigen::Ref<Eigen::VectorXd> near,
                   Eigen::Ref<Eigen::VectorXd> far) const;

    /// exp(-x) of the cosine at `index`.
    double direct(Eigen::Index index) const { return decays_[std::size_t(index)].exp_minus_x; }

  private:
    std::vector<Decay> decays_;
};

}  // namespace miebrdf::math
