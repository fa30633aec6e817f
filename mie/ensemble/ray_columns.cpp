#include "mie/ensemble/ray_columns.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"
#include "mie/sphere/vectors.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using Block = SphereBlockOf<float>;

// docs/internals/constants.md says what each constant does.
struct RayColumnRule {
    /// Orders from 1 on, and from the last one down, that scatter less than this share of the light
    /// together are left out. Straight back the waves of all orders add up in step: there a share
    /// of 1e-9 beyond the edge of a sphere with n = 1.5 makes 9e-4 of P, 1e-14 makes 2e-6.
    static constexpr double kFaintShare = 1e-14;
    /// Groups that scatter less than this share of the light have no columns.
    static constexpr double kNothing = 1e-11;
    /// |1 - R|^2, where |R| is 1 to rounding.
    static constexpr float kRoundedToNothing = 1e-14F;
};

// Sums over columns are in single precision anyway. The numbers of a_n are the lower half of a
// pair, those of b_n the higher one.
MIEBRDF_VECTOR ComplexFloatPair pair_of(const ComplexLanes& a, const ComplexLanes& b, int first) {
    return {joined(single(load(a.re, first)), single(load(b.re, first))),
            joined(single(load(a.im, first)), single(load(b.im, first)))};
}

// 1 - z, which in single precision would lose what is left of it.
MIEBRDF_VECTOR ComplexFloatPair beside_one(const ComplexLanes& a, const ComplexLanes& b,
                                           int first) {
    return {joined(single(1 - load(a.re, first)), single(1 - load(b.re, first))),
            joined(single(-load(a.im, first)), single(-load(b.im, first)))};
}

// first e^(i phi) / (1 - R e^(i phi))
MIEBRDF_VECTOR ComplexFloatPair all_from(const ComplexFloatPair& first,
                                         const ComplexFloatPair& inner,
                                         const ComplexFloatPair& turn) {
    const ComplexFloatPair turned = inner * turn;
    const ComplexFloatPair below{1 - turned.re, -turned.im};
    const FloatPair scale = 1 / (norm(below) + RayColumnRule::kRoundedToNothing);
    return scale * ((first * turn) * conjugate(below));
}

// The responses of some of eight lanes.
struct RayPair {
    const RayResponse &a, &b;
    int first;
    ComplexFloatPair inner, through;

    MIEBRDF_VECTOR RayPair(const RayResponse& of_a, const RayResponse& of_b, int first_lane)
        : a(of_a),
          b(of_b),
          first(first_lane),
          inner(pair_of(a.inner, b.inner, first)),
          through(pair_of(a.through, b.through, first)) {}
};

// The rays of one group for eight sizes.
class GroupColumns {
  public:
    /// @param first_size  of these eight among all sizes of the group
    GroupColumns(const RayGroup& group, Block& block, int vector, int first_size,
                 const Lanes& weight)
        : group_(group),
          block_(block),
          first_column_(vector * kLaneCount * group.columns()),
          energy_lanes_(Eigen::Array<float, kVectorSize, Eigen::Dynamic>::Zero(kVectorSize,
                                                                               block.terms + 1)) {
        half_root_weight_ = 0.5 * weight.sqrt();
        if (group.phases > 0) half_root_weight_ /= std::sqrt(double(group.phases));
        for (int j = 0; j < group.phases; ++j) {
            ComplexLanes turn;
            for (int lane = 0; lane < kLaneCount; ++lane) {
                // Shifts by the golden ratio fill the circle evenly.
                const double shift = std::fmod((first_size + lane) * std::numbers::phi, 1.0);
                const double angle = 2 * std::numbers::pi * (j + shift) / group.phases;
                turn.re[lane] = std::cos(angle);
                turn.im[lane] = std::sin(angle);
            }
            turns_.push_back(turn);
        }
    }

    MIEBRDF_VECTOR void put(int order, const RayPair& rays) {
        const FloatVector weight = single(load(half_root_weight_, rays.first));
        const FloatPair half = joined(weight, weight);
        Columns to{block_.U.row(order).data() + first_column_ + rays.first,
                   block_.V.row(order).data() + first_column_ + rays.first, block_.imaginary,
                   FloatPair{}};
        if (group_.first_way == 0) {
            to.put(half * beside_one(rays.a.outer, rays.b.outer, rays.first));
        } else {
            ComplexFloatPair now = half * (rays.through * power(rays.inner, group_.first_way - 1));
            for (const ComplexLanes& turn : turns_)
                to.put(all_from(now, rays.inner, pair_of(turn, turn, rays.first)));
            for (int way = group_.first_way; way <= group_.last_way; ++way) {
                to.put(now);
                now = now * rays.inner;
            }
        }
        float* const energy = energy_lanes_.col(order).data();
        FloatVector before;
        std::memcpy(&before, energy, sizeof before);
        store(before + (low_half(to.energy) + high_half(to.energy)), energy);
    }

    /// After the last order.
    void sum_energies() {
        energy_ = energy_lanes_.colwise().sum().cast<double>();
        energy_ *=
            Eigen::ArrayXd::LinSpaced(energy_.size(), 1.0, 2.0 * double(energy_.size()) - 1.0);
    }

    /// Rows that these eight do not reach, but the next eight do, whose columns may share a
    /// register with theirs.
    void clear(int first_order, int last_order) {
        const int count = kLaneCount * group_.columns();
        if (count % Block::kWidest == 0) return;
        for (int n = first_order; n <= last_order; ++n) {
            for (auto* wave : {&block_.U, &block_.V}) {
                wave->row(n).segment(first_column_, count).setZero();
                wave->row(n).segment(first_column_ + block_.imaginary, count).setZero();
            }
        }
    }

    /// Leaves out orders that scatter no more than this together, the lowest and the highest.
    void leave_out_faint(double least, int last_order) {
        Block::Orders orders{1, last_order};
        double faint = 0;
        while (orders.first < orders.last && (faint += energy_[orders.first]) < least)
            ++orders.first;
        faint = 0;
        while (orders.last > orders.first && (faint += energy_[orders.last]) < least) --orders.last;
        const int first = first_column_ / kLaneCount;
        for (int i = 0; i < group_.columns(); ++i) block_.orders[first + i] = orders;
    }

    /// sum over columns and lanes of the weighted |a|^2 + |b|^2, twice
    double scattered() const { return 2 * energy_.sum(); }

  private:
    struct Columns {
        float *u, *v;
        int imaginary;  // columns further on
        FloatPair energy;

        // ab: weighted coefficients; their sign does not matter.
        MIEBRDF_VECTOR void put(const ComplexFloatPair& ab) {
            const FloatVector a_re = low_half(ab.re), b_re = high_half(ab.re);
            const FloatVector a_im = low_half(ab.im), b_im = high_half(ab.im);
            store(a_re + b_re, u);
            store(a_im + b_im, u + imaginary);
            store(a_re - b_re, v);
            store(a_im - b_im, v + imaginary);
            energy += norm(ab);
            u += kLaneCount;
            v += kLaneCount;
        }
    };

    const RayGroup& group_;
    Block& block_;
    int first_column_;
    Eigen::Array<float, kVectorSize, Eigen::Dynamic> energy_lanes_;  // of each order, by size
    Eigen::ArrayXd energy_;                                          // of each order, times 2n + 1
    Lanes half_root_weight_;
    std::vector<ComplexLanes> turns_;
};

template <typename Number>
void fill_eight(Number m, const Lanes& x, int terms, std::span<GroupColumns> columns) {
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
    RayWaves<Number> waves(m, x);
    RayResponse a, b;
    for (int n = 1; n <= terms; ++n) {
        waves.advance(last_order, a, b);
        for (int first = 0; first < kLaneCount; first += kVectorSize) {
            const RayPair rays(a, b, first);
            for (GroupColumns& of_group : columns) of_group.put(n, rays);
        }
    }
}

}  // namespace

void put_rays(Complex relative_index, const WeightedSizes& sizes, int first_size, int size_count,
              std::span<RayColumns> wanted) {
    const int vectors = (size_count + kLaneCount - 1) / kLaneCount;
    const auto size_of = [&](int i) { return first_size + std::min(i, size_count - 1); };
    const auto terms_of = [&](int vector) {
        return number_of_terms(sizes.parameters[size_of((vector + 1) * kLaneCount - 1)]);
    };
    for (RayColumns& columns : wanted) {
        columns.block->make_room(terms_of(vectors - 1),
                                 vectors * kLaneCount * columns.group->columns());
        columns.scattered = 0;
    }
    double light = 0;
    for (int vector = 0; vector < vectors; ++vector) {
        Lanes x, weight;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const int i = vector * kLaneCount + lane;
            x[lane] = sizes.parameters[size_of(i)];
            weight[lane] = i < size_count ? sizes.weights[size_of(i)] : 0.0;
        }
        const double here = (weight * x.square()).sum();
        light += here;
        std::vector<GroupColumns> columns;
        for (const RayColumns& of : wanted)
            columns.emplace_back(*of.group, *of.block, vector, first_size + vector * kLaneCount,
                                 weight);
        const int terms = terms_of(vector);
        if (relative_index.imag() == 0) {
            fill_eight(relative_index.real(), x, terms, std::span(columns));
        } else {
            fill_eight(relative_index, x, terms, std::span(columns));
        }
        for (std::size_t i = 0; i < columns.size(); ++i) {
            columns[i].sum_energies();
            columns[i].clear(terms + 1, terms_of(std::min(vector + 1, vectors - 1)));
            columns[i].leave_out_faint(RayColumnRule::kFaintShare * here, terms);
            wanted[i].scattered += columns[i].scattered();
        }
    }
    for (RayColumns& columns : wanted) {
        if (columns.scattered < RayColumnRule::kNothing * light) columns.block->make_room(0, 0);
    }
}

}  // namespace miebrdf::mie
