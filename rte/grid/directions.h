// Directions of radiance: the nodes that sample a hemisphere, functions of mu as the nodes resolve
// them, and the cosines of a request.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include <miebrdf/solver.h>

namespace miebrdf::rte {

/// A part of the hemisphere that has Gauss nodes of its own: mu(t), smooth, with t in (0, 1).
struct GridPanel {
    enum class Map { straight, squared, circular };

    Eigen::Index count = 0;   ///< nodes
    Map map = Map::straight;  ///< c(t) / widest is t, t^2 (2 - t) or sin(pi t / 2)
    double widest = 1.0;
    double share = 1.0, beyond = 0.0;  ///< mu^2 = beyond + share c^2

    double cosine(double t) const;
    double slope(double t) const;  ///< dmu / dt
    /// Whether mu(1) = 1, with 1 - mu proportional to 1 - t there.
    bool ends_at_zenith() const;
    bool operator==(const GridPanel&) const = default;
};

/// Nodes and weights for integrals over mu in (0, 1), mu ascending. Ascending order matters: the
/// matrices built on it are graded (large at grazing), and their small eigenvalues stay accurate.
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

/// Gauss-Legendre in t with mu = t^2 (2 - t): near mu = 0 it goes like t^2 and resolves the
/// mu ln(mu) behaviour of the radiance at grazing directions; near mu = 1 its slope is 1, so that
/// the zenith stays as well resolved as with plain Gauss, which mu = t^2 does not do. Measured
/// against the family t^2 (1 + b - b t), b = 0 ... 2, and against others in docs/numerics.md.
/// Exact for polynomials of degree (2n - 3) / 3 in mu.
ZenithGrid make_mapped_gauss_grid(int count);

/// Chen et al. 2013, eq. (4): mu = cos(pi/4 G + pi/4), w = pi/4 W sin(pi/4 G + pi/4) with the Gauss
/// rule G, W on (-1, 1); normalised to sum w = 1. Clusters at the zenith.
ZenithGrid make_paper_grid(int count);

/// @param kind   one of the three above
/// @param count  2 to 256
/// @throws UsageError  for a count out of range, or for `automatic`
ZenithGrid make_zenith_grid(GridKind kind, int count);

/// The highest l for which nodes resolve waves cos(l theta): pi over the distance of neighbouring
/// nodes in zenith angle theta.
/// @return l at `count` zenith angles in equal steps from 0 to 90 degrees; empty for a grid without
///         panels
std::vector<double> resolved_waves(const ZenithGrid& grid, int count);

/// The values f_j at n nodes that stand for a function f(mu) in integrals over radiance,
///     f_j = 1/w_j int l_j(t) f(mu(t)) dmu,
/// where l_j is the polynomial in t (of its panel) that is 1 at node j and 0 at the others. Then
/// sum_j w_j f_j I(mu_j) is the integral of f times the polynomial through the I(mu_j), however
/// fast f varies; the point values f(mu_j) would alias once degrees add up to more than 2n - 1. For
/// odd Fourier orders, which vanish at the zenith like (1 - mu)^(1/2), l_j has the factor (1 -
/// t)^(1/2) / (1 - t_j)^(1/2).
struct NodeProjection {
    std::vector<GridPanel> panels;  ///< of the nodes
    int degrees = 0;                ///< Legendre degrees below it are integrated to rounding
    ZenithGrid fine;                ///< where f is sampled
    Eigen::MatrixXd even, odd;      ///< f_j = sum over samples, for even and odd Fourier orders

    const Eigen::MatrixXd& of_order(int fourier_order) const {
        return fourier_order % 2 == 0 ? even : odd;
    }
};

/// Whether f_j = f(mu_j), because the nodes integrate the product of any two degrees exactly.
bool points_suffice(const ZenithGrid& grid, int degrees);

/// @param degrees  the Legendre degrees of f are below it
NodeProjection project_on_nodes(const ZenithGrid& grid, int degrees);

/// The projections made last, for solutions that return to the same few numbers of nodes.
class NodeProjections {
  public:
    /// @return valid until the next call
    const NodeProjection& find(const ZenithGrid& grid, int degrees);

  private:
    std::vector<NodeProjection> known_;
};

/// The cosines of a request, each once, ascending, and which of them are incident and outgoing.
struct RequestedDirections {
    Eigen::VectorXd mu;
    std::vector<int> out;  ///< indices into mu
    std::vector<int> in;
    /// By cosine: where mu has mu (1 - kBeside), followed by mu (1 - 2 kBeside). Transmission from
    /// a direction into itself is extrapolated from there, so that only cosines that are both
    /// incident and outgoing have these two, at the end of mu; -1 for others. Empty where nothing
    /// asks for transmission.
    std::vector<int> beside = {};
};

RequestedDirections collect(const std::vector<double>& mu_in, const std::vector<double>& mu_out);

/// The request with `beside`.
inline constexpr double kBeside = 3e-5;
RequestedDirections with_cosines_beside(RequestedDirections requested);

/// Whether light as a number has Fourier order 0 alone: all incident or all outgoing cosines are 1,
/// where Y_l^m = 0 for m > 0.
bool only_fourier_order_zero(const RequestedDirections& requested);

/// Whether cos(m azimuth) = 0 at every azimuth, as for odd m at 90 degrees.
bool fourier_order_vanishes(int fourier_order, std::span<const double> azimuth_deg);

}  // namespace miebrdf::rte
