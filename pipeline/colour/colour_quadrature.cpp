#include "pipeline/colour/colour_quadrature.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

namespace miebrdf {
namespace {

/// The observer under one illuminant on a 1 nm grid, wavelength mapped to t in [-1, 1].
struct Measure {
    Eigen::VectorXd t;
    Eigen::MatrixX3d xyz;
    Eigen::VectorXd total;  ///< x + y + z
};

Measure sample(Illuminant illuminant, double shortest_nm, double longest_nm) {
    const int count = 1 + static_cast<int>(std::ceil(longest_nm - shortest_nm));
    Measure measure{Eigen::VectorXd(count), Eigen::MatrixX3d(count, 3), {}};
    for (int i = 0; i < count; ++i) {
        const double t = -1.0 + 2.0 * i / (count - 1);
        const double nm = 0.5 * (shortest_nm + longest_nm + t * (longest_nm - shortest_nm));
        const ColourMatching c = colour_matching(nm);
        const double trapezoid = i == 0 || i == count - 1 ? 0.5 : 1.0;
        measure.t[i] = t;
        measure.xyz.row(i) << c.x, c.y, c.z;
        measure.xyz.row(i) *= trapezoid * relative_power(illuminant, std::min(nm, longest_nm));
    }
    measure.total = measure.xyz.rowwise().sum();
    return measure;
}

/// Polynomials orthonormal under measure.total, by Stieltjes' procedure, one column each, and the
/// Jacobi matrix of their recurrence.
struct Polynomials {
    Eigen::MatrixXd values;
    Eigen::VectorXd diagonal, off_diagonal;
};

Polynomials orthonormal(const Measure& measure, int count) {
    Polynomials p{Eigen::MatrixXd::Zero(measure.t.size(), count), Eigen::VectorXd(count),
                  Eigen::VectorXd::Zero(count)};
    const auto& w = measure.total;
    p.values.col(0).setConstant(1.0 / std::sqrt(w.sum()));
    for (int k = 0; k < count; ++k) {
        const Eigen::VectorXd shifted = measure.t.cwiseProduct(p.values.col(k));
        p.diagonal[k] = w.dot(shifted.cwiseProduct(p.values.col(k)));
        if (k + 1 == count) break;
        Eigen::VectorXd next = shifted - p.diagonal[k] * p.values.col(k);
        if (k > 0) next -= p.off_diagonal[k - 1] * p.values.col(k - 1);
        p.off_diagonal[k] = std::sqrt(w.dot(next.cwiseProduct(next)));
        p.values.col(k + 1) = next / p.off_diagonal[k];
    }
    return p;
}

void check(int nodes, double shortest_nm, double longest_nm) {
    if (!(nodes >= 1 && nodes <= 40)) {
        throw std::invalid_argument(fmt::format("{} colour nodes; allowed: 1 to 40", nodes));
    }
    if (!(shortest_nm >= kObserverShortest_nm && longest_nm <= kObserverLongest_nm &&
          longest_nm - shortest_nm >= 50)) {
        throw std::invalid_argument(
            fmt::format("colour from {} to {} nm; allowed: within {} to {} nm, at least 50 nm wide",
                        shortest_nm, longest_nm, kObserverShortest_nm, kObserverLongest_nm));
    }
}

}  // namespace

ColourQuadrature colour_quadrature(int nodes, Illuminant illuminant, double shortest_nm,
                                   double longest_nm) {
    check(nodes, shortest_nm, longest_nm);
    const Measure measure = sample(illuminant, shortest_nm, longest_nm);
    const Polynomials p = orthonormal(measure, nodes);
    // Golub & Welsch 1969: nodes are the eigenvalues of the Jacobi matrix; its unit eigenvectors
    // are v_kj = sqrt(g_j) p_k(t_j) with the Gauss weights g_j = v_0j^2 / p_0^2.
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen;
    eigen.computeFromTridiagonal(p.diagonal, p.off_diagonal.head(nodes - 1));
    const Eigen::MatrixXd& v = eigen.eigenvectors();
    // weight_j = sum_k g_j p_k(t_j) integral(c p_k), for c = x, y, z: g_j p_k(t_j) = sqrt(g_j)
    // v_kj.
    const Eigen::MatrixX3d integrals = p.values.transpose() * measure.xyz;
    const Eigen::VectorXd root_g = v.row(0).transpose() / p.values(0, 0);
    Eigen::MatrixX3d weights = root_g.asDiagonal() * v.transpose() * integrals;
    const Xyz white = white_point(illuminant);
    const Eigen::RowVector3d sums = weights.colwise().sum();
    weights.col(0) *= white.x / sums[0];
    weights.col(1) *= white.y / sums[1];
    weights.col(2) *= white.z / sums[2];

    ColourQuadrature rule;
    for (int j = 0; j < nodes; ++j) {
        const double t = eigen.eigenvalues()[j];
        rule.wavelength_nm.push_back(0.5 *
                                     (shortest_nm + longest_nm + t * (longest_nm - shortest_nm)));
        rule.weights.x.push_back(weights(j, 0));
        rule.weights.y.push_back(weights(j, 1));
        rule.weights.z.push_back(weights(j, 2));
    }
    return rule;
}

}  // namespace miebrdf
