// Light of any direction as values at the nodes of a RefractionGrid.
#pragma once

#include <Eigen/Core>

#include "rte/boundary/facet_scattering.h"
#include "rte/grid/refraction_grid.h"

namespace miebrdf::rte {

/// The Lagrange functions of a grid for one index: each belongs to one node, is a polynomial of the
/// Gauss variable t in its panel and 0 in all others. In odd Fourier orders, where radiance has the
/// factor sin(theta), so have they: (q / q_p) l_p, q = n sin(theta). `index` is the largest of the
/// grid.
class PanelFunctions {
  public:
    PanelFunctions(const RefractionGrid& grid, double index);

    /// Functions of all nodes, and in air of the last ones.
    Eigen::VectorXd inside_values(double mu, int order) const;
    Eigen::VectorXd in_air_values(double mu_air, int order) const;

    /// Energy of rays inside the medium, all mu > 0, in every order: energy cos(order azimuth) by
    /// the functions of mu.
    /// @return  nodes x orders
    Eigen::MatrixXd inside(const ScatteredRays& rays, int orders) const;
    /// The same for rays in air: of the nodes below index 1 alone, the last ones.
    Eigen::MatrixXd in_air(const ScatteredRays& rays, int orders) const;

  private:
    struct Position {
        std::size_t panel;
        double t;
    };
    Position inside_at(double mu) const;
    Position in_air_at(double mu_air) const;
    template <typename Locate>
    Eigen::MatrixXd collect(const ScatteredRays& rays, int orders, double index,
                            const Locate& locate) const;
    void evaluate(const Position& at, double* values) const;

    RefractionGrid grid_;
    double index_;
    Eigen::VectorXd q_;      ///< of the nodes
    Eigen::VectorXd scale_;  ///< 1 / product of (t_p - t_k) over the other nodes of p's panel
};

}  // namespace miebrdf::rte
