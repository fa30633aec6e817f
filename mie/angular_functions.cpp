#include "mie/angular_functions.h"

#include "mie/amplitudes.h"

namespace miebrdf::mie {

template <typename Scalar>
AngularFunctionsOf<Scalar>::AngularFunctionsOf(std::span<const double> angles_deg, int terms)
    : plus_(Matrix::Zero(static_cast<Eigen::Index>(angles_deg.size()), terms + 1)), minus_(plus_) {
    // As in scattering_amplitudes, all angles at once.
    const Eigen::Index count = plus_.rows();
    Eigen::ArrayXd mu(count);
    for (Eigen::Index i = 0; i < count; ++i) mu[i] = cosine_of_scattering_angle(angles_deg[i]);
    Eigen::ArrayXd pi_before = Eigen::ArrayXd::Zero(count), pi = Eigen::ArrayXd::Ones(count);
    for (int n = 1; n <= terms; ++n) {
        const Eigen::ArrayXd s = mu * pi;
        const Eigen::ArrayXd t = s - pi_before;
        const Eigen::ArrayXd tau = n * t - pi_before;
        const double weight = (2.0 * n + 1.0) / (n * (n + 1.0));
        plus_.col(n) = (weight * (pi + tau)).matrix().template cast<Scalar>();
        minus_.col(n) = (weight * (pi - tau)).matrix().template cast<Scalar>();
        pi_before = pi;
        pi = s + (n + 1.0) / n * t;
    }
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_squares(const Matrix& functions,
                                             const SphereBlock::Matrix& waves, int terms,
                                             int columns, Eigen::MatrixXd& intensity) const {
    Matrix amplitude(functions.rows(), columns);
    if constexpr (std::is_same_v<Scalar, double>) {
        amplitude.noalias() = functions.middleCols(1, terms) * waves.block(1, 0, terms, columns);
    } else {
        const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> narrow =
            waves.block(1, 0, terms, columns).template cast<Scalar>();
        amplitude.noalias() = functions.middleCols(1, terms) * narrow;
    }
    for (int column = 0; column < columns; ++column) {
        intensity.col(column % 2) += amplitude.col(column).template cast<double>().cwiseAbs2();
    }
}

template <typename Scalar>
void AngularFunctionsOf<Scalar>::add_intensity(const SphereBlock& block,
                                               Eigen::MatrixXd& intensity) const {
    const int columns = 2 * block.size;  // size is even: imaginary parts keep their sphere's parity
    add_squares(plus_, block.U, block.terms, columns, intensity);
    add_squares(minus_, block.V, block.terms, columns, intensity);
}

template class AngularFunctionsOf<float>;
template class AngularFunctionsOf<double>;

}  // namespace miebrdf::mie
