#include "rte/math/wigner.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace miebrdf::math {
namespace {

// d^l_mn at l = max(|m|, |n|): sqrt((2l)! / (|m-n|! |m+n|!)) / 2^l (1-x)^(|m-n|/2) (1+x)^(|m+n|/2),
// the root as a product of numbers between 0 and 1; a power that underflows is its value.
class FirstDegree {
  public:
    FirstDegree(int m, int n)
        : minus_(std::abs(m - n)),
          plus_(std::abs(m + n)),
          degree_(std::max(std::abs(m), std::abs(n))) {
        const int other = std::min(std::abs(m), std::abs(n));
        double square = 1.0;
        for (int i = 1; i <= degree_; ++i) square *= (2.0 * i - 1.0) / (2.0 * i);
        for (int j = 1; j <= other; ++j) square *= (degree_ - j + 1.0) / (degree_ + j);
        // 4^-l is in the product, (2/2)^l in the powers below.
        factor_ = std::sqrt(square);
        if (n < m && (m - n) % 2 != 0) factor_ = -factor_;
    }
    int degree() const { return degree_; }
    double at(double x) const {
        // (1-x)^a (1+x)^b, a + b = l: of two equal powers the product is taken first.
        const int common = std::min(minus_, plus_);
        const double product = std::pow((1.0 - x) * (1.0 + x), 0.5 * common);
        const double rest = minus_ > plus_ ? 1.0 - x : 1.0 + x;
        return factor_ * product * std::pow(rest, 0.5 * (std::max(minus_, plus_) - common));
    }

  private:
    int minus_, plus_, degree_;
    double factor_;
};

// d^(l+1) = here (x - shift) d^l - before d^(l-1).
struct Step {
    double here, shift, before;
    Step(int m, int n, int l) {
        const double squares = double(m) * m, others = double(n) * n;
        const double after = (l + 1.0) * (l + 1.0);
        const double next = 1.0 / std::sqrt((after - squares) * (after - others));
        here = (2.0 * l + 1.0) * (l + 1.0) * next;
        shift = l > 0 ? double(m) * n / (double(l) * (l + 1.0)) : 0.0;
        const double square = double(l) * l;
        before = l > 0 ? (l + 1.0) / l * next *
                             std::sqrt(std::max(0.0, (square - squares) * (square - others)))
                       : 0.0;
    }
};

}  // namespace

void wigner_functions(int m, int n, int degrees, const Eigen::Ref<const Eigen::VectorXd>& cosine,
                      Eigen::MatrixXd& table) {
    const FirstDegree first(m, n);
    const int count = std::max(0, degrees - first.degree());
    table.resize(cosine.size(), count);
    if (count == 0) return;
    for (Eigen::Index p = 0; p < cosine.size(); ++p) table(p, 0) = first.at(cosine[p]);
    for (int column = 0; column + 1 < count; ++column) {
        const Step step(m, n, first.degree() + column);
        table.col(column + 1) =
            step.here * (cosine.array() - step.shift) * table.col(column).array();
        if (column > 0) table.col(column + 1) -= step.before * table.col(column - 1);
    }
}

double wigner_series(int m, int n, std::span<const double> coefficients, double x) {
    const FirstDegree first(m, n);
    double before = 0.0;
    double here = first.at(x);
    double sum = 0.0;
    for (std::size_t l = std::size_t(first.degree()); l < coefficients.size(); ++l) {
        sum += coefficients[l] * here;
        const Step step(m, n, int(l));
        const double next = step.here * (x - step.shift) * here - step.before * before;
        before = here;
        here = next;
    }
    return sum;
}

}  // namespace miebrdf::math
