#include "mie/sphere/sphere_block.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include <miebrdf/sphere.h>
#include "mie/sphere/faint_absorption.h"
#include "mie/sphere/lane_layers.h"
#include "mie/sphere/lane_waves.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

/// The sums of SphereSums for each lane, before weights. Orders are added one after the other.
struct LaneSums {
    Lanes scattered = Lanes::Zero(), absorbed = Lanes::Zero(), asymmetric = Lanes::Zero();
};

/// The eight columns of a block that the eight spheres fill, or none.
template <typename Scalar>
struct BlockColumns {
    void put(int order, const ComplexLanes& a, const ComplexLanes& b) const;
    /// Rows that these eight do not reach, but others of the block do.
    void clear_beyond(int order) const;

    SphereBlockOf<Scalar>* block;  // null: nowhere
    int first;
    Lanes root_weight;
};

template <typename Scalar>
void put_lanes(const Lanes& values, Scalar* to) {
    Eigen::Map<Eigen::Array<Scalar, kLaneCount, 1>> target(to);
    target = values.cast<Scalar>();
}

Lanes dot(const ComplexLanes& u, const ComplexLanes& v) { return u.re * v.re + u.im * v.im; }

// x^2 g Q_sca / 4 (Bohren & Huffman 1983, sect. 4.5), order after order.
class Asymmetry {
  public:
    Lanes next(int n, const ComplexLanes& a, const ComplexLanes& b) {
        Lanes across = (2 * n + 1) / (n * (n + 1.0)) * dot(a, b) +
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
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
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

std::vector<LaneLayer> lane_layers(const Scatterer& scatterer, const Lanes& x) {
    std::vector<LaneLayer> layers = {{scatterer.relative_index, x}};
    for (const Scatterer::Coating& coating : scatterer.coatings)
        layers.push_back({coating.relative_index,
                          layers.back().size_parameter + coating.thickness + coating.share * x});
    return layers;
}

// Spheres of layers: as by_vectors, from logarithmic derivatives at the surface.
template <typename Scalar>
LaneSums layered_by_vectors(const Scatterer& scatterer, const Lanes& x,
                            const BlockColumns<Scalar>& to) {
    const std::vector<LaneLayer> layers = lane_layers(scatterer, x);
    Complex m = scatterer.relative_index;  // of the outermost layer that is there
    for (std::size_t i = 1; i < layers.size(); ++i) {
        if ((layers[i].size_parameter > layers[i - 1].size_parameter).all())
            m = layers[i].relative_index;
    }
    const Lanes y = layers.back().size_parameter;
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(y[lane]);
    const int terms = static_cast<int>(last_order.maxCoeff());
    const LayeredInside& inside = layered_inside(layers, terms);
    OutsideWaves outside(y);
    LaneSums sums;
    Asymmetry asymmetry;
    Response a, b;
    const bool absorbs = scatterer.absorbs();
    for (int n = 1; n <= terms; ++n) {
        outside.advance_some(n, last_order);
        const Lanes n_over_y = n * outside.inverse_x;
        ComplexLanes A = times(1.0 / m, inside.electric[n]), B = times(m, inside.magnetic[n]);
        A.re += n_over_y;
        B.re += n_over_y;
        const auto with = [](const ComplexLanes& z, const Lanes& here, const Lanes& before) {
            return ComplexLanes{z.re * here - before, z.im * here};
        };
        respond(with(A, outside.psi, outside.psi_before), with(A, outside.eta, outside.eta_before),
                with(B, outside.psi, outside.psi_before), with(B, outside.eta, outside.eta_before),
                a, b);
        const Lanes alive = (last_order >= n).select(Lanes::Ones(), Lanes::Zero());
        silence(a, alive);
        silence(b, alive);
        const double degeneracy = 2 * n + 1;
        sums.scattered += degeneracy * (norm(a.value) + norm(b.value));
        if (absorbs) sums.absorbed -= degeneracy * (A.im * a.inverse_norm + B.im * b.inverse_norm);
        sums.asymmetric += asymmetry.next(n, a.value, b.value);
        if (to.block) to.put(n, a.value, b.value);
    }
    return sums;
}

// The path of single spheres, for sizes where the vector formulas lose digits.
template <typename Scalar>
LaneSums one_by_one(const Scatterer& scatterer, const Lanes& x, const BlockColumns<Scalar>& to) {
    std::array<Coefficients, kLaneCount> spheres;
    if (!scatterer.is_plain()) spheres = layered_coefficients(lane_layers(scatterer, x));
    std::size_t terms = 0;
    for (int lane = 0; lane < kLaneCount; ++lane) {
        if (scatterer.is_plain())
            spheres[lane] = mie_coefficients(scatterer.relative_index, x[lane]);
        terms = std::max(terms, spheres[lane].a.size());
    }
    LaneSums sums;
    Asymmetry asymmetry;
    for (std::size_t i = 0; i < terms; ++i) {
        ComplexLanes a{Lanes::Zero(), Lanes::Zero()}, b = a;
        Lanes absorbed = Lanes::Zero();
        for (int lane = 0; lane < kLaneCount; ++lane) {
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

template <typename Scalar>
void BlockColumns<Scalar>::put(int order, const ComplexLanes& a, const ComplexLanes& b) const {
    Scalar* u = block->U.row(order).data() + first;
    Scalar* v = block->V.row(order).data() + first;
    put_lanes(root_weight * (a.re + b.re), u);
    put_lanes(root_weight * (a.im + b.im), u + block->imaginary);
    put_lanes(root_weight * (a.re - b.re), v);
    put_lanes(root_weight * (a.im - b.im), v + block->imaginary);
}

template <typename Scalar>
void BlockColumns<Scalar>::clear_beyond(int order) const {
    for (int n = order + 1; n <= block->terms; ++n) {
        for (auto* wave : {&block->U, &block->V}) {
            wave->row(n).segment(first, kLaneCount).setZero();
            wave->row(n).segment(first + block->imaginary, kLaneCount).setZero();
        }
    }
}

/// From this size parameter on waves outside are taken upward. Coefficients then err by rounding,
/// 2e-16, beside a_1 = 2/3 x^3 (m^2 - 1) / (m^2 + 2): by 1e-12 of themselves at most at m = 1.5.
constexpr double kLeastInLanes = 0.1;
/// The same of spheres that are hardly seen.
constexpr double kLeastFaintInLanes = 2.0;

bool goes_by_vectors(const Scatterer& scatterer, double smallest_x) {
    const bool is_faint =
        scatterer.is_plain() && std::abs(scatterer.relative_index - 1.0) < kWellOffTheHost;
    return smallest_x >= (is_faint ? kLeastFaintInLanes : kLeastInLanes);
}

// x: size parameters, ascending.
template <typename Scalar>
LaneSums compute_eight(const Scatterer& scatterer, const Lanes& x, const BlockColumns<Scalar>& to) {
    if (to.block) to.clear_beyond(scatterer.terms(x[0]));
    if (!goes_by_vectors(scatterer, x[0])) return one_by_one(scatterer, x, to);
    if (!scatterer.is_plain()) return layered_by_vectors(scatterer, x, to);
    const Complex m = scatterer.relative_index;
    if (m.imag() == 0) return by_vectors(m.real(), x, to);
    return by_vectors(m, x, to);
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

template <typename Scalar>
void SphereBlockOf<Scalar>::make_room(int new_terms, int new_size) {
    terms = new_terms;
    size = new_size;
    imaginary = (size + kWidest - 1) / kWidest * kWidest;
    orders.assign(size / kLaneCount, {1, terms});
    if (U.rows() >= terms + 1 && U.cols() == 2 * imaginary) return;
    U.resize(terms + 1, 2 * imaginary);
    V.resize(terms + 1, 2 * imaginary);
}

template <typename Scalar>
typename SphereBlockOf<Scalar>::Orders SphereBlockOf<Scalar>::orders_of(int first_column,
                                                                        int count) const {
    const int first = first_column / kWidest * kWidest;
    const int end = std::min(size, (first_column + count + kWidest - 1) / kWidest * kWidest);
    Orders all = orders[first / kLaneCount];
    for (int at = first + kLaneCount; at < end; at += kLaneCount) {
        const Orders& here = orders[at / kLaneCount];
        all = {std::min(all.first, here.first), std::max(all.last, here.last)};
    }
    return all;
}

template <typename Scalar>
SphereSums compute_spheres(const Scatterer& scatterer, std::span<const double> size_parameters,
                           std::span<const double> weights, SphereBlockOf<Scalar>* block,
                           SphereSums* every_other) {
    const int count = static_cast<int>(size_parameters.size());
    const FaintAbsorption faint(scatterer.is_plain() ? scatterer.relative_index : 1.0);
    Scatterer computed = scatterer;
    if (scatterer.is_plain()) computed.relative_index = faint.index;
    SphereSums total, alternate;
    Lanes is_alternate;
    for (int lane = 0; lane < kLaneCount; ++lane) is_alternate[lane] = lane % 2 == 0 ? 1.0 : 0.0;
    const auto add = [](const Lanes& by, const LaneSums& sums, SphereSums& to) {
        to.scattered += (by * sums.scattered).sum();
        to.absorbed += (by * sums.absorbed).sum();
        to.asymmetric += (by * sums.asymmetric).sum();
    };
    if (block) {
        block->make_room(scatterer.terms(size_parameters[count - 1]),
                         (count + kLaneCount - 1) / kLaneCount * kLaneCount);
    }
    for (int first = 0; first < count; first += kLaneCount) {
        Lanes x, weight;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const int i = std::min(first + lane, count - 1);  // the last one fills up, unweighted
            x[lane] = size_parameters[i];
            weight[lane] = first + lane < count ? weights[i] : 0.0;
        }
        const BlockColumns<Scalar> columns{block, first, weight.sqrt()};
        if (block && goes_by_vectors(scatterer, x[0]))
            block->orders[first / kLaneCount].last = scatterer.terms(x[kLaneCount - 1]);
        const LaneSums sums = compute_eight(computed, x, columns);
        add(weight, sums, total);
        if (every_other) add(weight * is_alternate, sums, alternate);
    }
    total.absorbed *= faint.share;
    alternate.absorbed *= faint.share;
    if (every_other) every_other->add(alternate);
    return total;
}

SphereSums compute_spheres(const Scatterer& scatterer, std::span<const double> size_parameters,
                           std::span<const double> weights, std::nullptr_t) {
    SphereBlock* nowhere = nullptr;
    return compute_spheres(scatterer, size_parameters, weights, nowhere);
}

template struct SphereBlockOf<float>;
template struct SphereBlockOf<double>;
template SphereSums compute_spheres(const Scatterer&, std::span<const double>,
                                    std::span<const double>, SphereBlockOf<float>*, SphereSums*);
template SphereSums compute_spheres(const Scatterer&, std::span<const double>,
                                    std::span<const double>, SphereBlockOf<double>*, SphereSums*);

}  // namespace miebrdf::mie
