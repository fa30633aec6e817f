// Zenith cosines mu: the nodes that sample a hemisphere, functions of mu projected on the nodes,
// and the cosines of a request.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include <miebrdf/solver.h>

namespace miebrdf::rte {

/// A part of the hemisphere that has Gauss nodes of its own, at t in (0, 1):
///     mu(t)^2 = offset + factor c(t)^2,   c(t) = widest shape(t).
/// c is the cosine in the medium of the panel, mu that in the medium of the grid; without
/// refraction they are the same (offset 0, factor 1).
struct GridPanel {
    enum class Map { straight, squared, circular };

    Eigen::Index count = 0;   ///< nodes
    Map map = Map::straight;  ///< shape(t): t, t^2 (2 - t) or sin(pi t / 2)
    double widest = 1.0;      ///< the largest c
    double factor = 1.0, offset = 0.0;

    double cosine(double t) const;
    double slope(double t) const;  ///< dmu / dt
    /// Whether the panel ends at mu = 1, where 1 - mu is proportional to 1 - t.
    bool ends_at_zenith() const;
    bool operator==(const GridPanel&) const = default;
};

/// Nodes and weights for integrals over mu in (0, 1). mu ascends, because matrices on the nodes are
/// then graded (largest at grazing angles) and their small eigenvalues stay accurate.
struct ZenithGrid {
    Eigen::VectorXd mu;
    Eigen::VectorXd weights;
    std::vector<GridPanel> panels = {};  ///< in ascending order of mu

    Eigen::Index size() const { return mu.size(); }
};

/// Gauss nodes of each panel; panels in ascending order of mu.
ZenithGrid make_panel_grid(std::vector<GridPanel> panels);

/// Gauss-Legendre on (0, 1): exact for polynomials of degree 2n - 1 in mu.
ZenithGrid make_gauss_grid(int count);

/// Gauss-Legendre in t with mu = t^2 (2 - t): near mu = 0 the map goes like 2 t^2 and resolves the
/// mu ln(mu) of the radiance at grazing angles; at mu = 1 its slope is 1, so that the zenith is
/// resolved as by plain Gauss (mu = t^2 resolves it half as well). Exact for polynomials of degree
/// (2n - 3) / 3 in mu. docs/numerics.md compares the family t^2 (1 + b - b t), b = 0 ... 2.
ZenithGrid make_mapped_gauss_grid(int count);

/// Chen et al. 2013, eq. (4): mu = cos(pi/4 G + pi/4), w = pi/4 W sin(pi/4 G + pi/4) with the Gauss
/// rule G, W on (-1, 1); normalised to sum w = 1. Clusters at the zenith.
ZenithGrid make_paper_grid(int count);

/// @param kind   one of the three above
/// @param count  2 to 256
/// @throws UsageError  for a count out of range, or for `automatic`
ZenithGrid make_zenith_grid(GridKind kind, int count);

/// The highest degree l of which nodes resolve the waves cos(l theta): l = pi / (distance of
/// neighbouring nodes in the zenith angle theta).
/// @return l at `count` zenith angles in equal steps from 0 to 90 degrees; empty for a grid without
///         panels
std::vector<double> resolved_waves(const ZenithGrid& grid, int count);

/// The values f_j at n nodes that represent a function f(mu) in integrals over radiance I,
///     f_j = 1/w_j int l_j(t) f(mu(t)) dmu,
/// l_j being the polynomial in t (of its panel) that is 1 at node j and 0 at the others. Then
/// sum_j w_j f_j I(mu_j) is the integral of f times the polynomial through the I(mu_j), however
/// fast f varies; point values f(mu_j) would alias where degrees add up to more than 2n - 1.
/// Odd Fourier orders vanish at the zenith like (1 - mu)^(1/2): for them l_j has the factor
/// ((1 - t) / (1 - t_j))^(1/2).
struct NodeProjection {
    std::vector<GridPanel> panels;  ///< of the nodes
    int degrees = 0;                ///< Legendre degrees below it are integrated to rounding
    ZenithGrid fine;                ///< where f is sampled
    Eigen::MatrixXd even, odd;      ///< f at nodes from f at `fine`, by parity of the Fourier order

    const Eigen::MatrixXd& of_order(int fourier_order) const {
        return fourier_order % 2 == 0 ? even : odd;
    }
};

/// Whether f_j = f(mu_j), because the nodes integrate the product of any two degrees exactly.
bool points_suffice(const ZenithGrid& grid, int degrees);

/// @param degrees  the Legendre degrees of f are below it
NodeProjection project_on_nodes(const ZenithGrid& grid, int degrees);

/// Keeps the last projections made, because solutions return to the same few numbers of nodes.
class NodeProjections {
  public:
    /// @return valid until the next call
    const NodeProjection& find(const ZenithGrid& grid, int degrees);

  private:
    std::vector<NodeProjection> known_;
};

/// The cosines of a request, each once, ascending.
struct RequestedDirections {
    Eigen::VectorXd mu;
    std::vector<int> out, in;  ///< the outgoing and the incident cosines: indices into mu
    /// Transmission from a direction into itself is extrapolated from two cosines beside it,
    /// mu (1 - kBeside) and mu (1 - 2 kBeside), which stand at the end of `mu`. For each cosine the
    /// index of the first one; -1 where the cosine is not both incident and outgoing. Empty where
    /// no transmission is wanted.
    std::vector<int> beside = {};
};

RequestedDirections collect(const std::vector<double>& mu_in, const std::vector<double>& mu_out);

/// Relative distance of the cosines of RequestedDirections::beside.
inline constexpr double kBeside = 3e-5;
RequestedDirections with_cosines_beside(RequestedDirections requested);

/// Whether unpolarised light has Fourier order 0 alone: all incident or all outgoing cosines are 1,
/// where Y_l^m = 0 for m > 0.
bool only_fourier_order_zero(const RequestedDirections& requested);

/// Whether cos(m azimuth) = 0 at every azimuth, as for odd m at 90 degrees.
bool fourier_order_vanishes(int fourier_order, std::span<const double> azimuth_deg);

}  // namespace miebrdf::rte
