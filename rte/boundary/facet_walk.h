// Light that meets two or more facets of a rough boundary before it leaves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/boundary/facet_scattering.h"
#include "rte/boundary/panel_functions.h"
#include "rte/grid/refraction_grid.h"

namespace miebrdf::rte {

/// The random walk of Heitz et al. 2016 on a Smith surface as a system of linear equations. The
/// state of a ray between two facets is its direction, on either side and away from the boundary or
/// towards it, and its height: u, the share of the surface that lies lower. A ray that starts at u
/// with the cosine mu away from the boundary
///
///     leaves with the probability u^Lambda, or meets a facet at v > u with the density
///     Lambda u^Lambda / v^(1 + Lambda);
///
/// one that goes towards it meets one at v < u with the density (1 + Lambda) v^Lambda / u^(1 +
/// Lambda). Below the surface the same holds with 1 - u and 1 - v. What leaves after two or more
/// facets varies slowly, so that few nodes do: kStreams for the directions, kHeights for u
/// (docs/maths-boundary.md has the errors).
class FacetWalk {
  public:
    static constexpr int kStreams = 14;
    static constexpr int kHeights = 5;

    FacetWalk(double index, const RoughSurface& surface, int orders);

    /// A beam from below or from air, after its first facet.
    struct Beam {
        bool from_air;
        double mu;  ///< cosine of incidence
        FacetScattering first;
    };
    /// Energy that leaves after two or more facets, for each order (nodes inside, nodes in air of
    /// grid) x beams.
    std::vector<Eigen::MatrixXd> leaving(const std::vector<Beam>& beams,
                                         const RefractionGrid& grid) const;

  private:
    Eigen::MatrixXd directions_after(const FacetScattering& light, bool from_air) const;
    Eigen::MatrixXd onto(const RefractionGrid& grid, int order) const;

    double index_;
    RoughSurface surface_;
    int order_count_;
    RefractionGrid grid_;
    PanelFunctions functions_;
    Eigen::VectorXd g2_;  ///< n^2 mu w of the nodes inside, then of those in air
    /// Of a ray in one direction, row and column for its height: what meets a facet at which
    /// height, and (one row) what leaves.
    std::vector<Eigen::MatrixXd> meets_;
    std::vector<Eigen::RowVectorXd> leaves_;
    /// For each order: what leaves a facet in which direction, by the direction it came in.
    std::vector<Eigen::MatrixXd> turned_;
};

}  // namespace miebrdf::rte
