#include "mie/sphere/sphere_lanes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "mie/sphere/absorption_source.h"
#include "mie/sphere/coefficients.h"
#include "mie/sphere/inside_wave.h"
#include "mie/sphere/lane_response.h"
#include "mie/sphere/outside_waves.h"
#include "mie/sphere/terms.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

Lanes inside_parameter(double m, const Lanes& x) { return m * x; }
ComplexLanes inside_parameter(Complex m, const Lanes& x) { return {m.real() * x, m.imag() * x}; }

template <typename Scalar>
void store(const Lanes& values, Scalar* to) {
    Eigen::Map<Eigen::Array<Scalar, lane_count, 1>> target(to);
    target = values.cast<Scalar>();
}

Lanes dot(const ComplexLanes& u, const ComplexLanes& v) { return u.re * v.re + u.im * v.im; }

// x^2 g Q_sca / 4 (Bohren & Huffman 1983, sect. 4.5), order after order.
class Asymmetry {
  public:
    Lanes next(int n, const ComplexLanes& a, const ComplexLanes& b) {
        const Lanes across = (2 * n + 1) / (n * (n + 1.0)) * dot(a, b) +
                             (n - 1.0) * (n + 1.0) / n * (dot(a, a_before_) + dot(b, b_before_));
        a_before_ = a;
        b_before_ = b;
        return across;
    }

  private:
    ComplexLanes a_before_{Lanes::Zero(), Lanes::Zero()}, b_before_ = a_before_;
};

void silence(Response& response, const Lanes& alive) {
    response.value = times(response.value, alive);
    response.inverse_norm *= alive;
}

template <typename Number, typename Scalar>
LaneSums by_vectors(Number m, const Lanes& x, const BlockColumns<Scalar>& to) {
    Lanes last_order;
    for (int lane = 0; lane < lane_count; ++lane) last_order[lane] = number_of_terms(x[lane]);
    const int shortest = static_cast<int>(last_order.minCoeff());
    const int terms = static_cast<int>(last_order.maxCoeff());

    InsideWave<Number> inside(inside_parameter(m, x), terms);
    OutsideWaves outside(x);
    const Boundary<Number> boundary(m);
    std::conditional_t<std::is_same_v<Number, double>, int, std::optional<AbsorptionSource>>
        source{};
    if constexpr (!std::is_same_v<Number, double>) source.emplace(m, x, inside);

    LaneSums sums;
    Asymmetry asymmetry;
    Response a, b;
    for (int n = 1; n <= terms; ++n) {
        inside.advance();
        if (n <= shortest) {
            outside.advance(n);
        } else {
            outside.advance_some(n, last_order);
        }
        const auto& P = inside.here();
        const auto& Q = inside.before();
        const Lanes n_over_x = n * outside.inverse_x;
        boundary.scatter(P, Q, outside.psi, outside.psi_before, outside.eta, outside.eta_before,
                         n_over_x, a, b);
        if (n > shortest) {
            const Lanes alive = (last_order >= n).select(Lanes::Ones(), Lanes::Zero());
            silence(a, alive);
            silence(b, alive);
        }

        const double degeneracy = 2 * n + 1;
        if constexpr (std::is_same_v<Number, double>) {
            sums.scattered += degeneracy * (a.value.re + b.value.re);
        } else {
            sums.scattered += degeneracy * (norm(a.value) + norm(b.value));
            sums.absorbed +=
                degeneracy * boundary.absorbed(P, Q, source->at(inside, n), n_over_x, a, b);
        }
        sums.asymmetric += asymmetry.next(n, a.value, b.value);
        if (to.block) to.put(n, a.value, b.value);
    }
    return sums;
}

// The path of single spheres, for sizes where the vector formulas lose digits.
template <typename Scalar>
LaneSums one_by_one(Complex m, const Lanes& x, const BlockColumns<Scalar>& to) {
    Coefficients spheres[lane_count];
    std::size_t terms = 0;
    for (int lane = 0; lane < lane_count; ++lane) {
        spheres[lane] = mie_coefficients(m, x[lane]);
        terms = std::max(terms, spheres[lane].a.size());
    }
    LaneSums sums;
    Asymmetry asymmetry;
    for (std::size_t i = 0; i < terms; ++i) {
        ComplexLanes a{Lanes::Zero(), Lanes::Zero()}, b = a;
        Lanes absorbed = Lanes::Zero();
        for (int lane = 0; lane < lane_count; ++lane) {
            const Coefficients& c = spheres[lane];
            if (i >= c.a.size()) continue;
            a.re[lane] = c.a[i].real();
            a.im[lane] = c.a[i].imag();
            b.re[lane] = c.b[i].real();
            b.im[lane] = c.b[i].imag();
            absorbed[lane] = c.absorbed[i];
        }
        const int n = static_cast<int>(i) + 1;
        sums.scattered += (2 * n + 1) * (norm(a) + norm(b));
        sums.absorbed += (2 * n + 1) * absorbed;
        sums.asymmetric += asymmetry.next(n, a, b);
        if (to.block) to.put(n, a, b);
    }
    return sums;
}

}  // namespace

template <typename Scalar>
void BlockColumns<Scalar>::put(int order, const ComplexLanes& a, const ComplexLanes& b) const {
    Scalar* u = block->U.row(order).data() + first;
    Scalar* v = block->V.row(order).data() + first;
    store(root_weight * (a.re + b.re), u);
    store(root_weight * (a.im + b.im), u + block->size);
    store(root_weight * (a.re - b.re), v);
    store(root_weight * (a.im - b.im), v + block->size);
}

template <typename Scalar>
void BlockColumns<Scalar>::clear_beyond(int order) const {
    for (int n = order + 1; n <= block->terms; ++n) {
        for (auto* wave : {&block->U, &block->V}) {
            wave->row(n).segment(first, lane_count).setZero();
            wave->row(n).segment(first + block->size, lane_count).setZero();
        }
    }
}

template <typename Scalar>
LaneSums compute_eight(Complex m, const Lanes& x, const BlockColumns<Scalar>& to) {
    if (to.block) to.clear_beyond(number_of_terms(x[0]));
    if (x[0] < 2) return one_by_one(m, x, to);
    if (m.imag() == 0) return by_vectors(m.real(), x, to);
    return by_vectors(m, x, to);
}

template LaneSums compute_eight(Complex, const Lanes&, const BlockColumns<float>&);
template LaneSums compute_eight(Complex, const Lanes&, const BlockColumns<double>&);

}  // namespace miebrdf::mie
