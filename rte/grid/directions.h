// The directions in which radiance is known: the nodes that sample a hemisphere (and what these can
// tell of a function that has more detail than they have), and at the cosines that a caller asked
// for.
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
    /// 1 - mu falls to 0 like 1 - t at the end of the panel.
    bool ends_at_zenith() const;
    bool operator==(const GridPanel&) const = default;
};

/// Nodes and weights for integrals over mu in (0, 1), mu ascending. Ascending order matters: the
/// matrices built on it are graded (large at grazing), and their small eigenvalues stay accurate.
struct ZenithGrid {
    Eigen::VectorXd mu;
    Eigen::VectorXd weights;
    std::vector<GridPanel> panels = {};  ///< in the order of their nodes

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

/// @param kind   one of the three above; the caller has decided what `automatic` means
/// @param count  2 to 256
/// @throws UsageError  for a count out of range, or for `automatic`
ZenithGrid make_zenith_grid(GridKind kind, int count);

/// Waves per radian of zenith angle up to which nodes resolve light: pi over the distance between
/// neighbours. At `count` angles in equal steps from the zenith to the horizon, where it is large.
/// A grid without panels: none.
std::vector<double> resolved_waves(const ZenithGrid& grid, int count);

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

/// The cosines a caller asked for, each once, and which of them are incident and outgoing.
struct RequestedDirections {
    Eigen::VectorXd mu;
    std::vector<int> out;  ///< indices into mu
    std::vector<int> in;
    /// The last ones of both lists, this many, were not asked for: two solutions are compared
    /// there.
    std::size_t probes = 0;
    /// For each cosine that is both incident and outgoing the first of two of its own at the end of
    /// mu, a little below it, where transmission into the incident direction itself is found by
    /// extrapolation; -1 for the others. Empty where nothing asks for transmission.
    std::vector<int> beside = {};

    std::size_t asked_out() const { return out.size() - probes; }
    std::size_t asked_in() const { return in.size() - probes; }
};

/// Each cosine once, ascending, with the positions of both lists.
RequestedDirections collect(const std::vector<double>& mu_in, const std::vector<double>& mu_out);

/// A request with `beside`: mu (1 - kBeside) and mu (1 - 2 kBeside).
inline constexpr double kBeside = 3e-5;
RequestedDirections with_cosines_beside(RequestedDirections requested);

/// Whether all incident or all outgoing cosines are 1, where Y_l^m = 0 for m > 0: Fourier order 0
/// is all there is.
bool only_fourier_order_zero(const RequestedDirections& requested);

/// Whether cos(m azimuth) is zero at every azimuth, as for odd m across the plane of incidence.
bool fourier_order_vanishes(int fourier_order, std::span<const double> azimuth_deg);

}  // namespace miebrdf::rte
