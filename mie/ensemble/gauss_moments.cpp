#include "mie/ensemble/gauss_moments.h"

namespace miebrdf::mie {

GaussMoments::GaussMoments(int terms, int highest_moment, const Executor& run)
    : highest_(highest_moment),
      rule_(math::gauss_legendre(terms + highest_moment / 2 + 1)),
      angles_(
          Eigen::Map<const Eigen::ArrayXd>(rule_.nodes.data(), Eigen::Index(rule_.nodes.size())),
          terms, run) {}

std::vector<double> GaussMoments::of(const Eigen::VectorXd& intensity) const {
    const Eigen::Index count = intensity.size();
    const Eigen::Map<const Eigen::ArrayXd> x(rule_.nodes.data(), count);
    const Eigen::Map<const Eigen::ArrayXd> weights(rule_.weights.data(), count);
    const Eigen::ArrayXd values = weights * intensity.array();
    Eigen::ArrayXd before = Eigen::ArrayXd::Zero(count), here = Eigen::ArrayXd::Ones(count);
    std::vector<double> moments;
    moments.reserve(std::size_t(highest_) + 1);
    for (int l = 0; l <= highest_; ++l) {
        moments.push_back((values * here).sum());
        before = ((2.0 * l + 1) / (l + 1.0)) * x * here - (l / (l + 1.0)) * before;
        before.swap(here);
    }
    return moments;
}

}  // namespace miebrdf::mie
