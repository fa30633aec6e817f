// What the nodes can tell of a function of the cosine that has more detail than they have.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/grid/directions.h"

namespace miebrdf::rte {

/// Functions of mu as the polynomials through n nodes see them. With l_j the polynomial in t (of
/// its panel) that is 1 at node j and 0 at the others, a function f becomes
///     f_j = 1/w_j int l_j(t) f(mu(t)) dmu,
/// so that sum_j w_j f_j I(mu_j) is the integral of f times the polynomial through the I(mu_j),
/// however fast f varies: point values would alias as soon as degrees add up to more than 2n - 1.
/// Odd Fourier orders vanish at the zenith like (1 - mu)^(1/2); there l_j has the factor
/// (1 - t)^(1/2) / (1 - t_j)^(1/2).
struct NodeProjection {
    std::vector<GridPanel> panels;  ///< of the nodes
    int degrees = 0;                ///< integrated as well as rounding allows
    ZenithGrid fine;                ///< where functions are sampled
    Eigen::MatrixXd even, odd;      ///< f_j from samples, by the parity of the Fourier order

    const Eigen::MatrixXd& of_order(int fourier_order) const {
        return fourier_order % 2 == 0 ? even : odd;
    }
};

/// Whether the nodes integrate the product of any two degrees exactly: the projection would change
/// nothing.
bool points_suffice(const ZenithGrid& grid, int degrees);

/// @param degrees  the highest Legendre degree is below it
NodeProjection project_on_nodes(const ZenithGrid& grid, int degrees);

/// The projections that a solution with several numbers of nodes uses again and again.
class NodeProjections {
  public:
    /// @return valid until the next call
    const NodeProjection& find(const ZenithGrid& grid, int degrees);

  private:
    std::vector<NodeProjection> known_;
};

}  // namespace miebrdf::rte
