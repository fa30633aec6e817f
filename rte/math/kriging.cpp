#include "rte/math/kriging.h"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace miebrdf::math {
namespace {

/// (1 + s + s^2/3) exp(-s), s = sqrt(5) r.
Eigen::ArrayXd matern(const Eigen::ArrayXd& r_squared) {
    const Eigen::ArrayXd s = (5.0 * r_squared).sqrt();
    return (1.0 + s + s.square() / 3.0) * (-s).exp();
}

/// Covariance of one scaled point with all: the mean over the point and its mirror image.
Eigen::VectorXd covariances(const Eigen::ArrayXXd& scaled, const Eigen::ArrayXXd& mirrored,
                            const Eigen::ArrayXd& at) {
    const Eigen::ArrayXd direct = (scaled.colwise() - at).square().colwise().sum().transpose();
    const Eigen::ArrayXd swapped = (mirrored.colwise() - at).square().colwise().sum().transpose();
    return 0.5 * (matern(direct) + matern(swapped)).matrix();
}

/// dimensions x n, divided by the lengths.
Eigen::ArrayXXd scaled_by(const Eigen::ArrayXd& lengths, const Eigen::MatrixXd& at) {
    Eigen::ArrayXd all(lengths.size() + 1);
    all << lengths, lengths[lengths.size() - 1];
    return at.transpose().array().colwise() / all;
}

ScatteredPoints some_of(const ScatteredPoints& points, int count) {
    const Eigen::Index all = points.at.rows();
    if (all <= count) return points;
    std::vector<Eigen::Index> rows;
    for (int i = 0; i < count; ++i) rows.push_back(all * i / count);
    return {points.at(rows, Eigen::all), points.trend(rows, Eigen::all),
            points.values(rows, Eigen::all)};
}

}  // namespace

Kriging::Kriging(const ScatteredPoints& points, KrigingKernel kernel) : kernel_(std::move(kernel)) {
    const Eigen::Index n = points.at.rows(), dimensions = points.at.cols();
    if (points.trend.rows() != n || points.values.rows() != n || dimensions < 2 ||
        kernel_.lengths.size() != dimensions - 1)
        throw std::invalid_argument("kriging: lists of different lengths");
    if (n <= points.trend.cols())
        throw std::invalid_argument("kriging: fewer points than terms of the trend");
    scaled_ = scaled_by(kernel_.lengths, points.at);
    scaled_mirrored_ = scaled_;
    scaled_mirrored_.row(dimensions - 2).swap(scaled_mirrored_.row(dimensions - 1));

    // With the covariances K, the terms H and the values Y: P = K^-1 - K^-1 H (H^T K^-1 H)^-1 H^T
    // K^-1 gives the weights P Y, and (P Y)_i / P_ii is what the other points miss value i by.
    Eigen::MatrixXd covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        covariance.col(i) = covariances(scaled_, scaled_mirrored_, scaled_.col(i));
    covariance.diagonal().array() += kernel_.nugget;
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));
    const Eigen::MatrixXd inverse_terms = inverse * points.trend;
    const Eigen::LLT<Eigen::MatrixXd> normal(points.trend.transpose() * inverse_terms);
    coefficients_ = normal.solve(inverse_terms.transpose() * points.values);
    inverse -= inverse_terms * normal.solve(inverse_terms.transpose());
    weights_ = inverse * points.values;
    leave_one_out_ = weights_.array().colwise() / inverse.diagonal().array();
    residuals_ = kernel_.nugget * weights_;
}

Eigen::RowVectorXd Kriging::evaluate(const Eigen::RowVectorXd& at,
                                     const Eigen::RowVectorXd& trend) const {
    const Eigen::ArrayXd scaled = scaled_by(kernel_.lengths, at).col(0);
    return covariances(scaled_, scaled_mirrored_, scaled).transpose() * weights_ +
           trend * coefficients_;
}

KrigingKernel fitted_kernel(const ScatteredPoints& points, int most_points) {
    const ScatteredPoints some = some_of(points, most_points);
    const Eigen::Index lengths = points.at.cols() - 1;
    // The logarithms of the lengths, then that of the nugget.
    Eigen::ArrayXd best = Eigen::ArrayXd::Zero(lengths + 1);
    best[lengths] = std::log(1e-3);
    const auto kernel_of = [&](const Eigen::ArrayXd& logs) {
        return KrigingKernel{logs.head(lengths).exp(), std::exp(logs[lengths])};
    };
    const auto error_of = [&](const Eigen::ArrayXd& logs) {
        const double error = Kriging(some, kernel_of(logs)).leave_one_out().squaredNorm();
        return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
    };
    // Lengths beyond these are as good as none, and make the covariances singular.
    const double shortest = std::log(0.01), longest = std::log(10.0);
    const double least_nugget = std::log(1e-8), most_nugget = std::log(1.0);
    double least = error_of(best);
    for (const double step : {std::log(3.0), 0.5 * std::log(3.0)}) {
        bool better = true;
        for (int round = 0; round < 6 && better; ++round) {
            better = false;
            for (Eigen::Index k = 0; k <= lengths; ++k) {
                for (const double sign : {-1.0, 1.0}) {
                    Eigen::ArrayXd next = best;
                    next[k] += sign * step;
                    const bool is_nugget = k == lengths;
                    if (next[k] < (is_nugget ? least_nugget : shortest) ||
                        next[k] > (is_nugget ? most_nugget : longest))
                        continue;
                    const double error = error_of(next);
                    if (!(error < least)) continue;
                    least = error;
                    best = next;
                    better = true;
                }
            }
        }
    }
    return kernel_of(best);
}

}  // namespace miebrdf::math
