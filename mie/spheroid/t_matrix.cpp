#include "mie/spheroid/t_matrix.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mie/sphere/radial_functions.h"
#include "mie/spheroid/regular_products.h"
#include "rte/math/legendre.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using Eigen::ArrayXcd;
using Eigen::ArrayXd;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

constexpr Complex kI{0.0, 1.0};

struct DegreeRule {
    /// Where the search begins: Wiscombe's number of terms for the larger axis.
    static constexpr double kEdge = 4.05;
    static constexpr int kLeast = 4, kMost = 110;
    /// Steps without a fall by half: high indices need more degrees than the edge says.
    static constexpr int kPatience = 4;
    /// Nodes of the upper half for a degree: the integrands have their poles at
    /// 1 / sqrt(1 - aspect^2) or i / sqrt(aspect^2 - 1) in cos theta (rho = 1.4 for 1/3 and 3).
    static constexpr double kNodesPerDegree = 1.25;
    static constexpr int kFewestNodes = 24;
};

// The upper half of the surface at Gauss nodes in cos theta, both halves in the weights.
struct Surface {
    ArrayXd cosine, sine, weight, x, slope;  // x = k r, slope = dx / dtheta

    Surface(const Spheroid& spheroid, int nodes) {
        const double polar = spheroid.size_parameter / std::pow(spheroid.aspect, 2.0 / 3.0);
        const double equatorial = polar * spheroid.aspect;
        const math::Quadrature rule = math::gauss_legendre(2 * nodes);
        cosine = Eigen::Map<const ArrayXd>(rule.nodes.data(), 2 * nodes).tail(nodes);
        weight = 2 * Eigen::Map<const ArrayXd>(rule.weights.data(), 2 * nodes).tail(nodes);
        sine = ((1 - cosine) * (1 + cosine)).sqrt();
        const double difference =
            (equatorial - polar) * (equatorial + polar) / std::pow(equatorial * polar, 2);
        x = (1 / (equatorial * equatorial) + cosine.square() * difference).rsqrt();
        slope = x.cube() * cosine * sine * difference;
    }
};

// The radial parts of the integrands of P (with psi_n outside) and Y (with eta_n), Q = P + iY, each
// times x, for all n and k: columns Re P, Im P, Re Y, Im Y of each function.
//   n + k odd:   psi_k' f_n, psi_k f_n'
//   n + k even:  psi_k f_n, psi_k' f_n', psi_k f_n / (s x^2)
//   n = k:       psi f' - s psi' f, s psi f' - psi' f (both without x), psi f / (s x^2)
class RadialIntegrands {
  public:
    RadialIntegrands(const Spheroid& spheroid, const Surface& surface, int degree)
        : degree_(degree), columns_(std::size_t(degree) * degree) {
        const Complex s = spheroid.relative_index;
        const RadialProducts products(s, surface.x, degree + 1);
        const auto inside = inner_functions(s * surface.x.cast<Complex>(), degree + 1);
        Eigen::ArrayXXd psi(surface.x.size(), degree + 2), eta = psi;
        for (Eigen::Index p = 0; p < surface.x.size(); ++p) {
            const RadialFunctions functions = radial_functions(surface.x[p], degree + 1);
            for (int n = 0; n <= degree + 1; ++n) {
                psi(p, n) = functions.psi[n];
                eta(p, n) = functions.eta[n];
            }
        }
        const auto whole = [&](int n, int k) -> const ArrayXcd& { return products.whole(n, k); };
        const auto of_psi = [&](int n, int k) -> ArrayXcd {
            return (surface.x * psi.col(n)).cast<Complex>() * inside.col(k);
        };
        for (int n = 1; n <= degree; ++n) {
            for (int k = 1; k <= degree; ++k) {
                MatrixXd& columns = columns_[place(n, k)];
                if (n == k) {
                    columns.resize(surface.x.size(), 12);
                    put_diagonal(columns, 0, psi, inside, n, s);
                    put_diagonal(columns, 2, eta, inside, n, s);
                    put(columns, 8, over_square(of_psi, n, k));
                    put(columns, 10, over_square(whole, n, k));
                    continue;
                }
                const std::vector<ArrayXcd> P = functions(of_psi, n, k);
                std::vector<ArrayXcd> Y = functions(whole, n, k);
                // Both integrate to the same: the one with less to cancel is taken.
                std::vector<ArrayXcd> regular = functions(
                    [&](int i, int j) -> const ArrayXcd& { return products.regular(i, j); }, n, k);
                if (n > k && size_of(regular, n, k) < size_of(Y, n, k)) Y = std::move(regular);
                columns.resize(surface.x.size(), Eigen::Index(4 * P.size()));
                for (std::size_t i = 0; i < P.size(); ++i) {
                    put(columns, Eigen::Index(4 * i), P[i]);
                    put(columns, Eigen::Index(4 * i + 2), Y[i]);
                }
            }
        }
    }

    const MatrixXd& at(int n, int k) const { return columns_[place(n, k)]; }

  private:
    std::size_t place(int n, int k) const { return std::size_t(n - 1) * degree_ + k - 1; }

    static void put(MatrixXd& columns, Eigen::Index first, const ArrayXcd& values) {
        columns.col(first) = values.real();
        columns.col(first + 1) = values.imag();
    }
    static void put_diagonal(MatrixXd& columns, Eigen::Index first, const Eigen::ArrayXXd& f,
                             const Eigen::ArrayXXcd& inside, int n, Complex s) {
        const double all = 2 * n + 1;
        const ArrayXcd slope = (((n + 1) * f.col(n - 1) - n * f.col(n + 1)) / all).cast<Complex>();
        const ArrayXcd inner = ((n + 1.0) * inside.col(n - 1) - n * inside.col(n + 1)) / all;
        const ArrayXcd a = inside.col(n) * slope, b = inner * f.col(n).cast<Complex>();
        put(columns, first, a - s * b);
        put(columns, first + 4, s * a - b);
    }
    // f_n / x and psi_k / (s x) as sums of the neighbours: what has no negative powers keeps none.
    template <typename Product>
    static ArrayXcd over_square(const Product& F, int n, int k) {
        return (F(n - 1, k - 1) + F(n - 1, k + 1) + F(n + 1, k - 1) + F(n + 1, k + 1)) /
               double((2 * n + 1) * (2 * k + 1));
    }
    template <typename Product>
    static std::vector<ArrayXcd> functions(const Product& F, int n, int k) {
        const double N = 2 * n + 1, K = 2 * k + 1;
        if ((n + k) % 2 != 0)
            return {((k + 1.0) * F(n, k - 1) - k * F(n, k + 1)) / K,
                    ((n + 1.0) * F(n - 1, k) - n * F(n + 1, k)) / N};
        return {F(n, k),
                ((n + 1.0) * ((k + 1.0) * F(n - 1, k - 1) - k * F(n - 1, k + 1)) -
                 n * ((k + 1.0) * F(n + 1, k - 1) - k * F(n + 1, k + 1))) /
                    (N * K),
                over_square(F, n, k)};
    }
    static double size_of(const std::vector<ArrayXcd>& functions, int n, int k) {
        double size = 0;
        for (std::size_t i = 0; i < functions.size(); ++i)
            size += (i == 2 ? double(n) * k : 1.0) * functions[i].abs().maxCoeff();
        return size;
    }

    int degree_;
    std::vector<MatrixXd> columns_;
};

// P and Q of one azimuthal order.
struct Matrices {
    MatrixXcd P, Q;
};

// Y_n^m (legendre.h) and its derivative by theta, column n - first; and m over sine.
struct AngularPart {
    MatrixXd d, tau;
    int first;

    AngularPart(const Surface& surface, int m, int degree) : first(std::max(m, 1)) {
        MatrixXd table;
        math::legendre_functions(m, degree + 1, surface.cosine.matrix(), table);
        const Eigen::Index count = degree - first + 1;
        d = table.rightCols(count);
        tau.resize(d.rows(), count);
        for (int n = first; n <= degree; ++n) {
            const Eigen::Index column = n - m;
            tau.col(n - first) = n * surface.cosine * table.col(column).array() / surface.sine;
            if (n > m)
                tau.col(n - first).array() -= std::sqrt(double(n - m) * (n + m)) *
                                              table.col(column - 1).array() / surface.sine;
        }
    }
};

// The surface integrals in the forms of RadialIntegrands, whose equations are derived in
// docs/maths-spheroids.md: with a_nk = sqrt of (2n+1)(2k+1) / (4 n(n+1) k(k+1)), D = n(n+1) -
// k(k+1), weights dx/dtheta sin theta,
//   Q12 = i m (s^2-1)/s a int d_n d_k / sin  psi_k' f_n,   Q21 = -i m (s^2-1)/s a int ... psi_k
//   f_n' Q11 = -(s^2-1)/(s D) a int [n(n+1) d_n tau_k - k(k+1) tau_n d_k] psi_k f_n Q22 =
//   -(s^2-1)/(s D) a int [n(n+1) d_n tau_k - k(k+1) tau_n d_k] psi_k' f_n'
//                              + n(n+1) k(k+1) (d_n tau_k - tau_n d_k) psi_k f_n / (s x^2)
Matrices integrate(const RadialIntegrands& radial, const Surface& surface, Complex s, int m,
                   int degree) {
    const AngularPart angular(surface, m, degree);
    const int first = angular.first, count = degree - first + 1;
    Matrices result{MatrixXcd::Zero(2 * count, 2 * count), MatrixXcd::Zero(2 * count, 2 * count)};
    // The tables carry a factor x.
    const ArrayXd along = surface.weight * surface.slope / surface.x;
    const ArrayXd across = along / surface.sine;
    const Complex contrast = (s * s - 1.0) / s;
    const auto put = [&](int row, int column, const auto& sums, Complex factor) {
        const Complex p(sums[0], sums[1]), y(sums[2], sums[3]);
        result.P(row, column) += factor * p;
        result.Q(row, column) += factor * (p + kI * y);
    };
    for (int i = 0; i < count; ++i) {
        const int n = first + i;
        const double N = double(n) * (n + 1);
        const auto d_n = angular.d.col(i).array(), tau_n = angular.tau.col(i).array();
        for (int j = 0; j < count; ++j) {
            const int k = first + j;
            const double K = double(k) * (k + 1);
            const double a = std::sqrt((2 * n + 1) * (2 * k + 1) / (4 * N * K));
            const auto d_k = angular.d.col(j).array(), tau_k = angular.tau.col(j).array();
            const MatrixXd& functions = radial.at(n, k);
            if ((n + k) % 2 != 0) {
                if (m == 0) continue;
                const Eigen::RowVectorXd sums =
                    (across * d_n * d_k).matrix().transpose() * functions;
                put(i, count + j, sums.head(4), kI * (m * a) * contrast);
                put(count + i, j, sums.segment(4, 4), -kI * (m * a) * contrast);
                continue;
            }
            const ArrayXd one = along * d_n * tau_k, other = along * tau_n * d_k;
            if (n != k) {
                const Complex factor = -contrast * a / (N - K);
                const Eigen::RowVectorXd sums =
                    (N * one - K * other).matrix().transpose() * functions.leftCols(8);
                const Eigen::RowVectorXd rest =
                    (one - other).matrix().transpose() * functions.rightCols(4);
                put(i, j, sums.head(4), factor);
                put(count + i, count + j, sums.tail(4), factor);
                put(count + i, count + j, rest, factor * N * K);
                continue;
            }
            const ArrayXd pairs =
                surface.weight * (tau_n.square() + (m * d_n / surface.sine).square());
            const Eigen::RowVectorXd sums = pairs.matrix().transpose() * functions.leftCols(8);
            const Eigen::RowVectorXd rest = one.matrix().transpose() * functions.rightCols(4);
            put(i, i, sums.head(4), a / s);
            put(count + i, count + i, sums.tail(4), a / s);
            put(count + i, count + i, rest, contrast * N * a);
        }
    }
    return result;
}

// -P Q^-1 of the first `count` degrees. Light of either parity about the equator stays with its
// own; rows and columns are scaled, because degrees differ by many orders of magnitude.
MatrixXcd transition(const Matrices& matrices, int count) {
    const auto all = matrices.P.rows() / 2;
    MatrixXcd T = MatrixXcd::Zero(2 * count, 2 * count);
    for (int parity = 0; parity < 2; ++parity) {
        std::vector<Eigen::Index> from, to;
        for (int i = 0; i < count; ++i) {
            const bool electric = i % 2 != parity;
            from.push_back(electric ? all + i : i);
            to.push_back(electric ? count + i : i);
        }
        MatrixXcd P = matrices.P(from, from), Q = matrices.Q(from, from);
        for (int column = 0; column < count; ++column) {
            const double scale = 1 / P.col(column).cwiseAbs().maxCoeff();
            P.col(column) *= scale;
            Q.col(column) *= scale;
        }
        const Eigen::ArrayXd rows = Q.cwiseAbs().rowwise().maxCoeff().array().inverse();
        Q = rows.matrix().asDiagonal() * Q;
        const MatrixXcd transposed = Q.transpose().partialPivLu().solve(P.transpose());
        const MatrixXcd here = -transposed.transpose() * rows.matrix().asDiagonal();
        for (int i = 0; i < count; ++i)
            for (int j = 0; j < count; ++j) T(to[i], to[j]) = here(i, j);
    }
    return T;
}

struct CrossSections {
    double extinction = 0, scattering = 0;
    void add(const MatrixXcd& T, int m) {
        const double twice = m == 0 ? 1 : 2;
        extinction -= twice * T.trace().real();
        scattering += twice * T.squaredNorm();
    }
};

// The largest breach of T11 = T11^t, T22 = T22^t, T12 = -T21^t.
double asymmetry(const MatrixXcd& T) {
    const auto S = T.rows() / 2;
    const auto largest = [](const auto& matrix) { return matrix.cwiseAbs().maxCoeff(); };
    return std::max({largest(T.topLeftCorner(S, S) - T.topLeftCorner(S, S).transpose()),
                     largest(T.bottomRightCorner(S, S) - T.bottomRightCorner(S, S).transpose()),
                     largest(T.topRightCorner(S, S) + T.bottomLeftCorner(S, S).transpose())});
}

}  // namespace

double Spheroid::largest_x() const {
    return size_parameter * std::pow(aspect, aspect < 1 ? -2.0 / 3.0 : 1.0 / 3.0);
}

TMatrix t_matrix_of_degree(const Spheroid& spheroid, int degree, int nodes) {
    if (nodes == 0) nodes = DegreeRule::kFewestNodes + int(DegreeRule::kNodesPerDegree * degree);
    const Surface surface(spheroid, nodes);
    const RadialIntegrands radial(spheroid, surface, degree);
    TMatrix result;
    result.degree = degree;
    CrossSections here, before;
    double broken = 0, largest = 0;
    for (int m = 0; m <= degree; ++m) {
        const Matrices matrices = integrate(radial, surface, spheroid.relative_index, m, degree);
        const int count = int(matrices.P.rows() / 2);
        result.orders.push_back(transition(matrices, count));
        const MatrixXcd& T = result.orders.back();
        here.add(T, m);
        if (count > 2) before.add(transition(matrices, count - 2), m);
        broken = std::max(broken, asymmetry(T));
        largest = std::max(largest, T.cwiseAbs().maxCoeff());
    }
    const double scale = 2 / std::pow(spheroid.size_parameter, 2);
    result.q_ext = scale * here.extinction;
    result.q_sca = scale * here.scattering;
    result.error_estimate =
        std::max({std::abs(before.extinction / here.extinction - 1),
                  std::abs(before.scattering / here.scattering - 1), broken / largest});
    if (spheroid.relative_index.imag() == 0)
        result.error_estimate =
            std::max(result.error_estimate, std::abs(here.extinction / here.scattering - 1));
    if (!std::isfinite(result.error_estimate)) result.error_estimate = 1;
    return result;
}

TMatrix t_matrix(const Spheroid& spheroid, double tolerance) {
    const double x = spheroid.largest_x();
    int degree = std::max(DegreeRule::kLeast, int(x + DegreeRule::kEdge * std::cbrt(x) + 2));
    TMatrix best = t_matrix_of_degree(spheroid, degree);
    for (int stalled = 0; !(best.error_estimate <= tolerance) && stalled < DegreeRule::kPatience;) {
        degree += std::max(2, degree / 8);
        if (degree > DegreeRule::kMost) break;
        TMatrix next = t_matrix_of_degree(spheroid, degree);
        stalled = next.error_estimate < 0.5 * best.error_estimate ? 0 : stalled + 1;
        if (next.error_estimate < best.error_estimate) best = std::move(next);
    }
    return best;
}

}  // namespace miebrdf::mie
