#include "mie/sphere_block.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mie/absorption_source.h"
#include "mie/coefficients.h"
#include "mie/inside_wave.h"
#include "mie/lane_response.h"
#include "mie/lanes.h"
#include "mie/outside_waves.h"
#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

Lanes inside_parameter(double m, const Lanes& x) { return m * x; }
ComplexLanes inside_parameter(Complex m, const Lanes& x) { return {m.real() * x, m.imag() * x}; }

Lanes multiply(double m, const Lanes& z) { return m * z; }
ComplexLanes multiply(Complex m, const ComplexLanes& z) {
    return {m.real() * z.re - m.imag() * z.im, m.real() * z.im + m.imag() * z.re};
}

void store(const Lanes& values, double* to) {
    Eigen::Map<Lanes> target(to);
    target = values;
}

void store_waves(const ComplexLanes& a, const ComplexLanes& b, const Lanes& root_weight,
                 SphereBlock& block, int order, int column) {
    double* u = block.U.row(order).data() + column;
    double* v = block.V.row(order).data() + column;
    store(root_weight * (a.re + b.re), u);
    store(root_weight * (a.im + b.im), u + block.size);
    store(root_weight * (a.re - b.re), v);
    store(root_weight * (a.im - b.im), v + block.size);
}

Lanes dot(const ComplexLanes& u, const ComplexLanes& v) { return u.re * v.re + u.im * v.im; }

// The sums of SphereSums, before weights. Orders are added one after the other.
struct LaneSums {
    Lanes scattered = Lanes::Zero(), absorbed = Lanes::Zero(), asymmetric = Lanes::Zero();

    void add_asymmetry(int n, const ComplexLanes& a, const ComplexLanes& b) {
        asymmetric += (2 * n + 1) / (n * (n + 1.0)) * dot(a, b) +
                      (n - 1.0) * (n + 1.0) / n * (dot(a, a_before) + dot(b, b_before));
        a_before = a;
        b_before = b;
    }

    ComplexLanes a_before{Lanes::Zero(), Lanes::Zero()}, b_before = a_before;
};

void silence(Response& response, const Lanes& alive) {
    response.value = times(response.value, alive);
    response.inverse_norm *= alive;
}

// Eight spheres. Where to write: columns [column, column + 8) of block, or nowhere.
template <typename Number>
LaneSums compute_lanes(Number m, const Lanes& x, const Lanes& root_weight, SphereBlock* block,
                       int column) {
    Lanes last_order;
    for (int lane = 0; lane < lane_count; ++lane) last_order[lane] = number_of_terms(x[lane]);
    const int shortest = static_cast<int>(last_order.minCoeff());
    const int terms = static_cast<int>(last_order.maxCoeff());

    InsideWave<Number> inside(inside_parameter(m, x), terms);
    OutsideWaves outside(x);
    const Number m_minus_inverse = m - 1.0 / m;
    const double n_r = std::real(m), k = std::imag(m);
    std::conditional_t<std::is_same_v<Number, double>, int, std::optional<AbsorptionSource>>
        source{};
    if constexpr (!std::is_same_v<Number, double>) source.emplace(m, x, inside);

    LaneSums sums;
    Response a, b;
    for (int n = 1; n <= terms; ++n) {
        inside.advance();
        if (n <= shortest) {
            outside.advance(n);
        } else {
            outside.advance_some(n, last_order);
        }
        // Symbols of mie_coefficients, times P = psi_n(mx) and for a_n times m: with
        // D_n = Q/P - n/(mx), A = Q/m + n/x (1 - 1/m^2) P and B = m Q.
        const auto& P = inside.here();
        const auto& Q = inside.before();
        const Lanes n_over_x = n * outside.inverse_x;
        const auto A = plus(Q, times(multiply(m_minus_inverse, P), n_over_x));
        const auto mP = multiply(m, P);
        const auto B = multiply(m, Q);
        respond(minus(times(A, outside.psi), times(mP, outside.psi_before)),
                minus(times(A, outside.eta), times(mP, outside.eta_before)),
                minus(times(B, outside.psi), times(P, outside.psi_before)),
                minus(times(B, outside.eta), times(P, outside.eta_before)), a, b);
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
            const Lanes T = source->at(inside, n);
            const Lanes R = Q.re * P.re + Q.im * P.im;
            const Lanes electric =
                n_r * T - k * R + (2 * n_r * k / std::norm(m)) * n_over_x * norm(P);
            const Lanes magnetic = n_r * T + k * R;
            sums.absorbed -= degeneracy * (electric * a.inverse_norm + magnetic * b.inverse_norm);
        }
        sums.add_asymmetry(n, a.value, b.value);
        if (block) store_waves(a.value, b.value, root_weight, *block, n, column);
    }
    return sums;
}

// The path of single spheres, for sizes where the vector formulas lose digits.
LaneSums compute_small(Complex m, const Lanes& x, const Lanes& root_weight, SphereBlock* block,
                       int column) {
    LaneSums sums;
    for (int lane = 0; lane < lane_count; ++lane) {
        const Coefficients c = mie_coefficients(m, x[lane]);
        for (std::size_t i = 0; i < c.a.size(); ++i) {
            const double n = static_cast<double>(i + 1);
            const double degeneracy = 2 * n + 1;
            sums.scattered[lane] += degeneracy * (std::norm(c.a[i]) + std::norm(c.b[i]));
            sums.absorbed[lane] += degeneracy * c.absorbed[i];
            double across = degeneracy / (n * (n + 1)) * std::real(c.a[i] * std::conj(c.b[i]));
            if (i > 0) {
                across +=
                    (n - 1) * (n + 1) / n *
                    std::real(c.a[i] * std::conj(c.a[i - 1]) + c.b[i] * std::conj(c.b[i - 1]));
            }
            sums.asymmetric[lane] += across;
            if (!block) continue;
            const Complex u = root_weight[lane] * (c.a[i] + c.b[i]);
            const Complex v = root_weight[lane] * (c.a[i] - c.b[i]);
            const Eigen::Index row = static_cast<Eigen::Index>(i) + 1;
            block->U(row, column + lane) = u.real();
            block->U(row, column + lane + block->size) = u.imag();
            block->V(row, column + lane) = v.real();
            block->V(row, column + lane + block->size) = v.imag();
        }
    }
    return sums;
}

LaneSums compute_eight(Complex m, const Lanes& x, const Lanes& root_weight, SphereBlock* block,
                       int column) {
    if (block) {
        // Rows that these eight do not reach, but others of the block do.
        for (int n = number_of_terms(x[0]) + 1; n <= block->terms; ++n) {
            for (auto* wave : {&block->U, &block->V}) {
                wave->row(n).segment(column, lane_count).setZero();
                wave->row(n).segment(column + block->size, lane_count).setZero();
            }
        }
    }
    if (x[0] < 2) return compute_small(m, x, root_weight, block, column);
    if (m.imag() == 0) return compute_lanes(m.real(), x, root_weight, block, column);
    return compute_lanes(m, x, root_weight, block, column);
}

}  // namespace

void SphereSums::add(const SphereSums& other) {
    scattered += other.scattered;
    absorbed += other.absorbed;
    asymmetric += other.asymmetric;
}

void SphereSums::scale(double factor) {
    scattered *= factor;
    absorbed *= factor;
    asymmetric *= factor;
}

void SphereBlock::make_room(int new_terms, int new_size) {
    terms = new_terms;
    size = new_size;
    if (U.rows() >= terms + 1 && U.cols() == 2 * size) return;
    U.resize(terms + 1, 2 * size);
    V.resize(terms + 1, 2 * size);
}

SphereSums compute_spheres(Complex relative_index, std::span<const double> size_parameters,
                           std::span<const double> weights, SphereBlock* block) {
    const int count = static_cast<int>(size_parameters.size());
    SphereSums total;
    if (block) {
        block->make_room(number_of_terms(size_parameters[count - 1]),
                         (count + lane_count - 1) / lane_count * lane_count);
    }
    for (int first = 0; first < count; first += lane_count) {
        Lanes x, weight;
        for (int lane = 0; lane < lane_count; ++lane) {
            const int i = std::min(first + lane, count - 1);  // the last one fills up, unweighted
            x[lane] = size_parameters[i];
            weight[lane] = first + lane < count ? weights[i] : 0.0;
        }
        const LaneSums sums = compute_eight(relative_index, x, weight.sqrt(), block, first);
        total.scattered += (weight * sums.scattered).sum();
        total.absorbed += (weight * sums.absorbed).sum();
        total.asymmetric += (weight * sums.asymmetric).sum();
    }
    return total;
}

}  // namespace miebrdf::mie
