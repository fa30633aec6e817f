#include "mie/spheroid/orientation_average.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>

#include "rte/math/quadrature.h"
#include "rte/math/wigner.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Complex power_of_i(int n) {
    constexpr std::array<Complex, 4> kPowers = {Complex(1), Complex(0, 1), Complex(-1),
                                                Complex(0, -1)};
    return kPowers[std::size_t((n % 4 + 4) % 4)];
}

// Scattered light of the incident helicity and of the other one.
struct Helicities {
    MatrixXcd same, other;
};

// With d^n_mk of Wigner, incident helicity +1, beta the polar angle of the particle's axis and
// theta the scattering angle, the part of the amplitude that goes with exp(i M phi) is
//     S^M = sum_n (-i)^n sqrt(2n+1) d^n_M,h(theta) sum_m d^n_mM(beta) U_nm(beta),
//     U_nm = sum_n' T_m,nn' i^n' sqrt(2n'+1) d^n'_m1(beta),
// T = T11 + T22 + T12 + T21 for the same helicity, h = 1, and T22 + T21 - T12 - T11 for the other,
// h = -1. Mirrored, incident helicity -1 gives the same with -M.
class RotatedParticle {
  public:
    RotatedParticle(const TMatrix& T, const VectorXd& beta)
        : degree_(T.degree), beta_(beta), incident_(std::size_t(2 * degree_ + 1)) {
        for (int m = -degree_; m <= degree_; ++m) {
            const int first = std::max(std::abs(m), 1), count = degree_ - first + 1;
            const MatrixXcd& all = T.orders[std::size_t(std::abs(m))];
            const double sign = m < 0 ? -1 : 1;  // of the blocks beside the diagonal
            const auto T11 = all.topLeftCorner(count, count);
            const auto T12 = sign * all.topRightCorner(count, count);
            const auto T21 = sign * all.bottomLeftCorner(count, count);
            const auto T22 = all.bottomRightCorner(count, count);
            MatrixXd d;
            math::wigner_functions(m, 1, degree_ + 1, beta_, d);
            MatrixXcd wave = d.cast<Complex>();
            for (int n = first; n <= degree_; ++n)
                wave.col(n - first) *= power_of_i(n) * std::sqrt(2.0 * n + 1);
            incident_[index(m)] = {wave * (T11 + T22 + T12 + T21).transpose(),
                                   wave * (T22 + T21 - T12 - T11).transpose()};
        }
    }

    /// S^M; row = beta, column = theta. Zero for |M| above the degree.
    Helicities amplitudes(int M, const VectorXd& cosines) const {
        const int first = std::max(std::abs(M), 1), count = degree_ - first + 1;
        Helicities sum;
        if (count <= 0) {
            sum.same = sum.other = MatrixXcd::Zero(beta_.size(), cosines.size());
            return sum;
        }
        sum.same = sum.other = MatrixXcd::Zero(beta_.size(), count);
        MatrixXd d;
        for (int m = -degree_; m <= degree_; ++m) {
            math::wigner_functions(m, M, degree_ + 1, beta_, d);
            const Helicities& incident = incident_[index(m)];
            const Eigen::Index shared =
                std::min<Eigen::Index>({d.cols(), incident.same.cols(), Eigen::Index(count)});
            const auto functions = d.rightCols(shared).array();
            sum.same.rightCols(shared).array() +=
                functions * incident.same.rightCols(shared).array();
            sum.other.rightCols(shared).array() +=
                functions * incident.other.rightCols(shared).array();
        }
        for (int n = first; n <= degree_; ++n) {
            const Complex factor = power_of_i(-n) * std::sqrt(2.0 * n + 1);
            sum.same.col(n - first) *= factor;
            sum.other.col(n - first) *= factor;
        }
        math::wigner_functions(M, 1, degree_ + 1, cosines, d);
        sum.same = sum.same * d.rightCols(count).transpose();
        math::wigner_functions(M, -1, degree_ + 1, cosines, d);
        sum.other = sum.other * d.rightCols(count).transpose();
        return sum;
    }

  private:
    std::size_t index(int m) const { return std::size_t(m + degree_); }

    int degree_;
    VectorXd beta_;
    std::vector<Helicities> incident_;
};

}  // namespace

Eigen::MatrixXd orientation_average(const TMatrix& T, const VectorXd& cosines) {
    // Products of two amplitudes have degree 4 T.degree in cos beta.
    const int nodes = T.degree + 1;
    const math::Quadrature rule = math::gauss_legendre(2 * nodes);
    const VectorXd beta = Eigen::Map<const VectorXd>(rule.nodes.data() + nodes, nodes);
    const Eigen::RowVectorXd weights =
        Eigen::Map<const Eigen::RowVectorXd>(rule.weights.data() + nodes, nodes);
    const RotatedParticle particle(T, beta);
    MatrixXd result = MatrixXd::Zero(cosines.size(), 6);
    const auto mean = [&](const auto& values) {
        return (weights * values.matrix()).transpose().eval();
    };
    // The azimuth of the axis leaves products of amplitudes with M - 1 and the incident helicity -1
    // with M' + 1 = M - 1: M = 1 + j and, mirrored, 1 - j.
    for (int j = 0; j <= T.degree + 1; ++j) {
        const Helicities up = particle.amplitudes(1 + j, cosines);
        const Helicities down = j == 0 ? up : particle.amplitudes(1 - j, cosines);
        for (const auto& [here, there] : {std::pair{&up, &down}, std::pair{&down, &up}}) {
            const auto same = here->same.array(), other = here->other.array();
            const auto opposite = there->same.array(), opposite_other = there->other.array();
            const VectorXd p = mean(same.abs2()), q = mean(other.abs2());
            const VectorXd pairs = mean((same * opposite.conjugate()).real());
            const VectorXd others = mean((other * opposite_other.conjugate()).real());
            result.col(0) += p + q;
            result.col(1) += p - q;
            result.col(2) += 2 * pairs;
            result.col(3) += 2 * others;
            const auto crossed = (same * opposite_other.conjugate()).real().eval();
            result.col(4) -= 2 * mean(crossed);
            result.col(5) += 2 * mean((same * other.conjugate()).imag());
            if (j == 0) break;
        }
    }
    return result;
}

}  // namespace miebrdf::mie
