#include "rte/stokes/coupled.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/math/tolerance_budget.h"

namespace miebrdf::rte {
namespace {

constexpr int kMostSteps = 100;

// R_ij / (k_i + k_j) in place; returns the largest relative to k_i + k_j.
double newton_step(const Eigen::VectorXd& rows, const Eigen::VectorXd& columns,
                   Eigen::MatrixXd& residual) {
    double largest = 0.0;
    for (Eigen::Index j = 0; j < residual.cols(); ++j) {
        for (Eigen::Index i = 0; i < residual.rows(); ++i) {
            const double sum = rows[i] + columns[j];
            residual(i, j) /= sum;
            const double change = std::abs(residual(i, j)) / sum;
            if (!(change <= largest)) largest = change;
        }
    }
    return largest;
}

}  // namespace

bool CoupledModes::find(const StokesTables& tables, const StokesBlock& block,
                        const MatrixStrengths& medium, double one_minus_albedo,
                        const ZenithGrid& grid, const RequestedDirections& requested,
                        double tolerance) {
    const StokesBlock rest(block.begin(), block.end() - 1);
    const int rows = int(rest.size());
    const ZenithGrid linear_grid = repeated(grid, rows);
    make_block_mode(tables, rest, medium, linear_grid, repeated(requested, rows), linear_mode_,
                    linear_medium_);
    make_block_mode(tables, {StokesComponent::V}, medium, grid, requested, circular_mode_,
                    circular_medium_);
    linear_medium_.one_minus_albedo = circular_medium_.one_minus_albedo = one_minus_albedo;
    const bool physical =
        linear_.find(linear_mode_, linear_medium_, linear_grid, tolerance).physical &&
        circular_.find(circular_mode_, circular_medium_, grid, tolerance).physical;
    if (!physical) return false;
    inverse_linear.noalias() = linear().odd * linear().vectors;
    inverse_circular.noalias() = circular().odd * circular().vectors;
    form_couplings(tables, block, medium, grid);
    return iterate(tolerance);
}

// sum b2 y_U y_V^T over the degrees of one parity: those with l - m odd belong to U, even to V.
void CoupledModes::form_couplings(const StokesTables& tables, const StokesBlock& block,
                                  const MatrixStrengths& medium, const ZenithGrid& grid) {
    const int m = tables.fourier_order;
    const Eigen::Index n = grid.size();
    const Eigen::Index rows = Eigen::Index(block.size()) - 1;
    const Eigen::VectorXd scale = (grid.weights.array() / grid.mu.array()).sqrt();
    const Eigen::Index degrees =
        std::min(m + tables.nodes.P.cols(), Eigen::Index(medium.b2.size()));
    const auto coupling = [&](int parity) {
        Eigen::MatrixXd of_U = Eigen::MatrixXd::Zero(rows * n, tables.nodes.P.cols());
        Eigen::MatrixXd of_V = Eigen::MatrixXd::Zero(n, tables.nodes.P.cols());
        Eigen::Index count = 0;
        for (Eigen::Index l = std::max(2, m); l < degrees; ++l) {
            if ((l - m) % 2 != parity || medium.b2[l] == 0.0) continue;
            for (Eigen::Index p = 0; p < n; ++p) {
                const double of_Q = rows > 1 ? -scale[p] * tables.nodes.T(p, l - m) : 0.0;
                if (rows > 1 && tables.along_axes) {
                    of_U(rows * p, count) = of_Q * (std::numbers::sqrt2 / 2.0);
                    of_U(rows * p + 1, count) = -of_U(rows * p, count);
                } else if (rows > 1) {
                    of_U(rows * p + 1, count) = of_Q;
                }
                of_U(rows * p + rows - 1, count) = scale[p] * tables.nodes.R(p, l - m);
                of_V(p, count) = medium.b2[l] * scale[p] * tables.nodes.P(p, l - m);
            }
            ++count;
        }
        return Eigen::MatrixXd(of_U.leftCols(count) * of_V.leftCols(count).transpose());
    };
    const Eigen::MatrixXd in_U = coupling(1), in_V = coupling(0);
    omega_.noalias() = -linear().vectors.transpose() * in_V * circular().vectors;
    upsilon_.noalias() = -inverse_linear.transpose() * in_U * inverse_circular;
}

bool CoupledModes::iterate(double tolerance) {
    const Eigen::VectorXd& k = linear().rates;
    const Eigen::VectorXd& q = circular().rates;
    // Rounding leaves as much in the products; below it steps would not shrink.
    const double goal = std::max(1e-14, kIterationShare * tolerance);
    S = k.asDiagonal();
    T = q.asDiagonal();
    K.setZero(k.size(), q.size());
    double change = 1.0;
    for (steps = 0; steps < kMostSteps && change > goal; ++steps) {
        SW_.noalias() = S * omega_;
        KW_.noalias() = K.transpose() * omega_;
        R12_ = SW_ + 0.5 * K;
        R11_.noalias() = R12_ * K.transpose();
        R11_ = (R11_ + R11_.transpose()).eval();
        R11_.selfadjointView<Eigen::Lower>().rankUpdate(S, -1.0);
        R11_.triangularView<Eigen::StrictlyUpper>() = R11_.transpose();
        R11_.diagonal().array() += k.array().square();
        R12_ = upsilon_;
        R12_.noalias() -= S * K;
        R12_.noalias() -= SW_ * T;
        R12_.noalias() += K * KW_.transpose();
        R12_.noalias() -= K * T;
        R22_.noalias() = KW_ * T;
        R22_ = (R22_ + R22_.transpose()).eval();
        R22_.noalias() += K.transpose() * K;
        R22_.noalias() -= T * T;
        R22_.diagonal().array() += q.array().square();
        change = newton_step(k, k, R11_);
        change = std::max(change, newton_step(k, q, R12_));
        change = std::max(change, newton_step(q, q, R22_));
        if (!(change < 10.0)) return false;
        S += R11_;
        K += R12_;
        T += R22_;
    }
    const Eigen::Index linear_rows = k.size(), circular_rows = q.size();
    rates.resize(linear_rows + circular_rows, linear_rows + circular_rows);
    rates.topLeftCorner(linear_rows, linear_rows) = S - omega_ * K.transpose();
    rates.topRightCorner(linear_rows, circular_rows) = K + omega_ * T;
    rates.bottomLeftCorner(circular_rows, linear_rows) = -omega_.transpose() * S - K.transpose();
    rates.bottomRightCorner(circular_rows, circular_rows) = T - omega_.transpose() * K;
    return change <= goal;
}

}  // namespace miebrdf::rte
