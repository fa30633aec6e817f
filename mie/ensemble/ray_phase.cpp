#include "mie/ensemble/ray_phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using Block = SphereBlockOf<float>;

// Orders from 1 on that scatter less than this share of the light together are left out.
constexpr double kFaintShare = 3e-6;
constexpr double kNothing = 1e-8;  // glories gather light a thousandfold

ComplexLanes power(const ComplexLanes& z, int exponent) {
    ComplexLanes result{Lanes::Ones(), Lanes::Zero()}, square = z;
    for (; exponent > 0; exponent /= 2) {
        if (exponent % 2 == 1) result = times(result, square);
        square = times(square, square);
    }
    return result;
}

// The rays of a group for eight sizes, put into the block's columns.
class GroupColumns {
  public:
    /// @param first_size  of these eight among all sizes of the group
    GroupColumns(const RayGroup& group, Block& block, int first_column, int first_size,
                 const Lanes& weight)
        : group_(group), block_(block), first_column_(first_column), weight_(weight) {
        root_weight_ = weight.sqrt();
        if (group.phases > 0) root_weight_ /= std::sqrt(double(group.phases));
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

    /// Returns sum over columns and lanes of the weighted |a|^2 + |b|^2.
    double put(int order, const RayResponse& a, const RayResponse& b) {
        energy_ = Lanes::Zero();
        column_ = first_column_;
        if (group_.first_way == 0) {
            const auto direct = [](const RayResponse& r) -> ComplexLanes {
                return {1 - r.outer.re, -r.outer.im};
            };
            put_one(order, direct(a), direct(b));
        } else if (group_.phases > 0) {
            const ComplexLanes first_a = times(a.through, power(a.inner, group_.first_way - 1));
            const ComplexLanes first_b = times(b.through, power(b.inner, group_.first_way - 1));
            for (const ComplexLanes& turn : turns_) {
                put_one(order, all_from(first_a, a.inner, turn), all_from(first_b, b.inner, turn));
            }
        } else {
            ComplexLanes of_a = times(a.through, power(a.inner, group_.first_way - 1));
            ComplexLanes of_b = times(b.through, power(b.inner, group_.first_way - 1));
            for (int way = group_.first_way; way <= group_.last_way; ++way) {
                put_one(order, of_a, of_b);
                of_a = times(of_a, a.inner);
                of_b = times(of_b, b.inner);
            }
        }
        return (energy_ * root_weight_.square()).sum();
    }

  private:
    // first e^(i phi) / (1 - R e^(i phi))
    static ComplexLanes all_from(const ComplexLanes& first, const ComplexLanes& inner,
                                 const ComplexLanes& turn) {
        const ComplexLanes turned = times(inner, turn);
        const ComplexLanes below = {1 - turned.re, -turned.im};
        const Lanes scale = 1 / norm(below).max(1e-28);
        const ComplexLanes above = times(first, turn);
        return {(above.re * below.re + above.im * below.im) * scale,
                (above.im * below.re - above.re * below.im) * scale};
    }

    // a, b: twice the coefficients; their sign does not matter.
    void put_one(int order, const ComplexLanes& a, const ComplexLanes& b) {
        const Lanes half = 0.5 * root_weight_;
        float* u = block_.U.row(order).data() + column_;
        float* v = block_.V.row(order).data() + column_;
        store(half * (a.re + b.re), u);
        store(half * (a.im + b.im), u + block_.size);
        store(half * (a.re - b.re), v);
        store(half * (a.im - b.im), v + block_.size);
        energy_ += 0.25 * (norm(a) + norm(b));
        column_ += kLaneCount;
    }

    static void store(const Lanes& values, float* to) {
        Eigen::Map<Eigen::Array<float, kLaneCount, 1>> target(to);
        target = values.cast<float>();
    }

    const RayGroup& group_;
    Block& block_;
    int first_column_, column_ = 0;
    Lanes weight_, root_weight_, energy_;
    std::vector<ComplexLanes> turns_;
};

template <typename Number>
void fill_eight(Number m, const Lanes& x, GroupColumns& columns, int block_terms,
                std::vector<double>& energy) {
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
    RayWaves<Number> waves(m, x);
    RayResponse a, b;
    // Beyond their last order lanes do not scatter: outer is 1 and through 0.
    for (int n = 1; n <= block_terms; ++n) {
        waves.advance(last_order, a, b);
        energy[n] += (2 * n + 1) * columns.put(n, a, b);
    }
}

Block& kept_block() {
    thread_local Block block;
    return block;
}

}  // namespace

std::vector<RayGroup> ray_groups(double index) {
    // The even rule of n + 1 sizes has n: the one at the end has no weight. Below n = 2 the rays of
    // two ways have a rainbow.
    const RayGroup two_ways = index < 2 ? RayGroup{2, 2, {41, 49}, false}
                                        : RayGroup{2, 2, {25, 33}, false};
    return {{0, 0, {33, 41}, false},
            {1, 1, {8, 8}, true},
            two_ways,
            {3, 4, {17, 25}, false},
            {5, 0, {8, 8}, true, 6}};
}

WeightedSizes ray_sizes(const RayGroup& group, const SizeDistribution& distribution,
                        const RadiusRange& range, double wave_number_per_um, int family,
                        int level) {
    const int count = group.sizes[family];
    if (!group.is_smooth) {
        return WeightedSizes(
            nested_size_nodes(distribution, range, count, level, SizeSpacing::geometric),
            wave_number_per_um);
    }
    return WeightedSizes(smooth_size_nodes(distribution, range, count << level,
                                           family == 0 ? SmoothRule::gauss : SmoothRule::fejer),
                         wave_number_per_um);
}

RayIntensity intensity_of_rays(Complex relative_index, const RayGroup& group,
                               const WeightedSizes& sizes, int first_size, int size_count,
                               const AngularFunctionsOf<float>& angular) {
    const int vectors = (size_count + kLaneCount - 1) / kLaneCount;
    const int columns_of_vector = kLaneCount * group.columns();
    const int terms = number_of_terms(sizes.parameters[first_size + size_count - 1]);
    Block& block = kept_block();
    block.make_room(terms, vectors * columns_of_vector);
    std::vector<double> energy(terms + 1, 0.0);
    double light = 0;
    for (int vector = 0; vector < vectors; ++vector) {
        Lanes x, weight;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const int i = vector * kLaneCount + lane;
            const int at = first_size + std::min(i, size_count - 1);
            x[lane] = sizes.parameters[at];
            weight[lane] = i < size_count ? sizes.weights[at] : 0.0;
        }
        light += (weight * x.square()).sum();
        GroupColumns columns(group, block, vector * columns_of_vector,
                             first_size + vector * kLaneCount, weight);
        if (relative_index.imag() == 0) {
            fill_eight(relative_index.real(), x, columns, terms, energy);
        } else {
            fill_eight(relative_index, x, columns, terms, energy);
        }
    }
    RayIntensity sum{Eigen::VectorXd::Zero(angular.angle_count())};
    for (const double share : energy) sum.scattered += 2 * share;
    if (sum.scattered < kNothing * light) return sum;
    block.first_term = 1;
    double faint = 0;
    while (block.first_term < terms &&
           (faint += energy[block.first_term]) < kFaintShare * light) {
        ++block.first_term;
    }
    angular.add_intensity(block, sum.at_angles);
    block.first_term = 1;
    return sum;
}

}  // namespace miebrdf::mie
