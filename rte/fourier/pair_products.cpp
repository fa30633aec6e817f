#include "rte/fourier/pair_products.h"

namespace miebrdf::rte {

void PairProducts::gather(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                          const Eigen::Ref<const Eigen::MatrixXd>& extra,
                          const RequestedDirections& requested) {
    gather_rows(extra, requested.out, extra_out_);
    gather_rows(extra, requested.in, extra_in_);
    weighted_.resize(extra_in_.rows(), extra_in_.cols());
    weighted_ = extra_in_ * strengths.asDiagonal();
}

void PairProducts::add(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                       const Eigen::Ref<const Eigen::MatrixXd>& extra,
                       const Eigen::Ref<const Eigen::MatrixXd>& first_out,
                       const Eigen::Ref<const Eigen::MatrixXd>& first_in,
                       const RequestedDirections& requested, Eigen::MatrixXd& sum) {
    gather(strengths, extra, requested);
    sum.noalias() += first_out * weighted_.transpose();
    weighted_ += first_in * strengths.asDiagonal();
    sum.noalias() += extra_out_ * weighted_.transpose();
}

void PairProducts::subtract_below(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                                  const Eigen::Ref<const Eigen::MatrixXd>& extra,
                                  const Eigen::Ref<const Eigen::VectorXd>& direct,
                                  const Eigen::Ref<const Eigen::MatrixXd>& first_out,
                                  const Eigen::Ref<const Eigen::MatrixXd>& first_in,
                                  const RequestedDirections& requested, Eigen::MatrixXd& sum) {
    gather(strengths, extra, requested);
    product_.resize(sum.rows(), sum.cols());
    product_.noalias() = first_out * weighted_.transpose();
    for (Eigen::Index i = 0; i < sum.cols(); ++i) {
        for (Eigen::Index o = 0; o < sum.rows(); ++o) {
            sum(o, i) -= direct[requested.out[std::size_t(o)]] * product_(o, i);
        }
    }
    for (Eigen::Index c = 0; c < weighted_.cols(); ++c) {
        for (Eigen::Index i = 0; i < weighted_.rows(); ++i) {
            weighted_(i, c) += direct[requested.in[std::size_t(i)]] * strengths[c] * first_in(i, c);
        }
    }
    sum.noalias() -= extra_out_ * weighted_.transpose();
}

void divide_by_cosines(const RequestedDirections& requested, Eigen::MatrixXd& reflection) {
    for (Eigen::Index i = 0; i < reflection.cols(); ++i) {
        const double mu_in = requested.mu[requested.in[std::size_t(i)]];
        for (Eigen::Index o = 0; o < reflection.rows(); ++o) {
            reflection(o, i) /= 4.0 * (requested.mu[requested.out[std::size_t(o)]] + mu_in);
        }
    }
}

}  // namespace miebrdf::rte
