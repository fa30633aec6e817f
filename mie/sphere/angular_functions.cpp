#include "mie/sphere/angular_functions.h"

#include <algorithm>

#include "mie/sphere/amplitudes.h"

namespace miebrdf::mie {
namespace {

constexpr int angles_per_group = 128;

}  // namespace

template <typename Scalar>
AngularFunctionsOf<Scalar>::AngularFunctionsOf(std::span<const double> angles_deg, int terms,
                                               const Executor& run)
    : plus_(static_cast<Eigen::Index>(angles_deg.size()), terms + 1),
      minus_(plus_.rows(), terms + 1) {
    Eigen::ArrayXd mu(plus_.rows());
    for (Eigen::Index i = 0; i < mu.size(); ++i) mu[i] = cosine_of_scattering_angle(angles_deg[i]);
    const int groups = static_cast<int>(mu.size() + angles_per_group - 1) / angles_per_group;
    run(groups, [&](int group) {
        const Eigen::Index first = group * Eigen::Index(angles_per_group);
        fill(first, mu.segment(first, std::min<Eigen::Index>(angles_per_group, mu.size() - first)));
    });
}

// As in scattering_amplitudes, several angles at once.
template <typename Scalar>
void AngularFunctionsOf<Scalar>::fill(Eigen::Index first, const Eigen::ArrayXd& mu) {
    const Eigen::Index count = mu.size();
    plus_.col(0).segment(first, count).setZero();
    minus_.col(0).segment(first, count).setZero();
    Eigen::ArrayXd pi_before = Eigen::ArrayXd::Zero(count), pi = Eigen::ArrayXd::Ones(count);
    Eigen::ArrayXd s(count), t(count), tau(count);
    for (Eigen::Index n = 1; n < plus_.cols(); ++n) {
        const double order = static_cast<double>(n);
        s = mu * pi;
        t = s - pi_before;
        tau = order * t - pi_before;
        const double weight = (2 * order + 1) / (order * (order + 1));
        plus_.col(n).segment(first, count) = (weight * (pi + tau)).matrix().template cast<Scalar>();
        minus_.col(n).segment(first, count) =
            (weight * (pi - tau)).matrix().template cast<Scalar>();
        pi_before.swap(pi);
        pi = s + (order + 1) / order * t;
    }
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_squares(const Matrix& functions,
                                             const typename SphereBlockOf<Scalar>::Matrix& waves,
                                             int terms, int columns,
                                             Eigen::VectorXd& intensity) const {
    Matrix amplitude(functions.rows(), columns);
    amplitude.noalias() = functions.middleCols(1, terms) * waves.block(1, 0, terms, columns);
    for (int column = 0; column < columns; ++column) {
        intensity += amplitude.col(column).template cast<double>().cwiseAbs2();
    }
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_intensity(const SphereBlockOf<Scalar>& block,
                                               Eigen::VectorXd& intensity) const {
    const int columns = 2 * block.size;
    add_squares(plus_, block.U, block.terms, columns, intensity);
    add_squares(minus_, block.V, block.terms, columns, intensity);
}

template class AngularFunctionsOf<float>;
template class AngularFunctionsOf<double>;

}  // namespace miebrdf::mie
