#include "rte/math/quadrature.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf::math {

Quadrature gauss_legendre(int count, double lower, double upper) {
    if (!(count >= 1 && count <= 8192)) {
        throw UsageError("count", count, "1 to 8192");
    }
    if (!(lower < upper && std::isfinite(upper - lower))) {
        throw UsageError("interval", fmt::format("({}, {})", lower, upper), "finite, not empty");
    }
    const double centre = 0.5 * (lower + upper);
    const double half_width = 0.5 * (upper - lower);
    // Boost gives the zeros that are not negative, ascending; the rest follow by symmetry.
    const std::vector<double> zeros = boost::math::legendre_p_zeros<double>(count);

    Quadrature rule;
    rule.nodes.resize(count);
    rule.weights.resize(count);
    for (std::size_t i = 0; i < zeros.size(); ++i) {
        const double x = zeros[i];
        const double slope = boost::math::legendre_p_prime(count, x);
        const double weight = 2.0 / ((1.0 - x) * (1.0 + x) * slope * slope);
        const std::size_t above = count - zeros.size() + i;
        const std::size_t below = count - 1 - above;
        rule.nodes[above] = centre + half_width * x;
        rule.nodes[below] = centre - half_width * x;
        rule.weights[above] = rule.weights[below] = half_width * weight;
    }
    return rule;
}

Quadrature gauss_rule(const Quadrature& points, int count, GaussRule kind) {
    if (!(count >= 2 && count <= 64)) throw UsageError("count", count, "2 to 64");
    const auto of = [](const std::vector<double>& numbers) {
        return Eigen::Map<const Eigen::ArrayXd>(numbers.data(), Eigen::Index(numbers.size()));
    };
    const Eigen::ArrayXd x = of(points.nodes), weights = of(points.weights);
    const double whole = weights.sum();
    // Orthonormal polynomials at the points, one degree after the other.
    Eigen::ArrayXd before = Eigen::ArrayXd::Zero(x.size());
    Eigen::ArrayXd now = Eigen::ArrayXd::Constant(x.size(), 1 / std::sqrt(whole));
    Eigen::VectorXd diagonal(count), beside(count - 1);
    const double lowest = points.nodes.front();
    double ratio = 0;  // of the monic polynomials of this degree and the one before, there
    for (int degree = 0;; ++degree) {
        diagonal[degree] = (weights * x * now.square()).sum();
        if (degree == count - 1) break;
        const double step = degree > 0 ? beside[degree - 1] : 0.0;
        Eigen::ArrayXd next = (x - diagonal[degree]) * now - step * before;
        beside[degree] = std::sqrt((weights * next.square()).sum());
        next /= beside[degree];
        ratio = lowest - diagonal[degree] - (degree > 0 ? step * step / ratio : 0.0);
        before = std::move(now);
        now = std::move(next);
    }
    if (kind == GaussRule::radau)
        diagonal[count - 1] = lowest - beside[count - 2] * beside[count - 2] / ratio;

    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(diagonal, beside, Eigen::ComputeEigenvectors);
    Quadrature rule;
    for (int i = 0; i < count; ++i) {
        rule.nodes.push_back(solver.eigenvalues()[i]);
        rule.weights.push_back(whole * std::pow(solver.eigenvectors()(0, i), 2));
    }
    return rule;
}

}  // namespace miebrdf::math
