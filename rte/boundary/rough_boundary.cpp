#include "rte/boundary/rough_boundary.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <miebrdf/error.h>

#include "rte/math/interruption.h"

namespace miebrdf::rte {
namespace {

const RefractionGrid& checked(const RefractionGrid& grid, double index, const RoughSurface& surface,
                              int orders) {
    if (!(index >= 1.05 && index <= 3.0)) throw UsageError("index", index, "1.05 to 3");
    if (!(surface.alpha >= 1e-6 && surface.alpha <= 1.0)) {
        throw UsageError("alpha", surface.alpha, "1e-6 to 1");
    }
    const auto nodes = int(grid.size());
    if (!(nodes >= 4 && nodes <= 1024)) throw UsageError("streams", nodes, "4 to 1024");
    if (!(orders >= 1)) throw UsageError("orders", orders, "at least 1");
    return grid;
}

/// Rays must resolve the azimuth, and the polynomials of the largest panel: those of so many nodes
/// without refinement. With the least one energies of GGX facets of alpha 0.5, where azimuths are
/// spread most, err by 1e-4 of a beam up to order 6 and by 1e-3 up to order 12.
double refinement_for(const RefractionGrid& grid) {
    constexpr double nodes_by_default = 12.0, least = 1.5;
    Eigen::Index most = 0;
    for (const RefractionPanel& panel : grid.panels()) most = std::max(most, panel.count);
    return std::max(least, double(most) / nodes_by_default);
}

/// Cosines in the medium at which panels of other hosts end, between air's and its own.
std::vector<double> edges_of_hosts(const RefractionGrid& grid, double index) {
    std::vector<double> edges;
    for (const RefractionPanel& panel : grid.panels()) {
        if (panel.high > 1.0 && panel.high < index)
            edges.push_back(std::sqrt((index - panel.high) * (index + panel.high)) / index);
    }
    return edges;
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

/// Of the parabola through three points, at x.
std::array<double, 3> lagrange_weights(const std::array<double, 3>& at, double x) {
    std::array<double, 3> weights;
    for (std::size_t k = 0; k < 3; ++k) {
        const double a = at[(k + 1) % 3], b = at[(k + 2) % 3];
        weights[k] = (x - a) * (x - b) / ((at[k] - a) * (at[k] - b));
    }
    return weights;
}

Eigen::VectorXd flux_weights_of(const RefractionGrid& grid, double index) {
    const ZenithGrid medium = grid.in_medium(index);
    return (medium.weights.array() * medium.mu.array()).sqrt();
}

/// n D inside and then, for the same n sin(theta), in air: g^2 = n^2 mu w is the same on both
/// sides.
Eigen::VectorXd equilibrium(const RefractionGrid& grid, double index) {
    const Eigen::VectorXd inside = index * flux_weights_of(grid, index);
    Eigen::VectorXd g(grid.size() + grid.nodes_below(1.0));
    g << inside, inside.tail(grid.nodes_below(1.0));
    return g;
}

}  // namespace

RoughBoundary::RoughBoundary(double index, const RoughSurface& surface, const RefractionGrid& grid,
                             int orders)
    : index_(index),
      surface_(surface),
      order_count_(orders),
      grid_(checked(grid, index, surface, orders)),
      refinement_(refinement_for(grid)),
      edges_(edges_of_hosts(grid, index)),
      functions_(std::in_place, grid_, index),
      walk_(std::in_place, index, surface, orders),
      d_(flux_weights_of(grid_, index)),
      g_(equilibrium(grid_, index)) {
    const ZenithGrid medium = grid_.in_medium(index);
    const ZenithGrid air = grid_.in_medium(1.0);
    const Eigen::Index n = medium.size();
    const Eigen::Index all = g_.size();
    std::vector<FacetWalk::Start> beams;
    std::vector<Eigen::MatrixXd> once(std::size_t(orders), Eigen::MatrixXd(all, all));
    for (Eigen::Index q = 0; q < all; ++q) {
        math::interruption_point();
        const bool from_air = q >= n;
        const auto beam = beam_at_facet(from_air, from_air ? air.mu[q - n] : medium.mu[q]);
        beams.push_back(walk_->start(beam));
        const Eigen::MatrixXd column = after_one_facet(beam);
        for (int m = 0; m < orders; ++m) once[std::size_t(m)].col(q) = column.col(m);
    }
    const std::vector<Eigen::MatrixXd> later = walk_->leaving(beams, grid_);
    const Eigen::MatrixXd order_0 = once[0] + later[0];
    keep(symmetrised(order_0, g_), sky_of(order_0.rightCols(all - n)));
    for (std::size_t m = 1; m < std::size_t(orders); ++m) {
        inside_.push_back(symmetrised(once[m] + later[m], g_).topLeftCorner(n, n));
    }
}

RoughBoundary::RoughBoundary(double index,
                             std::array<std::shared_ptr<const RoughBoundary>, 3> neighbours)
    : index_(index),
      surface_(neighbours[0]->surface_),
      order_count_(std::min({neighbours[0]->order_count_, neighbours[1]->order_count_,
                             neighbours[2]->order_count_})),  // some may have more
      grid_({index}, int(neighbours[0]->grid_.size())),
      d_(flux_weights_of(grid_, index)),
      g_(equilibrium(grid_, index)) {
    checked(grid_, index, surface_, order_count_);
    const auto weights = lagrange_weights(
        {neighbours[0]->index_, neighbours[1]->index_, neighbours[2]->index_}, index);
    for (std::size_t k = 0; k < 3; ++k) neighbours_.push_back({neighbours[k], weights[k]});
    const auto between = [&](const auto& matrix_of) {
        auto sum = (neighbours_[0].weight * matrix_of(*neighbours_[0].boundary)).eval();
        for (std::size_t k = 1; k < 3; ++k) {
            sum += neighbours_[k].weight * matrix_of(*neighbours_[k].boundary);
        }
        return sum;
    };
    keep(between([](const RoughBoundary& one) { return one.order_0_; }),
         between([](const RoughBoundary& one) { return one.sky_; }));
    for (int m = 1; m < order_count_; ++m) {
        inside_.push_back(between([m](const RoughBoundary& one) { return one.inside(m); }));
    }
}

void RoughBoundary::keep(Eigen::MatrixXd order_0, Eigen::VectorXd sky) {
    order_0_ = conserving(std::move(order_0), g_);
    sky_ = std::move(sky);
    external_ = sky_.tail(nodes_in_air()).sum();
    internal_ = 1.0 - (1.0 - external_) / (index_ * index_);
    inside_.push_back(order_0_.topLeftCorner(d_.size(), d_.size()));
}

/// @param from_air  energies of beams from the nodes in air, as columns
Eigen::VectorXd RoughBoundary::sky_of(const Eigen::MatrixXd& from_air) const {
    const Eigen::VectorXd share = g_.tail(nodes_in_air()).cwiseAbs2();
    const Eigen::VectorXd all = from_air.colwise().sum().transpose();
    return from_air * share.cwiseQuotient(all) / share.sum();
}

Eigen::VectorXd RoughBoundary::sky_entering() const {
    return sky_.head(d_.size()).cwiseQuotient(d_);
}

FacetWalk::Beam RoughBoundary::beam_at_facet(bool from_air, double mu) const {
    const FacetScattering light =
        scatter_by_facets(from_air ? index_ : 1.0 / index_, surface_, mu, refinement_, edges_);
    return {from_air, mu, split_by_facets(light, surface_, mu)};
}

Eigen::MatrixXd RoughBoundary::after_one_facet(const FacetWalk::Beam& beam) const {
    const FacetScattering& light = beam.first.leaving;
    Eigen::MatrixXd energy(g_.size(), order_count_);
    energy << functions_->inside(beam.from_air ? light.refracted : light.reflected, order_count_),
        functions_->in_air(beam.from_air ? light.reflected : light.refracted, order_count_);
    drop_unresolved_orders(energy);
    return energy;
}

RoughBoundary::EnergyFromAir RoughBoundary::followed(const Eigen::VectorXd& mu_air) const {
    const Eigen::Index requested = mu_air.size();
    std::vector<FacetWalk::Start> beams;
    std::vector<Eigen::MatrixXd> at_once;
    for (const double mu : mu_air) {
        if (!(mu > 0.0 && mu <= 1.0)) throw UsageError("mu_air", mu, "(0, 1]");
        const auto beam = beam_at_facet(true, mu);
        beams.push_back(walk_->start(beam));
        at_once.push_back(after_one_facet(beam));
    }
    EnergyFromAir energy{mu_air, walk_->leaving(beams, grid_), {}};
    for (Eigen::MatrixXd& order : energy.by_order) order.transposeInPlace();
    energy.at_once.assign(std::size_t(order_count_), Eigen::MatrixXd(requested, d_.size()));
    for (Eigen::Index r = 0; r < requested; ++r) {
        const Eigen::MatrixXd& first = at_once[std::size_t(r)];
        for (int m = 0; m < order_count_; ++m) {
            energy.by_order[std::size_t(m)].row(r) += first.col(m).transpose();
            energy.at_once[std::size_t(m)].row(r) = first.col(m).head(d_.size()).transpose();
        }
    }
    return energy;
}

RoughBoundary::EnergyFromAir RoughBoundary::interpolated(const Eigen::VectorXd& mu_air) const {
    EnergyFromAir sum{mu_air, {}, {}};
    sum.by_order.assign(inside_.size(), Eigen::MatrixXd::Zero(mu_air.size(), g_.size()));
    sum.at_once.assign(inside_.size(), Eigen::MatrixXd::Zero(mu_air.size(), d_.size()));
    for (const Neighbour& neighbour : neighbours_) {
        const auto energy = neighbour.boundary->energy_from_air(mu_air);
        for (std::size_t m = 0; m < inside_.size(); ++m) {
            sum.by_order[m] += neighbour.weight * energy->by_order[m];
            sum.at_once[m] += neighbour.weight * energy->at_once[m];
        }
    }
    return sum;
}

std::shared_ptr<const RoughBoundary::EnergyFromAir> RoughBoundary::energy_from_air(
    const Eigen::VectorXd& mu_air) const {
    const std::lock_guard lock(mutex_);
    const auto known = std::find_if(kept_.begin(), kept_.end(), [&](const auto& one) {
        return one->mu_air.size() == mu_air.size() && one->mu_air == mu_air;
    });
    if (known != kept_.end()) {
        kept_.splice(kept_.begin(), kept_, known);
    } else {
        kept_.push_front(std::make_shared<const EnergyFromAir>(
            neighbours_.empty() ? followed(mu_air) : interpolated(mu_air)));
        if (kept_.size() > kKeptRequests) kept_.pop_back();
    }
    return kept_.front();
}

LightFromAir RoughBoundary::from_air(const Eigen::VectorXd& mu_air) const {
    const auto energy = energy_from_air(mu_air);
    const Eigen::Index air = nodes_in_air();
    const Eigen::VectorXd c = energy->by_order[0].rowwise().sum().cwiseInverse();
    LightFromAir light;
    light.compensation = c;
    light.outer_reflectance = c.cwiseProduct(energy->by_order[0].rightCols(air).rowwise().sum());
    const auto scaled = [&](const auto& energies) -> Eigen::MatrixXd {
        return c.asDiagonal() * energies * d_.cwiseInverse().asDiagonal();
    };
    for (const Eigen::MatrixXd& order : energy->by_order)
        light.entering.push_back(scaled(order.leftCols(d_.size())));
    for (const Eigen::MatrixXd& order : energy->at_once)
        light.entering_at_once.push_back(scaled(order));
    return light;
}

}  // namespace miebrdf::rte
