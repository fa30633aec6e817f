#include "mie/spheroid/regular_products.h"

#include <algorithm>
#include <cmath>

#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using Eigen::ArrayXcd;
using Eigen::ArrayXd;

constexpr double kNegligible = 1e-18;  // of the largest term of a power series

// P_0 ... P_degree of Jacobi, by recurrence in the degree; beta >= 0.
std::vector<Complex> jacobi(double alpha, double beta, Complex z, int degree) {
    std::vector<Complex> P(degree + 1, 1.0);
    if (degree >= 1) P[1] = (alpha + 1) + (alpha + beta + 2) * (z - 1.0) / 2.0;
    for (int m = 2; m <= degree; ++m) {
        const double c = 2 * m + alpha + beta;
        P[m] = ((c - 1) * (c * (c - 2) * z + alpha * alpha - beta * beta) * P[m - 1] -
                2 * (m + alpha - 1) * (m + beta - 1) * c * P[m - 2]) /
               (2 * m * (m + alpha + beta) * (c - 2));
    }
    return P;
}

struct TerminatingSum {
    Complex value = 1.0;
    double largest_term = 1.0;
    double loss() const { return largest_term / std::abs(value); }
};

// 2F1(-M, b; c; z).
TerminatingSum hypergeometric(int M, double b, double c, Complex z) {
    TerminatingSum sum;
    Complex term = 1.0;
    for (int i = 0; i < M; ++i) {
        term *= (i - M) * (b + i) / ((c + i) * (i + 1.0)) * z;
        sum.value += term;
        sum.largest_term = std::max(sum.largest_term, std::abs(term));
    }
    return sum;
}

// P_M^(alpha, -b)(1 - 2y) for M < b: by the one of Kummer's three sums (in y, y / (y - 1) and
// 1 - y) that cancels least.
Complex jacobi_of_low_degree(int M, double alpha, int b, Complex y) {
    double leading = 1.0, other_leading = M % 2 == 0 ? 1.0 : -1.0;
    for (int i = 1; i <= M; ++i) {
        leading *= (alpha + i) / i;
        other_leading *= double(i - b) / i;
    }
    const double last = M + alpha + 1 - b;
    TerminatingSum best = hypergeometric(M, last, alpha + 1, y);
    Complex value = leading * best.value;
    if (y != 1.0) {
        const TerminatingSum sum = hypergeometric(M, b - M, alpha + 1, y / (y - 1.0));
        if (sum.loss() < best.loss()) {
            best = sum;
            value = leading * std::pow(1.0 - y, M) * sum.value;
        }
    }
    const TerminatingSum sum = hypergeometric(M, last, 1 - b, 1.0 - y);
    return sum.loss() < best.loss() ? other_leading * sum.value : value;
}

// c_q of RadialProducts for all n of one k: row = n, entry (q - lowest) / 2.
class PowerSeries {
  public:
    PowerSeries(Complex s, int k, int highest_order, int highest_power)
        : lowest_(k - highest_order + 2 + (k + highest_order) % 2) {
        if (k + 4 > highest_order) return;
        const int powers = (highest_power - lowest_) / 2 + 1;
        table_.setZero(highest_order + 1, powers);
        const Complex y = s * s, scale = -std::pow(s, k + 1);
        for (int j = 0; j < powers; ++j) {
            const int q = lowest_ + 2 * j;
            const int degree = (highest_order - k - 2 + q) / 2;
            if (degree < 0) continue;
            const auto P = polynomials(degree, k + 0.5, q - 1, y);
            for (int n = highest_order - (highest_order + k) % 2; n >= k + 4; n -= 2) {
                const int M = (n - k - 2 + q) / 2;
                if (n - k - 2 + q < 0) break;
                table_(n, j) = scale * factorials(n + k, q) * P[M];
            }
        }
    }
    Complex at(int n, int q) const { return table_(n, (q - lowest_) / 2); }

  private:
    // P_M^(alpha, -b), M = 0 ... degree.
    static std::vector<Complex> polynomials(int degree, double alpha, int b, Complex y) {
        if (b <= 0) return jacobi(alpha, -b, 1.0 - 2.0 * y, degree);
        std::vector<Complex> P(degree + 1);
        for (int M = 0; M <= std::min(degree, b - 1); ++M)
            P[M] = jacobi_of_low_degree(M, alpha, b, y);
        if (degree < b) return P;
        // P_M^(alpha, -b) is a multiple of (1 - y)^b P_(M - b)^(alpha, b).
        const auto rest = jacobi(alpha, b, 1.0 - 2.0 * y, degree - b);
        Complex factor = std::pow(1.0 - y, b);
        for (int i = 1; i <= b; ++i) factor *= (alpha + i) / i;
        for (int M = b; M <= degree; ++M) {
            P[M] = factor * rest[M - b];
            factor *= (M + 1 + alpha) / (M + 1 + alpha - b) * (M + 1.0 - b) / (M + 1.0);
        }
        return P;
    }
    // (n+k+1-q)!! / (n+k-1+q)!!, with (-1)!! = 1 and on to negative numbers by their recurrence.
    static double factorials(int n_plus_k, int q) {
        double ratio = n_plus_k + 1.0;
        for (int p = 0; p < q; p += 2) ratio /= (n_plus_k + 1.0 - p) * (n_plus_k + 1.0 + p);
        for (int p = -2; p >= q; p -= 2) ratio *= (n_plus_k + 1.0 - p) * (n_plus_k + 1.0 + p);
        return ratio;
    }

    int lowest_;
    Eigen::ArrayXXcd table_;
};

// F_nk without negative powers of x; `whole` with them.
ArrayXcd without_negative_powers(const PowerSeries& c, int n, int k, const ArrayXd& x,
                                 int highest_power, const ArrayXcd& whole) {
    ArrayXcd result(x.size());
    for (Eigen::Index p = 0; p < x.size(); ++p) {
        const double square = x[p] * x[p];
        Complex negative = 0.0;
        double size_of_rest = 0.0, power = 1.0;
        for (int q = -2; q >= k - n + 2; q -= 2) {
            power /= square;
            const Complex term = c.at(n, q) * power;
            negative += term;
            size_of_rest = std::max(size_of_rest, std::abs(term));
        }
        size_of_rest += std::abs(whole[p]);
        result[p] = whole[p] - negative;
        Complex sum = 0.0;
        double largest = 0.0;
        power = 1.0;
        // Coefficients near q = (n - k) / 2 may be tiny with larger ones behind them.
        for (int q = 0; q <= highest_power && largest < size_of_rest; q += 2, power *= square) {
            const Complex term = c.at(n, q) * power;
            sum += term;
            largest = std::max(largest, std::abs(term));
            const bool at_end = q > n - k + 10 && q > x[p];
            if (at_end && std::abs(term) < kNegligible * largest) break;
        }
        if (largest < size_of_rest) result[p] = sum;
    }
    return result;
}

}  // namespace

Eigen::ArrayXXcd inner_functions(const ArrayXcd& z, int highest_order) {
    Eigen::ArrayXXcd values(z.size(), highest_order + 1);
    for (Eigen::Index p = 0; p < z.size(); ++p) {
        const Complex inverse = 1.0 / z[p];
        Complex above = 0.0, here = 1e-250;
        for (int n = safe_start(std::abs(z[p]), highest_order + 1); n >= 0; --n) {
            if (n <= highest_order) values(p, n) = here;
            const Complex below = (2.0 * n + 1.0) * inverse * here - above;
            above = here;
            here = below;
        }
        // here is psi_-1 = cos z by now, above is psi_0 = sin z.
        const Complex sine = std::sin(z[p]), cosine = std::cos(z[p]);
        values.row(p) *= std::abs(sine) > std::abs(cosine) ? sine / above : cosine / here;
    }
    return values;
}

RadialProducts::RadialProducts(Complex s, const ArrayXd& x, int highest_order)
    : highest_order_(highest_order),
      whole_(place(highest_order, highest_order) + 1),
      regular_(whole_.size()) {
    const auto inside = inner_functions(s * x.cast<Complex>(), highest_order);
    Eigen::ArrayXXd outside(x.size(), highest_order + 1);
    for (Eigen::Index p = 0; p < x.size(); ++p) {
        const RadialFunctions functions = radial_functions(x[p], highest_order);
        for (int n = 0; n <= highest_order; ++n) outside(p, n) = x[p] * functions.eta[n];
    }
    const double largest_x = x.maxCoeff();
    // The terms of x^q fall like those of sin x sin s x from about there on.
    const int highest_power =
        highest_order + 30 + 2 * int(std::ceil(largest_x * std::max(1.0, std::abs(s))));
    for (int k = 0; k <= highest_order; ++k) {
        const PowerSeries coefficients(s, k, highest_order, highest_power);
        for (int n = k % 2; n <= highest_order; n += 2) {
            ArrayXcd& whole = whole_[place(n, k)];
            whole = outside.col(n).cast<Complex>() * inside.col(k);
            // Nothing to gain where even the first power that is left is larger than the whole.
            if (n < k + 4 || whole.abs().maxCoeff() <= std::abs(coefficients.at(n, 0))) continue;
            regular_[place(n, k)] =
                without_negative_powers(coefficients, n, k, x, highest_power, whole);
        }
    }
}

}  // namespace miebrdf::mie
