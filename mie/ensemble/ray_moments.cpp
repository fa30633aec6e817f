#include "mie/ensemble/ray_moments.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"
#include "rte/math/quadrature.h"

namespace miebrdf::mie {
namespace {

using Complex = std::complex<double>;

// Where light reflected at grazing incidence still goes along with what is diffracted, in x^(1/3)
// below x: from the first on the less, from the second on not at all.
double kWholeEdge = 4, kFadedEdge = 16;

constexpr int kRuleNodes = 16;
constexpr int kMostPanelWaves = 8;  // radians of products over an order panel

struct OrderRule {
    std::vector<int> order;
    std::vector<double> weight;
};

// Sum over first <= n <= last of a smooth function from its values at kRuleNodes of them: near the
// Gauss nodes, weights such that polynomials are summed exactly.
void add_panel(int first, int last, OrderRule& rule) {
    const int count = last - first + 1;
    if (count <= 2 * kRuleNodes) {
        for (int n = first; n <= last; ++n) {
            rule.order.push_back(n);
            rule.weight.push_back(1);
        }
        return;
    }
    const math::Quadrature gauss = math::gauss_legendre(kRuleNodes);
    const double centre = 0.5 * (first + last), half = 0.5 * count;
    std::vector<int> nodes;
    for (const double t : gauss.nodes) nodes.push_back(static_cast<int>(std::lround(centre + half * t)));
    std::sort(nodes.begin(), nodes.end());
    for (int i = 0; i < kRuleNodes; ++i) {
        nodes[i] = std::clamp(nodes[i], i > 0 ? nodes[i - 1] + 1 : first, last - (kRuleNodes - 1 - i));
    }
    const auto legendre = [&](double n) {
        Eigen::VectorXd P(kRuleNodes);
        const double t = (n - centre) / half;
        P[0] = 1;
        P[1] = t;
        for (int k = 1; k + 1 < kRuleNodes; ++k)
            P[k + 1] = ((2 * k + 1) * t * P[k] - k * P[k - 1]) / (k + 1);
        return P;
    };
    Eigen::MatrixXd values(kRuleNodes, kRuleNodes);
    for (int i = 0; i < kRuleNodes; ++i) values.col(i) = legendre(nodes[i]);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(kRuleNodes);
    for (int n = first; n <= last; ++n) sums += legendre(n);
    const Eigen::VectorXd weights = values.partialPivLu().solve(sums);
    for (int i = 0; i < kRuleNodes; ++i) {
        rule.order.push_back(nodes[i]);
        rule.weight.push_back(weights[i]);
    }
}

OrderRule order_rule(double x, int terms, int width) {
    OrderRule rule;
    const int edge = static_cast<int>(x - kFadedEdge * std::cbrt(x)) - width - 2;
    int first = 1;
    // Products at distance `width` turn by width / x per order and way through the sphere.
    const int panel = std::max(2 * kRuleNodes, static_cast<int>(x * kMostPanelWaves / std::max(width, 32)));
    while (first + 4 * kRuleNodes < edge) {
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

// Smooth from 0 to 1.
double fade(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * t * t * (35 + t * (-84 + t * (70 - 20 * t)));
}

// The responses of one size at all orders, real and imaginary parts apart, padded by `width`.
struct Orders {
    struct Polarisation {
        Eigen::ArrayXd outer_re, outer_im, edge_re, through_re, through_im, inner_re, inner_im;
        void make_room(int count) {
            for (auto* part : {&outer_re, &edge_re}) part->setOnes(count);
            for (auto* part : {&outer_im, &through_re, &through_im, &inner_re, &inner_im})
                part->setZero(count);
        }
        void put(int n, int lane, const RayResponse& r, double share) {
            outer_re[n] = r.outer.re[lane];
            outer_im[n] = r.outer.im[lane];
            edge_re[n] = share * r.outer.re[lane];
            through_re[n] = r.through.re[lane];
            through_im[n] = r.through.im[lane];
            inner_re[n] = r.inner.re[lane];
            inner_im[n] = r.inner.im[lane];
        }
    };
    Polarisation a, b;
};

using Row = Eigen::Array<double, kLaneCount, 1>;

// 4 Re <p_n q_m*> at fixed n and eight m.
Row product(const Orders::Polarisation& p, int n, const Orders::Polarisation& q, int m) {
    const auto at = [m](const Eigen::ArrayXd& values) -> Row { return values.segment<kLaneCount>(m); };
    const Row reflected = (1 - p.edge_re[n]) - at(q.edge_re) + p.outer_re[n] * at(q.outer_re) +
                          p.outer_im[n] * at(q.outer_im);
    const double tr = p.through_re[n], ti = p.through_im[n], rr = p.inner_re[n], ri = p.inner_im[n];
    const Row Tr = at(q.through_re), Ti = at(q.through_im), Rr = at(q.inner_re), Ri = at(q.inner_im);
    const Row above_re = tr * Tr + ti * Ti, above_im = ti * Tr - tr * Ti;
    const Row below_re = 1 - (rr * Rr + ri * Ri), below_im = rr * Ri - ri * Rr;
    // Where hardly anything goes through, rounding may leave nothing below.
    const Row square = (below_re * below_re + below_im * below_im).max(1e-28);
    return reflected + (above_re * below_re + above_im * below_im) / square;
}

double absorbed_at(const Orders::Polarisation& p, int n) {
    const double outer = p.outer_re[n] * p.outer_re[n] + p.outer_im[n] * p.outer_im[n];
    const double inner = p.inner_re[n] * p.inner_re[n] + p.inner_im[n] * p.inner_im[n];
    const double through = p.through_re[n] * p.through_re[n] + p.through_im[n] * p.through_im[n];
    if (!(through > 1e-26)) return 0;
    return std::max(0.0, 1 - outer - through / (1 - inner));
}

// Sums over n of one size.
void add_size(const Orders& orders, double x, double weight, int terms, bool absorbs,
              const MomentTransform& transform, int width, RaySums& sums) {
    const OrderRule rule = order_rule(x, terms, width);
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const int padded = (width + kLaneCount) / kLaneCount * kLaneCount;
    const auto rows = static_cast<Eigen::Index>(rule.order.size());
    Matrix plus(rows, padded), minus(rows, padded);
    Eigen::Index direct_rows = 0;
    Eigen::MatrixXd shares(transform.interpolating(), rows);
    const Row steps = 2 * Row::LinSpaced(kLaneCount, 0, kLaneCount - 1);
    for (Eigen::Index i = 0; i < rows; ++i) {
        const int n = rule.order[i];
        const double here = weight * rule.weight[i];
        const double degenerate = here * (2 * n + 1);
        sums.extinguished += degenerate * (1 - 0.5 * (orders.a.edge_re[n] + orders.b.edge_re[n]));
        if (absorbs) {
            sums.absorbed +=
                degenerate * 0.25 * (absorbed_at(orders.a, n) + absorbed_at(orders.b, n));
        }
        for (int d = 0; d < padded; d += kLaneCount) {
            const int m = n + d;
            const Row scale = 0.25 * here * ((2 * m + 1) + steps);
            const Row same = scale * (product(orders.a, n, orders.a, m) +
                                      product(orders.b, n, orders.b, m));
            const Row other = scale * (product(orders.a, n, orders.b, m) +
                                       product(orders.b, n, orders.a, m));
            plus.row(i).segment<kLaneCount>(d) = same + other;
            minus.row(i).segment<kLaneCount>(d) = same - other;
        }
        if (n <= transform.direct()) {
            sums.collected.plus.row(n - 1) += plus.row(i).head(width + 1);
            sums.collected.minus.row(n - 1) += minus.row(i).head(width + 1);
            direct_rows = i + 1;
        } else {
            shares.col(i) = transform.shares(n);
        }
    }
    const Eigen::Index others = rows - direct_rows;
    if (transform.interpolating() == 0 || others == 0) return;
    const auto right = shares.rightCols(others);
    sums.collected.plus.bottomRows(transform.interpolating()).noalias() +=
        right * plus.bottomRows(others).leftCols(width + 1);
    sums.collected.minus.bottomRows(transform.interpolating()).noalias() +=
        right * minus.bottomRows(others).leftCols(width + 1);
}

template <typename Number>
void add_eight(Number m, const Lanes& x, const Lanes& weight, const MomentTransform& transform,
               int width, RaySums& sums) {
    Lanes last_order;
    for (int lane = 0; lane < kLaneCount; ++lane) last_order[lane] = number_of_terms(x[lane]);
    const int terms = static_cast<int>(last_order.maxCoeff());
    std::vector<Orders> spheres(kLaneCount);
    for (Orders& sphere : spheres) {
        for (auto* p : {&sphere.a, &sphere.b}) p->make_room(terms + width + 2 * kLaneCount + 1);
    }
    RayWaves<Number> waves(m, x);
    RayResponse a, b;
    for (int n = 1; n <= terms; ++n) {
        waves.advance(last_order, a, b);
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const double below = (x[lane] - n) / std::cbrt(x[lane]);
            const double share = 1 - fade((below - kWholeEdge) / (kFadedEdge - kWholeEdge));
            spheres[lane].a.put(n, lane, a, share);
            spheres[lane].b.put(n, lane, b, share);
        }
    }
    for (int lane = 0; lane < kLaneCount; ++lane) {
        if (!(weight[lane] > 0)) continue;
        add_size(spheres[lane], x[lane], weight[lane], static_cast<int>(last_order[lane]),
                 std::imag(m) > 0, transform, width, sums);
    }
}

}  // namespace

RaySums sum_over_rays(Complex m, const WeightedSizes& sizes, const MomentTransform& transform,
                      int width, const Executor& run) {
    const int count = static_cast<int>(sizes.parameters.size());
    const int jobs = (count + kLaneCount - 1) / kLaneCount;
    const auto empty = [&] {
        RaySums sums;
        sums.collected.plus.setZero(transform.order_count(), width + 1);
        sums.collected.minus = sums.collected.plus;
        return sums;
    };
    std::vector<RaySums> parts(jobs, empty());
    run(jobs, [&](int job) {
        Lanes x, weight;
        for (int lane = 0; lane < kLaneCount; ++lane) {
            const int i = job * kLaneCount + lane;
            x[lane] = sizes.parameters[std::min(i, count - 1)];
            weight[lane] = i < count ? sizes.weights[i] : 0.0;
        }
        if (m.imag() == 0) {
            add_eight(m.real(), x, weight, transform, width, parts[job]);
        } else {
            add_eight(m, x, weight, transform, width, parts[job]);
        }
    });
    RaySums total = empty();
    for (const RaySums& part : parts) {
        total.extinguished += part.extinguished;
        total.absorbed += part.absorbed;
        total.collected.plus += part.collected.plus;
        total.collected.minus += part.collected.minus;
    }
    return total;
}

}  // namespace miebrdf::mie
