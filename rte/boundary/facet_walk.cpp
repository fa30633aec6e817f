#include "rte/boundary/rough_boundary.h"

#include <cmath>

#include "rte/math/interruption.h"
#include "rte/math/quadrature.h"
#include "rte/surface/microfacet.h"

namespace miebrdf::rte {
namespace {

// The walk is as coarse as the distribution over directions allows; totals need less.
constexpr double kWalkRefinement = 0.9;
// It ends when this share of all beams is left.
constexpr double kForgotten = 1e-5;
constexpr int kMostFacets = 1000;
// Directions of which fewer rays than this meet a second facet tell nothing of where.
constexpr double kNoRay = 1e-9;

/// One direction of a matrix with a column for each height of each beam: heights x beams.
using HeightsOfBeams =
    Eigen::Map<Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;

double smith_lambda(const RoughSurface& surface, double mu) {
    return cosine_over_masking(surface.distribution, surface.alpha, mu) / mu - 1.0;
}

/// Lagrange functions of Gauss nodes for heights.
class HeightNodes {
  public:
    HeightNodes() : rule_(math::gauss_legendre(FacetWalk::kHeights, 0.0, 1.0)) {}

    double node(int k) const { return rule_.nodes[std::size_t(k)]; }
    Eigen::VectorXd at(double u) const {
        Eigen::VectorXd values(FacetWalk::kHeights);
        for (int k = 0; k < FacetWalk::kHeights; ++k) {
            values[k] = 1.0;
            for (int j = 0; j < FacetWalk::kHeights; ++j) {
                if (j != k) values[k] *= (u - node(j)) / (node(k) - node(j));
            }
        }
        return values;
    }

  private:
    math::Quadrature rule_;
};

/// Heights u = start xi^exponent for xi even between `from` and 1, all in terms of 1 - u below the
/// surface.
Eigen::VectorXd heights(const HeightNodes& nodes, double start, double exponent, double from,
                        bool below) {
    static const math::Quadrature rule = math::gauss_legendre(8, 0.0, 1.0);
    Eigen::VectorXd share = Eigen::VectorXd::Zero(FacetWalk::kHeights);
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double u = start * std::pow(from + (1.0 - from) * rule.nodes[i], exponent);
        share += (1.0 - from) * rule.weights[i] * nodes.at(below ? 1.0 - u : u);
    }
    return share;
}

void split(const ScatteredRays& rays, ScatteredRays& away, ScatteredRays& towards) {
    for (std::size_t k = 0; k < rays.mu.size(); ++k) {
        ScatteredRays& side = rays.mu[k] > 0.0 ? away : towards;
        side.add(rays.energy[k], std::abs(rays.mu[k]), rays.cos_azimuth[k]);
    }
}

}  // namespace

FacetWalk::FacetWalk(double index, const RoughSurface& surface, int orders)
    : index_(index),
      surface_(surface),
      order_count_(orders),
      grid_({index}, kStreams),
      functions_(grid_, index) {
    const ZenithGrid medium = grid_.in_medium(index);
    const ZenithGrid air = grid_.in_medium(1.0);
    const Eigen::Index sides = medium.size() + air.size();
    g2_.resize(sides);
    g2_ << index * index * medium.weights.cwiseProduct(medium.mu), air.weights.cwiseProduct(air.mu);

    const HeightNodes nodes;
    turned_.assign(std::size_t(orders), Eigen::MatrixXd(2 * sides, 2 * sides));
    for (const bool away : {true, false}) {
        for (Eigen::Index d = 0; d < sides; ++d) {
            const bool in_air = d >= medium.size();
            const double mu = in_air ? air.mu[d - medium.size()] : medium.mu[d];
            const double lambda = smith_lambda(surface, mu);
            Eigen::MatrixXd meets(kHeights, kHeights);
            Eigen::RowVectorXd leaves = Eigen::RowVectorXd::Zero(kHeights);
            for (int k = 0; k < kHeights; ++k) {
                const double start = in_air ? nodes.node(k) : 1.0 - nodes.node(k);
                if (away) leaves[k] = std::pow(start, lambda);
                meets.col(k) = away ? heights(nodes, start, -1.0 / std::max(lambda, 1e-300),
                                              leaves[k], !in_air)
                                    : heights(nodes, start, 1.0 / (1.0 + lambda), 0.0, !in_air);
            }
            meets_.push_back(meets);
            leaves_.push_back(leaves);
            const FacetScattering light = scatter_by_facets(in_air ? index : 1.0 / index, surface,
                                                            away ? -mu : mu, kWalkRefinement);
            const Eigen::MatrixXd turned = directions_after(light, in_air);
            for (int m = 0; m < orders; ++m) {
                turned_[std::size_t(m)].col(away ? d : sides + d) = turned.col(m);
            }
        }
    }
}

/// (Inside and in air away from the boundary, inside and in air towards it) x orders.
Eigen::MatrixXd FacetWalk::directions_after(const FacetScattering& light, bool from_air) const {
    ScatteredRays inside[2], in_air[2];
    split(from_air ? light.refracted : light.reflected, inside[0], inside[1]);
    split(from_air ? light.reflected : light.refracted, in_air[0], in_air[1]);
    Eigen::MatrixXd energy(2 * g2_.size(), order_count_);
    energy << functions_.inside(inside[0], order_count_),
        functions_.in_air(in_air[0], order_count_), functions_.inside(inside[1], order_count_),
        functions_.in_air(in_air[1], order_count_);
    drop_unresolved_orders(energy);
    return energy;
}

/// Energy at the nodes of another grid: what varies slowly is the energy over g^2.
Eigen::MatrixXd FacetWalk::onto(const RefractionGrid& grid, int order) const {
    const ZenithGrid medium = grid.in_medium(index_);
    const ZenithGrid air = grid.in_medium(1.0);
    const Eigen::Index n = grid_.size();
    Eigen::MatrixXd energy = Eigen::MatrixXd::Zero(medium.size() + air.size(), g2_.size());
    for (Eigen::Index p = 0; p < medium.size(); ++p) {
        energy.row(p).head(n) = index_ * index_ * medium.weights[p] * medium.mu[p] *
                                functions_.inside_values(medium.mu[p], order).transpose();
    }
    for (Eigen::Index p = 0; p < air.size(); ++p) {
        energy.row(medium.size() + p).tail(g2_.size() - n) =
            air.weights[p] * air.mu[p] * functions_.in_air_values(air.mu[p], order).transpose();
    }
    return energy * g2_.cwiseInverse().asDiagonal();
}

FacetWalk::Start FacetWalk::start(const Beam& beam) const {
    const double lambda = smith_lambda(surface_, beam.mu);
    const Eigen::VectorXd first =
        heights(HeightNodes(), 1.0, 1.0 / (1.0 + lambda), 0.0, !beam.from_air);
    Start start{directions_after(beam.first.hidden, beam.from_air),
                Eigen::MatrixXd(2 * g2_.size(), kHeights)};
    for (Eigen::Index d = 0; d < start.heights.rows(); ++d) {
        // How many rays meet a facet is known ray by ray: nodes add where.
        const Eigen::VectorXd second = meets_[std::size_t(d)] * first;
        const double all = second.sum();
        start.heights.row(d) = all > kNoRay ? Eigen::VectorXd(second / all) : first;
    }
    return start;
}

std::vector<Eigen::MatrixXd> FacetWalk::leaving(const std::vector<Start>& beams,
                                                const RefractionGrid& grid) const {
    const Eigen::Index sides = g2_.size();
    const Eigen::Index directions = 2 * sides;
    const auto count = Eigen::Index(beams.size());
    const Eigen::MatrixXd to_grid[] = {onto(grid, 0), onto(grid, 1)};
    std::vector<Eigen::MatrixXd> energy;
    for (int m = 0; m < order_count_; ++m) {
        // Rays that meet a facet: rows are directions, columns heights by beams.
        Eigen::MatrixXd rays(directions, kHeights * count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const Start& beam = beams[std::size_t(k)];
            rays.middleCols(k * kHeights, kHeights) =
                beam.directions.col(m).asDiagonal() * beam.heights;
        }
        Eigen::MatrixXd left = Eigen::MatrixXd::Zero(sides, count);
        for (int facets = 2; facets <= kMostFacets; ++facets) {
            math::interruption_point();
            rays = turned_[std::size_t(m)] * rays;
            for (Eigen::Index d = 0; d < sides; ++d) {
                const HeightsOfBeams heights_of_beams(&rays(d, 0), kHeights, count,
                                                      {kHeights * directions, directions});
                left.row(d) += leaves_[std::size_t(d)] * heights_of_beams;
            }
            if (!(rays.cwiseAbs().sum() > kForgotten * double(count))) break;
            for (Eigen::Index d = 0; d < directions; ++d) {
                HeightsOfBeams heights_of_beams(&rays(d, 0), kHeights, count,
                                                {kHeights * directions, directions});
                heights_of_beams = (meets_[std::size_t(d)] * heights_of_beams).eval();
            }
        }
        energy.push_back(to_grid[m % 2] * left);
    }
    return energy;
}

}  // namespace miebrdf::rte
