#include "rte/boundary/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <miebrdf/error.h>

namespace miebrdf::rte {
namespace {

void check_rough_boundary(double index, const RoughSurface& surface, int streams, int orders) {
    if (!(index >= 1.05 && index <= 3.0)) throw UsageError("index", index, "1.05 to 3");
    if (!(surface.alpha >= 1e-6 && surface.alpha <= 1.0)) {
        throw UsageError("alpha", surface.alpha, "1e-6 to 1");
    }
    if (!(streams >= 4 && streams <= 256)) throw UsageError("streams", streams, "4 to 256");
    if (!(orders >= 1)) throw UsageError("orders", orders, "at least 1");
}

/// From the energies K_pq that go from q to p: reciprocal light has K_pq g_q / g_p = K_qp g_p /
/// g_q. All K are about as well known, so that the mean of both has the weights g_p^4 and g_q^4;
/// with equal ones the nodes at grazing, where g is small, would be lost in what errs elsewhere.
Eigen::MatrixXd symmetrised(const Eigen::MatrixXd& energy, const Eigen::VectorXd& g) {
    const Eigen::VectorXd g2 = g.cwiseAbs2();
    Eigen::MatrixXd s = g2.asDiagonal() * energy;
    s += s.transpose().eval();
    for (Eigen::Index q = 0; q < s.cols(); ++q) {
        for (Eigen::Index p = 0; p < s.rows(); ++p) {
            s(p, q) *= g[p] * g[q] / (g2[p] * g2[p] + g2[q] * g2[q]);
        }
    }
    return s;
}

/// The symmetric matrix nearest to s (in the sum of squares) with S g = g: what is missing, r = g -
/// s g, is put back as u g^T + g u^T. Scaling rows and columns instead would be ill-conditioned
/// where nearly all light passes straight on.
Eigen::MatrixXd conserving(Eigen::MatrixXd s, const Eigen::VectorXd& g) {
    const double g2 = g.squaredNorm();
    for (int pass = 0; pass < 2; ++pass) {  // the second one for rounding
        const Eigen::VectorXd missing = g - s * g;
        const Eigen::VectorXd u = (missing - g * (0.5 * missing.dot(g) / g2)) / g2;
        s += u * g.transpose() + g * u.transpose();
    }
    return s;
}

}  // namespace

RoughBoundary::RoughBoundary(double index, const RoughSurface& surface, int streams, int orders)
    : index_((check_rough_boundary(index, surface, streams, orders), index)),
      surface_(surface),
      order_count_(orders),
      grid_({index}, streams),
      functions_(grid_, index),
      walk_(index, surface, orders) {
    const ZenithGrid medium = grid_.in_medium(index);
    const ZenithGrid air = grid_.in_medium(1.0);
    const Eigen::Index n = medium.size();
    const Eigen::Index all = n + air.size();
    d_ = (medium.weights.array() * medium.mu.array()).sqrt();
    g_.resize(all);  // g^2 = n^2 mu w is the same on both sides
    g_ << index * d_, index * d_.tail(air.size());

    std::vector<FacetWalk::Beam> beams;
    for (Eigen::Index q = 0; q < all; ++q) {
        const bool from_air = q >= n;
        beams.push_back(meet(from_air, from_air ? air.mu[q - n] : medium.mu[q]));
    }
    std::vector<Eigen::MatrixXd> once(std::size_t(orders), Eigen::MatrixXd(all, all));
    for (Eigen::Index q = 0; q < all; ++q) {
        const Eigen::MatrixXd column = after_one_facet(beams[std::size_t(q)]);
        for (int m = 0; m < orders; ++m) once[std::size_t(m)].col(q) = column.col(m);
    }
    const std::vector<Eigen::MatrixXd> later = walk_.leaving(beams, grid_);
    for (std::size_t m = 0; m < std::size_t(orders); ++m) {
        Eigen::MatrixXd s = symmetrised(once[m] + later[m], g_);
        if (m == 0) {
            s = conserving(std::move(s), g_);
            const auto inside = g_.head(n);
            const auto outside = g_.tail(air.size());
            internal_ = inside.dot(s.topLeftCorner(n, n) * inside) / inside.squaredNorm();
            external_ = outside.dot(s.bottomRightCorner(air.size(), air.size()) * outside) /
                        outside.squaredNorm();
        }
        inside_.push_back(s.topLeftCorner(n, n));
    }
}

FacetWalk::Beam RoughBoundary::meet(bool from_air, double mu) const {
    return {from_air, mu, scatter_by_facets(from_air ? index_ : 1.0 / index_, surface_, mu)};
}

Eigen::MatrixXd RoughBoundary::after_one_facet(const FacetWalk::Beam& beam) const {
    const FacetScattering light = unhidden(beam.first, surface_, beam.mu);
    Eigen::MatrixXd energy(grid_.size() + grid_.nodes_below(1.0), order_count_);
    energy << functions_.inside(beam.from_air ? light.refracted : light.reflected, order_count_),
        functions_.in_air(beam.from_air ? light.reflected : light.refracted, order_count_);
    return energy;
}

LightFromAir RoughBoundary::from_air(const Eigen::VectorXd& mu_air) const {
    const Eigen::Index n = d_.size();
    const Eigen::Index air = g_.size() - n;
    const Eigen::Index requested = mu_air.size();
    std::vector<FacetWalk::Beam> beams;
    for (Eigen::Index r = 0; r < requested; ++r) {
        if (!(mu_air[r] > 0.0 && mu_air[r] <= 1.0)) throw UsageError("mu_air", mu_air[r], "(0, 1]");
        beams.push_back(meet(true, mu_air[r]));
    }
    const std::vector<Eigen::MatrixXd> later = walk_.leaving(beams, grid_);
    LightFromAir light;
    light.entering.assign(inside_.size(), Eigen::MatrixXd(requested, n));
    light.outer_reflectance.resize(requested);
    light.compensation.resize(requested);
    light.lobe_scale.resize(requested);
    for (Eigen::Index r = 0; r < requested; ++r) {
        Eigen::MatrixXd energy = after_one_facet(beams[std::size_t(r)]);
        const double one_facet = energy.col(0).tail(air).sum();
        for (int m = 0; m < order_count_; ++m) energy.col(m) += later[std::size_t(m)].col(r);
        const double c = 1.0 / energy.col(0).sum();
        energy *= c;
        light.compensation[r] = c;
        light.outer_reflectance[r] = energy.col(0).tail(air).sum();
        light.lobe_scale[r] = std::sqrt(std::max(0.0, light.outer_reflectance[r]) / one_facet);
        for (int m = 0; m < order_count_; ++m) {
            light.entering[std::size_t(m)].row(r) =
                energy.col(m).head(n).cwiseQuotient(d_).transpose();
        }
    }
    return light;
}

}  // namespace miebrdf::rte
