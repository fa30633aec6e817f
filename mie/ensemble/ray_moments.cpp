#include "mie/ensemble/ray_moments.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"
#include "rte/math/interruption.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// docs/internals/constants.md says what each constant does.
struct RayMomentRule {
    /// Light reflected at grazing incidence goes along with what is diffracted: wholly down to the
    /// first of these below x, in x^(1/3), not at all from the second on.
    static constexpr double kWholeEdge = 8, kFadedEdge = 32;
    /// Nodes of a rule over the orders, and the radians of products over its panel.
    static constexpr int kNodes = 16, kMostPanelWaves = 8;
    /// Bytes of sums that jobs have for themselves.
    static constexpr double kPartMemory = 2e8;
};

struct OrderRule {
    std::vector<int> order;
    std::vector<double> weight;
};

// Sum over first <= n <= last of a smooth function from its values at RayMomentRule::kNodes of
// them: near the Gauss nodes, weights such that polynomials are summed exactly.
void add_panel(int first, int last, OrderRule& rule) {
    const int count = last - first + 1;
    if (count <= 2 * RayMomentRule::kNodes) {
        for (int n = first; n <= last; ++n) {
            rule.order.push_back(n);
            rule.weight.push_back(1);
        }
        return;
    }
    const math::Quadrature gauss = math::gauss_legendre(RayMomentRule::kNodes);
    const double centre = 0.5 * (first + last), half = 0.5 * count;
    std::vector<int> nodes;
    for (const double t : gauss.nodes)
        nodes.push_back(static_cast<int>(std::lround(centre + half * t)));
    std::sort(nodes.begin(), nodes.end());
    for (int i = 0; i < RayMomentRule::kNodes; ++i) {
        nodes[i] = std::clamp(nodes[i], i > 0 ? nodes[i - 1] + 1 : first,
                              last - (RayMomentRule::kNodes - 1 - i));
    }
    const auto legendre = [&](double n) {
        Eigen::VectorXd P(RayMomentRule::kNodes);
        const double t = (n - centre) / half;
        P[0] = 1;
        P[1] = t;
        for (int k = 1; k + 1 < RayMomentRule::kNodes; ++k)
            P[k + 1] = ((2 * k + 1) * t * P[k] - k * P[k - 1]) / (k + 1);
        return P;
    };
    Eigen::MatrixXd values(RayMomentRule::kNodes, RayMomentRule::kNodes);
    for (int i = 0; i < RayMomentRule::kNodes; ++i) values.col(i) = legendre(nodes[i]);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(RayMomentRule::kNodes);
    for (int n = first; n <= last; ++n) sums += legendre(n);
    const Eigen::VectorXd weights = values.partialPivLu().solve(sums);
    for (int i = 0; i < RayMomentRule::kNodes; ++i) {
        rule.order.push_back(nodes[i]);
        rule.weight.push_back(weights[i]);
    }
}

OrderRule order_rule(double x, int terms, int width) {
    OrderRule rule;
    const int edge = static_cast<int>(x - RayMomentRule::kFadedEdge * std::cbrt(x)) - width - 2;
    int first = 1;
    // Products at distance `width` turn by width / x per order and way through the sphere.
    const int panel =
        std::max(2 * RayMomentRule::kNodes,
                 static_cast<int>(x * RayMomentRule::kMostPanelWaves / std::max(width, 32)));
    while (first + 4 * RayMomentRule::kNodes < edge) {
        const int last = std::min(edge, first + panel - 1);
        add_panel(first, last, rule);
        first = last + 1;
    }
    for (int n = first; n <= terms; ++n) {
        rule.order.push_back(n);
        rule.weight.push_back(1);
    }
    return rule;
}

// The parts of products of partial waves, at all orders of one size, in single precision.
class Orders {
  public:
    enum Part {
        outer_re,
        outer_im,
        edge_re,
        through_re,
        through_im,
        inner_re,
        inner_im,
        part_count
    };

    /// Orders beyond the last one do not scatter.
    void make_room(int count) {
        if (values_.rows() < count) values_.resize(count, 2 * part_count);
        values_.topRows(count).setZero();
        for (const int p : {0, 1}) {
            values_.col(p * part_count + outer_re).head(count).setOnes();
            values_.col(p * part_count + edge_re).head(count).setOnes();
        }
    }
    float* part(int polarisation, Part part) {
        return values_.col(polarisation * part_count + part).data();
    }
    const float* part(int polarisation, Part part) const {
        return values_.col(polarisation * part_count + part).data();
    }
    void put(int polarisation, int n, int lane, const RayResponse& r, double edge) {
        const double values[] = {r.outer.re[lane],   r.outer.im[lane],   edge * r.outer.re[lane],
                                 r.through.re[lane], r.through.im[lane], r.inner.re[lane],
                                 r.inner.im[lane]};
        for (int i = 0; i < part_count; ++i) {
            values_(n, polarisation * part_count + i) = static_cast<float>(values[i]);
        }
    }

  private:
    Eigen::ArrayXXf values_;
};

using Row = Eigen::Array<float, kLaneCount, 1>;

// One polarisation at eight orders from m on.
struct Waves {
    Row outer_re, outer_im, edge_re, through_re, through_im, inner_re, inner_im;
};

[[gnu::always_inline]] inline Waves waves_at(const Orders& orders, int polarisation, int m) {
    const auto at = [&](Orders::Part part) -> Row {
        return Eigen::Map<const Row>(orders.part(polarisation, part) + m);
    };
    return {at(Orders::outer_re),   at(Orders::outer_im),   at(Orders::edge_re),
            at(Orders::through_re), at(Orders::through_im), at(Orders::inner_re),
            at(Orders::inner_im)};
}

// 4 Re <p_n q_m*> at one n, whose values fill p, and eight m.
[[gnu::always_inline]] inline Row product_of(const Waves& p, const Waves& q) {
    const Row above_re = p.through_re * q.through_re + p.through_im * q.through_im;
    const Row above_im = p.through_im * q.through_re - p.through_re * q.through_im;
    const Row below_re = 1 - (p.inner_re * q.inner_re + p.inner_im * q.inner_im);
    const Row below_im = p.inner_re * q.inner_im - p.inner_im * q.inner_re;
    // Rounding may leave nothing below where hardly anything goes through.
    const Row square = (below_re * below_re + below_im * below_im).max(1e-14F);
    return (1 - p.edge_re - q.edge_re) + p.outer_re * q.outer_re + p.outer_im * q.outer_im +
           (above_re * below_re + above_im * below_im) / square;
}

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A thread keeps this from one size to the next: fresh memory costs more than the sums.
struct Workspace {
    Orders spheres[kLaneCount];
    Rows plus, minus;
    Eigen::MatrixXf shares;
    void make_room(Eigen::Index rows, Eigen::Index columns, Eigen::Index interpolating) {
        if (plus.rows() < rows || plus.cols() != columns) {
            plus.resize(rows, columns);
            minus.resize(rows, columns);
        }
        if (shares.cols() < rows || shares.rows() != interpolating) {
            shares.resize(interpolating, rows);
        }
    }
};

Workspace& workspace() {
    thread_local Workspace kept;
    return kept;
}

// Sums over n of one size.
void add_size(const Orders& orders, double x, double weight, int terms,
              const MomentTransform& transform, Workspace& work, MomentTransform::Collected& to) {
    const int width = transform.width();
    const OrderRule rule = order_rule(x, terms, width);
    const int padded = (width + kLaneCount) / kLaneCount * kLaneCount;
    const auto rows = static_cast<Eigen::Index>(rule.order.size());
    work.make_room(rows, padded, transform.interpolating());
    Eigen::Index direct_rows = 0;
    const Row steps = 2 * Row::LinSpaced(kLaneCount, 0, kLaneCount - 1);
    for (Eigen::Index i = 0; i < rows; ++i) {
        math::interruption_point();
        const int n = rule.order[i];
        Waves here[2];
        for (const int p : {0, 1}) {
            const auto at = [&](Orders::Part part) -> Row {
                return Row::Constant(orders.part(p, part)[n]);
            };
            here[p] = {at(Orders::outer_re),   at(Orders::outer_im),   at(Orders::edge_re),
                       at(Orders::through_re), at(Orders::through_im), at(Orders::inner_re),
                       at(Orders::inner_im)};
        }
        const double scale = 0.25 * weight * rule.weight[i];
        for (int d = 0; d < padded; d += kLaneCount) {
            const int m = n + d;
            const Waves a = waves_at(orders, 0, m), b = waves_at(orders, 1, m);
            const Row share = static_cast<float>(scale) * (static_cast<float>(2 * m + 1) + steps);
            const Row same = share * (product_of(here[0], a) + product_of(here[1], b));
            const Row other = share * (product_of(here[0], b) + product_of(here[1], a));
            Eigen::Map<Row>(work.plus.row(i).data() + d) = same + other;
            Eigen::Map<Row>(work.minus.row(i).data() + d) = same - other;
        }
        if (n <= transform.direct()) {
            to.plus.row(n - 1) += work.plus.row(i).head(width + 1).cast<double>();
            to.minus.row(n - 1) += work.minus.row(i).head(width + 1).cast<double>();
            direct_rows = i + 1;
        } else {
            work.shares.col(i) = transform.shares(n).cast<float>();
        }
    }
    const Eigen::Index others = rows - direct_rows;
    if (transform.interpolating() == 0 || others == 0) return;
    const auto right = work.shares.middleCols(direct_rows, others);
    const auto project = [&](const Rows& from, Eigen::MatrixXd& onto) {
        const Eigen::MatrixXf sums =
            right * from.middleRows(direct_rows, others).leftCols(width + 1);
        onto.bottomRows(transform.interpolating()) += sums.cast<double>();
    };
    project(work.plus, to.plus);
    project(work.minus, to.minus);
}

// sum over p of |rays|^2 / 4 that do not come out again. Orders that nothing goes through and that
// seem to absorb by rounding alone do not; those of opaque spheres do.
Lanes absorbed_of(const RayResponse& r) {
    constexpr double kRounding = 1e-10;
    const Lanes through = norm(r.through);
    const Lanes left = 1 - norm(r.outer) - through / (1 - norm(r.inner)).max(1e-28);
    return (through > 1e-26 || left > kRounding).select(0.25 * left.max(0.0), 0.0);
}

template <typename Number>
void add_eight(Number m, const Lanes& x, const Lanes& weight, const MomentTransform& transform,
               RaySums& sums) {
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
    const int terms = static_cast<int>(last_order.maxCoeff());
    Workspace& work = workspace();
    for (Orders& sphere : work.spheres) {
        sphere.make_room(terms + transform.width() + 2 * kLaneCount + 1);
    }
    const Lanes edge_scale = x.pow(-1.0 / 3);
    RayWaves<Number> waves(m, x);
    RayResponse a, b;
    Lanes extinguished = Lanes::Zero(), absorbed = Lanes::Zero();
    for (int n = 1; n <= terms; ++n) {
        waves.advance(last_order, a, b);
        const Lanes below = (x - n) * edge_scale;
        const Lanes t = ((below - RayMomentRule::kWholeEdge) /
                         (RayMomentRule::kFadedEdge - RayMomentRule::kWholeEdge))
                            .max(0.0)
                            .min(1.0);
        // Smooth from 1 to 0.
        const Lanes edge = 1 - t * t * t * t * (35 + t * (-84 + t * (70 - 20 * t)));
        extinguished += (2 * n + 1) * (1 - 0.5 * edge * (a.outer.re + b.outer.re)) *
                        (last_order >= n).select(Lanes::Ones(), Lanes::Zero());
        if (std::imag(m) > 0) absorbed += (2 * n + 1) * (absorbed_of(a) + absorbed_of(b));
        for (int lane = 0; lane < kLaneCount; ++lane) {
            work.spheres[lane].put(0, n, lane, a, edge[lane]);
            work.spheres[lane].put(1, n, lane, b, edge[lane]);
        }
    }
    sums.extinguished += (weight * extinguished).sum();
    sums.absorbed += (weight * absorbed).sum();
    for (int lane = 0; lane < kLaneCount; ++lane) {
        if (!(weight[lane] > 0)) continue;
        add_size(work.spheres[lane], x[lane], weight[lane], static_cast<int>(last_order[lane]),
                 transform, work, sums.collected);
    }
}

}  // namespace

RaySums sum_over_rays(Complex m, const WeightedSizes& sizes, const MomentTransform& transform,
                      const Executor& run) {
    const int count = static_cast<int>(sizes.parameters.size());
    const int jobs = (count + kLaneCount - 1) / kLaneCount;
    const int width = transform.width();
    const auto empty = [&] {
        RaySums sums;
        sums.collected.plus.setZero(transform.order_count(), width + 1);
        sums.collected.minus = sums.collected.plus;
        return sums;
    };
    RaySums total = empty();
    const double part_bytes = 16.0 * double(total.collected.plus.size());
    const int at_once = std::min(jobs, std::max(2, int(RayMomentRule::kPartMemory / part_bytes)));
    std::vector<RaySums> parts(std::size_t(at_once), total);
    const auto add_job = [&](int job, RaySums& part) {
        Lanes x, weight;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const int i = job * kLaneCount + lane;
            x[lane] = sizes.parameters[std::min(i, count - 1)];
            weight[lane] = i < count ? sizes.weights[i] : 0.0;
        }
        if (m.imag() == 0) {
            add_eight(m.real(), x, weight, transform, part);
        } else {
            add_eight(m, x, weight, transform, part);
        }
    };
    for (int first = 0; first < jobs; first += at_once) {
        const int here = std::min(at_once, jobs - first);
        run(here, [&](int job) { add_job(first + job, parts[std::size_t(job)]); });
        for (int job = 0; job < here; ++job) {
            RaySums& part = parts[std::size_t(job)];
            total.extinguished += part.extinguished;
            total.absorbed += part.absorbed;
            total.collected.plus += part.collected.plus;
            total.collected.minus += part.collected.minus;
            if (first + at_once < jobs) part = empty();
        }
    }
    return total;
}

}  // namespace miebrdf::mie
