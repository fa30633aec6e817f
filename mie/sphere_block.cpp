#include "mie/sphere_block.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mie/coefficients.h"
#include "mie/inside_wave.h"
#include "mie/lanes.h"
#include "mie/terms.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// Riccati-Bessel functions of the lanes' size parameters, upward (radial_functions.h has the care
// that single spheres get; here psi_n beyond n = x carries an absolute error of rounding).
struct OutsideWaves {
    explicit OutsideWaves(const Lanes& x) : inverse_x(1 / x) {
        for (int lane = 0; lane < lane_count; ++lane) {
            psi[lane] = std::sin(x[lane]);
            psi_before[lane] = std::cos(x[lane]);
        }
        eta = -psi_before;
        eta_before = psi;
    }

    void advance(int order) {
        const Lanes factor = (2 * order - 1) * inverse_x;
        const Lanes next_psi = factor * psi - psi_before;
        const Lanes next_eta = factor * eta - eta_before;
        psi_before = psi;
        eta_before = eta;
        psi = next_psi;
        eta = next_eta;
    }

    // Lanes that are past their own last term stop, before eta_n overflows.
    void advance_some(int order, const Lanes& last_order) {
        const OutsideWaves old = *this;
        advance(order);
        const auto going = last_order >= order;
        psi = going.select(psi, old.psi);
        eta = going.select(eta, old.eta);
        psi_before = going.select(psi_before, old.psi_before);
        eta_before = going.select(eta_before, old.eta_before);
    }

    Lanes inverse_x, psi, psi_before, eta, eta_before;
};

// a_n or b_n: p / (p + i q), and 1 / |p + i q|^2 for the absorption.
struct Response {
    ComplexLanes value;
    Lanes inverse_norm;
};

// Both at once: they share the one division.
void respond(const Lanes& pa, const Lanes& qa, const Lanes& pb, const Lanes& qb, Response& a,
             Response& b) {
    const Lanes norm_a = pa * pa + qa * qa;
    const Lanes norm_b = pb * pb + qb * qb;
    const Lanes shared = 1 / (norm_a * norm_b);
    const Lanes factor_a = pa * norm_b * shared;
    const Lanes factor_b = pb * norm_a * shared;
    a.value = {pa * factor_a, -qa * factor_a};
    b.value = {pb * factor_b, -qb * factor_b};
}

void respond(const ComplexLanes& pa, const ComplexLanes& qa, const ComplexLanes& pb,
             const ComplexLanes& qb, Response& a, Response& b) {
    const ComplexLanes da = {pa.re - qa.im, pa.im + qa.re};
    const ComplexLanes db = {pb.re - qb.im, pb.im + qb.re};
    const Lanes norm_a = norm(da);
    const Lanes norm_b = norm(db);
    const Lanes shared = 1 / (norm_a * norm_b);
    a.inverse_norm = norm_b * shared;
    b.inverse_norm = norm_a * shared;
    a.value = {(pa.re * da.re + pa.im * da.im) * a.inverse_norm,
               (pa.im * da.re - pa.re * da.im) * a.inverse_norm};
    b.value = {(pb.re * db.re + pb.im * db.im) * b.inverse_norm,
               (pb.im * db.re - pb.re * db.im) * b.inverse_norm};
}

// T_n = Im(psi_{n-1} conj psi_n)(mx), the source of all absorption. Summed upward,
//     T_{n+1} = T_n + (2n + 1) |psi_n|^2 Im z / |z|^2,  T_0 = -sinh(2 Im z) / 2,
// it keeps its digits however small k is, which the product itself does not.
class AbsorptionSource {
  public:
    AbsorptionSource(Complex m, const Lanes& x, const InsideWave<Complex>& inside) {
        const Lanes y = m.imag() * x;
        summed_ = y.maxCoeff() < 1;  // beyond, the product has lost nothing
        if (!summed_) return;
        slope_ = y * norm(inside.inverse_z());
        const Lanes scale = (norm(inside.first()) + norm(inside.before_first())) / (2 * y).cosh();
        T_ = -0.5 * scale * (2 * y).sinh() + norm(inside.first()) * slope_;
    }

    Lanes at(const InsideWave<Complex>& inside, int order) {
        const ComplexLanes& P = inside.here();
        const ComplexLanes& Q = inside.before();
        if (!summed_) return Q.im * P.re - Q.re * P.im;
        const Lanes T = T_;
        T_ += (2 * order + 1) * norm(P) * slope_;
        if (const Lanes* change = inside.change_of_scale()) T_ *= change->square();
        return T;
    }

  private:
    bool summed_ = false;
    Lanes slope_, T_;
};

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

struct LaneSums {
    Lanes scattered = Lanes::Zero(), absorbed = Lanes::Zero(), asymmetric = Lanes::Zero();
};

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
    ComplexLanes a_before{Lanes::Zero(), Lanes::Zero()}, b_before = a_before;
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
            a.value = times(a.value, alive);
            b.value = times(b.value, alive);
            a.inverse_norm *= alive;
            b.inverse_norm *= alive;
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
        const auto dot = [](const ComplexLanes& u, const ComplexLanes& v) -> Lanes {
            return u.re * v.re + u.im * v.im;
        };
        sums.asymmetric +=
            degeneracy / (n * (n + 1.0)) * dot(a.value, b.value) +
            (n - 1.0) * (n + 1.0) / n * (dot(a.value, a_before) + dot(b.value, b_before));
        a_before = a.value;
        b_before = b.value;
        if (!block) continue;
        store_waves(a.value, b.value, root_weight, *block, n, column);
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
