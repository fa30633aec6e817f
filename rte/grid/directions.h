// Where radiance is known: at the nodes that sample a hemisphere, and at the cosines that a caller
// asked for.
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

/// The same with `beside`: mu (1 - kBeside) and mu (1 - 2 kBeside).
inline constexpr double kBeside = 3e-5;
RequestedDirections with_cosines_beside(RequestedDirections requested);

/// Whether all incident or all outgoing cosines are 1, where Y_l^m = 0 for m > 0: Fourier order 0
/// is all there is.
bool only_fourier_order_zero(const RequestedDirections& requested);

/// Whether cos(m azimuth) is zero at every azimuth, as for odd m across the plane of incidence.
bool fourier_order_vanishes(int fourier_order, std::span<const double> azimuth_deg);

}  // namespace miebrdf::rte
