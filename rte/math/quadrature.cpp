#include "rte/math/quadrature.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include <miebrdf/error.h>

namespace miebrdf::math {
namespace {

/// The zeros of P_n that are not negative, ascending, all by Newton's iteration together, and their
/// weights of Gauss's rule on (-1, 1).
struct LegendreZeros {
    Eigen::ArrayXd x, weight;

    explicit LegendreZeros(int n) : x((n + 1) / 2), weight(x.size()) {
        // Tricomi's approximation errs by the order of n^-4 at most.
        for (Eigen::Index i = 0; i < x.size(); ++i) {
            const double k = double(x.size() - i);
            x[i] = (1.0 - (n - 1.0) / (8.0 * n * n * n)) *
                   std::cos(std::numbers::pi * (k - 0.25) / (n + 0.5));
        }
        const bool has_middle = n % 2 == 1;
        if (has_middle) x[0] = 0.0;
        // A step s leaves an error of x s^2 / (1 - x^2), half of P'' / P' at a zero.
        constexpr double kRounding = 1e-17;
        for (double left = 1.0; left > kRounding;) {
            const Eigen::ArrayXd change = value_over_slope(n);
            left = (change.square() / ((1.0 - x) * (1.0 + x))).maxCoeff();
            x -= change;
            if (has_middle) x[0] = 0.0;
        }
        value_over_slope(n);
        weight = 2.0 / ((1.0 - x) * (1.0 + x) * slope_.square());
    }

  private:
    /// P_n / P'_n at x.
    Eigen::ArrayXd value_over_slope(int n) {
        below_.setOnes(x.size());
        value_ = x;
        for (int j = 1; j < n; ++j) {
            const double share = j / (j + 1.0);
            below_ = x * value_ + share * (x * value_ - below_);
            value_.swap(below_);
        }
        slope_ = double(n) * (below_ - x * value_) / ((1.0 - x) * (1.0 + x));
        return value_ / slope_;
    }

    Eigen::ArrayXd below_, value_, slope_;
};

}  // namespace

Quadrature gauss_legendre(int count, double lower, double upper) {
    if (!(count >= 1 && count <= 8192)) {
        throw UsageError("count", count, "1 to 8192");
    }
    if (!(lower < upper && std::isfinite(upper - lower))) {
        throw UsageError("interval", fmt::format("({}, {})", lower, upper), "finite, not empty");
    }
    const double centre = 0.5 * (lower + upper);
    const double half_width = 0.5 * (upper - lower);
    const LegendreZeros zeros(count);

    Quadrature rule;
    rule.nodes.resize(count);
    rule.weights.resize(count);
    for (Eigen::Index i = 0; i < zeros.x.size(); ++i) {
        const std::size_t above = count - std::size_t(zeros.x.size() - i);
        const std::size_t below = count - 1 - above;
        rule.nodes[above] = centre + half_width * zeros.x[i];
        rule.nodes[below] = centre - half_width * zeros.x[i];
        rule.weights[above] = rule.weights[below] = half_width * zeros.weight[i];
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
