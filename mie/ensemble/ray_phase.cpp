#include "mie/ensemble/ray_phase.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "mie/ensemble/far_rays.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"
#include "mie/sphere/vectors.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;
using Block = SphereBlockOf<float>;

// Orders from 1 on, and from the last one down, that scatter less than this share of the light
// together are left out. Straight back the waves of all orders add up in step: there a share of
// 3e-6 makes 3e-3 of P.
constexpr double kFaintShare = 1e-9;
constexpr double kNothing = 1e-11;
constexpr float kRoundedToNothing = 1e-14F;  // of |1 - R|^2, where |R| is 1 to rounding

MIEBRDF_VECTOR ComplexFloatVector power(const ComplexFloatVector& z, int exponent) {
    ComplexFloatVector result{FloatVector{} + 1, FloatVector{}}, square = z;
    for (; exponent > 0; exponent /= 2) {
        if (exponent % 2 == 1) result = result * square;
        square = square * square;
    }
    return result;
}

// first e^(i phi) / (1 - R e^(i phi))
MIEBRDF_VECTOR ComplexFloatVector all_from(const ComplexFloatVector& first,
                                           const ComplexFloatVector& inner,
                                           const ComplexFloatVector& turn) {
    const ComplexFloatVector turned = inner * turn;
    const ComplexFloatVector below{1 - turned.re, -turned.im};
    const FloatVector scale = 1 / (norm(below) + kRoundedToNothing);
    return scale * ((first * turn) * conjugate(below));
}

// 1 - z, which in single precision would lose what is left of it.
MIEBRDF_VECTOR ComplexFloatVector beside_one(const ComplexLanes& z, int first) {
    return {single(1 - load(z.re, first)), single(-load(z.im, first))};
}

// The rays of a group for eight sizes, put into the block's columns.
class GroupColumns {
  public:
    /// @param first_size  of these eight among all sizes of the group
    GroupColumns(const RayGroup& group, Block& block, int first_column, int first_size,
                 const Lanes& weight)
        : group_(group), block_(block), first_column_(first_column) {
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

    /// Returns sum over columns and lanes of the weighted |a|^2 + |b|^2.
    double put(int order, const RayResponse& a, const RayResponse& b) {
        double energy = 0;
        for (int first = 0; first < kLaneCount; first += kVectorSize) {
            const FloatVector sums = put_some(order, a, b, first);
            for (int i = 0; i < kVectorSize; ++i) energy += sums[i];
        }
        return energy;
    }

    /// Rows that these eight do not reach, but others of the block do.
    void clear_beyond(int order) {
        const int count = kLaneCount * group_.columns();
        for (int n = order + 1; n <= block_.terms; ++n) {
            for (auto* wave : {&block_.U, &block_.V}) {
                wave->row(n).segment(first_column_, count).setZero();
                wave->row(n).segment(first_column_ + block_.imaginary, count).setZero();
            }
        }
    }

    /// Leaves out orders that scatter no more than this together, the lowest and the highest.
    void leave_out_faint(const std::vector<double>& energy, double least) {
        Block::Orders orders{1, static_cast<int>(energy.size()) - 1};
        double faint = 0;
        while (orders.first < orders.last && (faint += energy[orders.first]) < least)
            ++orders.first;
        faint = 0;
        while (orders.last > orders.first && (faint += energy[orders.last]) < least) --orders.last;
        const int first = first_column_ / kLaneCount;
        for (int i = 0; i < group_.columns(); ++i) block_.orders[first + i] = orders;
    }

  private:
    // Sums over these columns are in single precision anyway.
    MIEBRDF_VECTOR FloatVector put_some(int order, const RayResponse& a, const RayResponse& b,
                                        int first) {
        const FloatVector weight = single(load(half_root_weight_, first));
        Columns to{block_.U.row(order).data() + first_column_ + first,
                   block_.V.row(order).data() + first_column_ + first, block_.imaginary, FloatVector{}};
        if (group_.first_way == 0) {
            to.put(weight, beside_one(a.outer, first), beside_one(b.outer, first));
            return to.energy;
        }
        const auto inner_a = load_single(a.inner, first), inner_b = load_single(b.inner, first);
        auto of_a = load_single(a.through, first) * power(inner_a, group_.first_way - 1);
        auto of_b = load_single(b.through, first) * power(inner_b, group_.first_way - 1);
        if (group_.phases > 0) {
            for (const ComplexLanes& lanes : turns_) {
                const auto turn = load_single(lanes, first);
                to.put(weight, all_from(of_a, inner_a, turn), all_from(of_b, inner_b, turn));
            }
            return to.energy;
        }
        for (int way = group_.first_way; way <= group_.last_way; ++way) {
            to.put(weight, of_a, of_b);
            of_a = of_a * inner_a;
            of_b = of_b * inner_b;
        }
        return to.energy;
    }

    struct Columns {
        float *u, *v;
        int imaginary;  // columns further on
        FloatVector energy;

        // a, b: twice the coefficients; their sign does not matter.
        MIEBRDF_VECTOR void put(const FloatVector& half, const ComplexFloatVector& a,
                                const ComplexFloatVector& b) {
            const ComplexFloatVector A = half * a, B = half * b;
            store(A.re + B.re, u);
            store(A.im + B.im, u + imaginary);
            store(A.re - B.re, v);
            store(A.im - B.im, v + imaginary);
            energy += norm(A) + norm(B);
            u += kLaneCount;
            v += kLaneCount;
        }
    };

    const RayGroup& group_;
    Block& block_;
    int first_column_;
    Lanes half_root_weight_;
    std::vector<ComplexLanes> turns_;
};

// Returns what each order scatters.
template <typename Number>
std::vector<double> fill_eight(Number m, const Lanes& x, GroupColumns& columns) {
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
    const int terms = static_cast<int>(last_order.maxCoeff());
    std::vector<double> energy(terms + 1, 0.0);
    RayWaves<Number> waves(m, x);
    RayResponse a, b;
    for (int n = 1; n <= terms; ++n) {
        waves.advance(last_order, a, b);
        energy[n] = (2 * n + 1) * columns.put(n, a, b);
    }
    columns.clear_beyond(terms);
    return energy;
}

Block& kept_block() {
    thread_local Block block;
    return block;
}

}  // namespace

std::vector<RayGroup> ray_groups(double index, bool exact) {
    // The even rule of n + 1 sizes has n: the one at the end has no weight. Below n = 2 the rays of
    // two ways have a rainbow.
    const RayGroup two_ways =
        index < 2 ? RayGroup{2, 2, {41, 49}, false} : RayGroup{2, 2, {25, 33}, false};
    if (exact) {
        return {{0, 0, {33, 41}, false}, {1, 1, {17, 25}, false},  two_ways,
                {3, 4, {33, 41}, false}, {5, 16, {17, 25}, false}, {17, 0, {17, 25}, false}};
    }
    return {{0, 0, {33, 41}, false},
            {1, 1, {8, 8}, true},
            two_ways,
            {3, 4, {33, 41}, false},
            {5, 0, {8, 8}, true, 6}};
}

RayWindow::RayWindow(double index, double smallest_x, double largest_x)
    : smallest_(smallest_x), largest_(largest_x) {
    constexpr double kNarrowest = 15, kPhases = 8, kWidest = 0.45;
    width_ =
        std::min(std::max(kNarrowest, kPhases / (index - 1)), kWidest * (largest_x - smallest_x));
}

double RayWindow::at(double x) const {
    const auto rise = [&](double distance) {
        const double u = std::clamp(distance / width_, 0.0, 1.0);
        return std::min(1.0, u * u * u * u * (35 + u * (-84 + u * (70 - 20 * u))));
    };
    return rise(x - smallest_) * rise(largest_ - x);
}

WeightedSizes ray_sizes(const RayGroup& group, const SizeDistribution& distribution,
                        const RadiusRange& range, double wave_number_per_um, int family, int level,
                        const RayWindow* window) {
    const int count = group.sizes[family];
    SizeNodes nodes =
        group.is_smooth
            ? smooth_size_nodes(distribution, range, count << level,
                                family == 0 ? SmoothRule::gauss : SmoothRule::fejer)
            : nested_size_nodes(distribution, range, count, level, SizeSpacing::geometric);
    if (window == nullptr) {
        const double sampled =
            std::accumulate(nodes.area_share.begin(), nodes.area_share.end(), 0.0);
        const double exact = area_share_within(distribution, range);
        for (double& share : nodes.area_share) share *= exact / sampled;
    }
    WeightedSizes sizes(nodes, wave_number_per_um);
    for (std::size_t i = 0; window != nullptr && i < sizes.weights.size(); ++i)
        sizes.weights[i] *= window->at(sizes.parameters[i]);
    return sizes;
}

double waves_of_rays(Complex relative_index, const RayGroup& group, const WeightedSizes& sizes,
                     int first_size, int size_count, Block& block) {
    const int vectors = (size_count + kLaneCount - 1) / kLaneCount;
    const int columns_of_vector = kLaneCount * group.columns();
    const int terms = number_of_terms(sizes.parameters[first_size + size_count - 1]);
    block.make_room(terms, vectors * columns_of_vector);
    double light = 0, scattered = 0;
    for (int vector = 0; vector < vectors; ++vector) {
        Lanes x, weight;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const int i = vector * kLaneCount + lane;
            const int at = first_size + std::min(i, size_count - 1);
            x[lane] = sizes.parameters[at];
            weight[lane] = i < size_count ? sizes.weights[at] : 0.0;
        }
        const double here = (weight * x.square()).sum();
        light += here;
        GroupColumns columns(group, block, vector * columns_of_vector,
                             first_size + vector * kLaneCount, weight);
        const std::vector<double> energy = relative_index.imag() == 0
                                               ? fill_eight(relative_index.real(), x, columns)
                                               : fill_eight(relative_index, x, columns);
        columns.leave_out_faint(energy, kFaintShare * here);
        for (const double share : energy) scattered += 2 * share;
    }
    if (scattered < kNothing * light) block.make_room(0, 0);
    return scattered;
}

RayIntensity intensity_of_rays(Complex relative_index, const RayGroup& group,
                               const WeightedSizes& sizes, int first_size, int size_count,
                               const AngularFunctionsOf<float>& angular) {
    if (group.is_closed()) {
        return intensity_of_far_rays(relative_index, group.first_way, sizes, first_size, size_count,
                                     angular);
    }
    RayIntensity sum{Eigen::VectorXd::Zero(angular.angle_count())};
    Block& block = kept_block();
    sum.scattered = waves_of_rays(relative_index, group, sizes, first_size, size_count, block);
    angular.add_intensity(block, sum.at_angles);
    return sum;
}

}  // namespace miebrdf::mie
