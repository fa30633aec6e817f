#include "rte/math/legendre.h"

#include <fmt/format.h>

#include <cmath>

#include <miebrdf/error.h>

namespace miebrdf::math {
namespace {

double power(double x, int exponent) {
    double result = 1.0;
    for (; exponent > 0; exponent /= 2, x *= x) {
        if (exponent % 2 == 1) result *= x;
    }
    return result;
}

// Y_m^m = prod_{i<=m} sqrt((2i-1)/(2i)) (1-mu^2)^{m/2}; the product stays above 0.01 for any m in
// use, and the power may underflow to zero, which is then its value.
template <typename Column>
void fill_first(int m, const Eigen::Ref<const Eigen::VectorXd>& mu, Column column) {
    double product = 1.0;
    for (int i = 1; i <= m; ++i) product *= (2.0 * i - 1.0) / (2.0 * i);
    product = std::sqrt(product);
    for (Eigen::Index p = 0; p < mu.size(); ++p) {
        const double sine_squared = (1.0 - mu[p]) * (1.0 + mu[p]);
        const double sine = m % 2 == 1 ? std::sqrt(sine_squared) : 1.0;
        column[p] = product * sine * power(sine_squared, m / 2);
    }
}

template <typename Table>
void fill(int order, int degrees, const Eigen::Ref<const Eigen::VectorXd>& mu, Table& table) {
    if (!(order >= 0 && degrees > order)) {
        throw UsageError("order", fmt::format("{} of {} degrees", order, degrees),
                         "0 or more, and below the number of degrees");
    }
    const int m = order;
    table.resize(mu.size(), degrees - m);
    fill_first(m, mu, table.col(0));
    if (degrees == m + 1) return;
    double root = std::sqrt(2.0 * m + 1.0);  // sqrt((l+1)^2 - m^2)
    table.col(1) = root * mu.cwiseProduct(table.col(0));
    for (int l = m + 1; l + 1 < degrees; ++l) {
        const double lower = root;
        root = std::sqrt((l + 1.0 - m) * (l + 1.0 + m));
        const double next = 1.0 / root, here = (2.0 * l + 1.0) * next, previous = lower * next;
        const auto column = l - m;
        table.col(column + 1) =
            here * mu.cwiseProduct(table.col(column)) - previous * table.col(column - 1);
    }
}

}  // namespace

void legendre_functions(int order, int degrees, const Eigen::Ref<const Eigen::VectorXd>& mu,
                        Eigen::MatrixXd& table) {
    fill(order, degrees, mu, table);
}

void legendre_functions(int order, int degrees, const Eigen::Ref<const Eigen::VectorXd>& mu,
                        ScratchMatrix& table) {
    fill(order, degrees, mu, table);
}

double legendre_series(std::span<const double> chi, double x) {
    // b_l = beta_l + (2l+1)/(l+1) x b_{l+1} - (l+1)/(l+2) b_{l+2}; the sum is b_0.
    double b_next = 0.0;
    double b_after = 0.0;
    for (std::size_t i = chi.size(); i-- > 0;) {
        const double l = static_cast<double>(i);
        const double b =
            (2.0 * l + 1.0) * (chi[i] + x * b_next / (l + 1.0)) - (l + 1.0) / (l + 2.0) * b_after;
        b_after = b_next;
        b_next = b;
    }
    return b_next;
}

}  // namespace miebrdf::math
