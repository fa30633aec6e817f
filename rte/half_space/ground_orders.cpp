#include <algorithm>
#include <cmath>
#include <numbers>

#include "rte/fourier/fourier_mode.h"
#include "rte/half_space/half_space.h"
#include "rte/math/quadrature.h"

namespace miebrdf::rte {

void GroundOrders::fill(const GroundBrdf& ground, const FourierMode& mode, const ZenithGrid& nodes,
                        const RequestedDirections& cosines, int orders, const ZenithGrid& grid,
                        const RequestedDirections& requested, Reflector& reflector) {
    no_reflection(grid, requested, reflector);
    if (!mode.has_intensity()) return;
    const auto same = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
        return a.size() == b.size() && a == b;
    };
    if (ground != ground_ || !same(nodes.mu, nodes_) || !same(cosines.mu, cosines_)) {
        orders_.clear();
        ground_ = ground;
        nodes_ = nodes.mu;
        cosines_ = cosines.mu;
    }
    const int m = mode.fourier_order;
    if (m < first_ || m >= first_ + int(orders_.size())) find(m, std::max(1, orders - m));
    const Eigen::MatrixXd& R = orders_[std::size_t(m - first_)];
    // In the memory of the sky's answer, which nobody has asked for yet.
    Eigen::VectorXd &D = reflector.sky_at_nodes, &one = reflector.sky_at_requested;
    D = flux_weights(grid);
    mode.keep_intensity(D);
    one.setOnes(requested.mu.size());
    mode.keep_intensity(one);
    const int c = mode.rows_per_node;
    for (Eigen::Index q = 0; q < D.size(); ++q) {
        for (Eigen::Index p = 0; p < D.size(); ++p)
            reflector.nodes(p, q) = 2.0 * R(p / c, q / c) * D[p] * D[q];
        for (Eigen::Index r = 0; r < one.size(); ++r)
            reflector.rows(r, q) = 2.0 * R(nodes_.size() + r / c, q / c) * one[r] * D[q];
    }
}

// R^m = 1 / pi of the integral of R cos(m azimuth) from 0 to pi. The hot spot is a cusp or close to
// one at the end of this interval, where Gauss nodes are dense.
void GroundOrders::find(int first, int orders) {
    constexpr Eigen::Index kMostNumbers = 1 << 22;  // 32 MB
    constexpr int kSmooth = 64;  // nodes for what R itself needs: coefficients to 1e-6
    const Eigen::Index n = nodes_.size(), rows = n + cosines_.size();
    const int count = int(std::clamp<Eigen::Index>(kMostNumbers / (rows * n), 1, orders));
    const math::Quadrature azimuth =
        math::gauss_legendre(kSmooth + first + count, 0.0, std::numbers::pi);
    const auto azimuths = Eigen::Index(azimuth.nodes.size());
    Eigen::MatrixXd waves(azimuths, count), values(rows, azimuths);
    Eigen::ArrayXd cosines(azimuths);
    for (Eigen::Index a = 0; a < azimuths; ++a) {
        const double angle = azimuth.nodes[std::size_t(a)];
        cosines[a] = std::cos(angle);
        for (int k = 0; k < count; ++k)
            waves(a, k) =
                azimuth.weights[std::size_t(a)] / std::numbers::pi * std::cos((first + k) * angle);
    }
    first_ = first;
    orders_.assign(std::size_t(count), Eigen::MatrixXd(rows, n));
    Eigen::MatrixXd coefficients(rows, count);
    for (Eigen::Index q = 0; q < n; ++q) {
        for (Eigen::Index r = 0; r < rows; ++r) {
            const double mu = r < n ? nodes_[r] : cosines_[r - n];
            for (Eigen::Index a = 0; a < azimuths; ++a)
                values(r, a) = ground_.reflection(nodes_[q], mu, cosines[a]);
        }
        coefficients.noalias() = values * waves;
        for (int k = 0; k < count; ++k) orders_[std::size_t(k)].col(q) = coefficients.col(k);
    }
    for (Eigen::MatrixXd& R : orders_)  // reciprocity, exactly
        R.topRows(n).triangularView<Eigen::StrictlyLower>() = R.topRows(n).transpose().eval();
}

}  // namespace miebrdf::rte
