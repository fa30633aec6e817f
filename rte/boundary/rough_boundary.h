// The rough boundary between air and a medium: matrices of what it sends where, light that meets
// two or more facets before it leaves, and the functions on panels of cosines in which both are
// written. Equations: docs/maths-boundary.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

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
    Eigen::MatrixXd collect(const ScatteredRays& rays,
                            const std::vector<std::pair<std::size_t, Position>>& some,
                            Eigen::Index nodes, int orders, double index) const;
    void evaluate(const Position& at, double* values) const;

    RefractionGrid grid_;
    double index_;
    Eigen::VectorXd q_;      ///< of the nodes
    Eigen::VectorXd scale_;  ///< 1 / product of (t_p - t_k) over the other nodes of p's panel
};

/// Rays resolve the azimuth up to some order, and in higher ones their sums are noise that grows
/// with the order: beyond the order in which a beam's energies are smallest they become 0.
/// @param energy  of one beam, nodes x orders
void drop_unresolved_orders(Eigen::MatrixXd& energy);

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
        FirstMeeting first;
    };
    /// What of it meets a second facet: directions of every order, and where rays of each direction
    /// meet it (directions x heights). Rays take a hundred times the memory.
    struct Start {
        Eigen::MatrixXd directions, heights;
    };
    Start start(const Beam& beam) const;
    /// Energy that leaves after two or more facets, for each order (nodes inside, nodes in air of
    /// grid) x beams.
    std::vector<Eigen::MatrixXd> leaving(const std::vector<Start>& beams,
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

/// What light from requested directions in air does, rows in the order of the request.
struct LightFromAir {
    /// For each Fourier order m, requested x nodes: rows e such that the medium below, with the
    /// reflection X = 2 D R D in this order, is seen from air with
    ///     R(out, in) = e_out^T (I - X Gamma)^-1 X e_in / (2 n^2),   Gamma = inside(m).
    /// A smooth boundary at a node would have t / D there and 0 elsewhere. D . e is the energy that
    /// enters in order 0.
    std::vector<Eigen::MatrixXd> entering;
    Eigen::VectorXd outer_reflectance;  ///< energy that does not enter: 1 - D . e
    /// The part of `entering` of light that has met one facet alone.
    std::vector<Eigen::MatrixXd> entering_at_once;
    /// c, close to 1, by which the energy of each direction is scaled: what FacetWalk missed.
    Eigen::VectorXd compensation;
};

/// One rough boundary on one grid; made once, used for all scenes of that index.
///
/// Light that meets one facet is followed exactly, what meets more by FacetWalk. What both miss in
/// the energy balance of order 0 (4e-4 but for grazing light) is put back evenly, so that nothing
/// is lost or won.
class RoughBoundary {
  public:
    /// 35 to 90 ms for 24 nodes and 12 orders.
    /// @param index  of the medium, 1.05 to 3; below, nearly all light passes straight on through
    ///               many facets, for which FacetWalk has too few nodes
    /// @param grid   whose largest index this is: RefractionGrid({index}, streams), or what a grid
    ///               of several media has within() it; 4 to 1024 nodes
    /// @param orders  at least 1: Fourier orders 0 ... orders - 1
    /// @throws UsageError  for an argument out of range
    RoughBoundary(double index, const RoughSurface& surface, const RefractionGrid& grid,
                  int orders);
    /// The grid of one medium.
    RoughBoundary(double index, const RoughSurface& surface, int streams, int orders)
        : RoughBoundary(index, surface, RefractionGrid({index}, streams), orders) {}

    /// The same for an index between three others, by a parabola through their matrices: hosts have
    /// an index that changes slowly with the wavelength, and matrices take thousands of times
    /// longer to make than to interpolate.
    /// @param neighbours  of the same surface, nodes and orders, of one medium each, with three
    ///                    different indices
    RoughBoundary(double index, std::array<std::shared_ptr<const RoughBoundary>, 3> neighbours);

    double index() const { return index_; }
    const RoughSurface& surface() const { return surface_; }
    const RefractionGrid& grid() const { return grid_; }
    int orders() const { return int(inside_.size()); }

    /// Gamma of order m, nodes x nodes, symmetric: light from below that is sent back down, from
    /// j = D I to j = D I, D = (w mu)^(1/2) of grid().in_medium(index). Smooth: diag(r).
    const Eigen::MatrixXd& inside(int m) const { return inside_[std::size_t(m)]; }

    /// @param mu_air  each in (0, 1]
    LightFromAir from_air(const Eigen::VectorXd& mu_air) const;

    /// The mean of LightFromAir::entering, of order 0, over diffuse light from air. Each direction
    /// conserves energy for itself, so that this is better known than what inside() lets through.
    Eigen::VectorXd sky_entering() const;

    /// Of diffuse light from below and from above: (1 - inside) n^2 = 1 - outside.
    double internal_diffuse_reflectance() const { return internal_; }
    double external_diffuse_reflectance() const { return external_; }

  private:
    /// Energies of beams from air: for each order, requested x (nodes inside, nodes in air).
    struct EnergyFromAir {
        Eigen::VectorXd mu_air;
        std::vector<Eigen::MatrixXd> by_order;
        std::vector<Eigen::MatrixXd> at_once;  ///< its part inside, of what met one facet alone
    };
    struct Neighbour {
        std::shared_ptr<const RoughBoundary> boundary;
        double weight;
    };

    Eigen::Index nodes_in_air() const { return grid_.nodes_below(1.0); }
    FacetWalk::Beam beam_at_facet(bool from_air, double mu) const;
    /// Energy of a beam that leaves after its first facet, (nodes inside, nodes in air) x orders.
    Eigen::MatrixXd after_one_facet(const FacetWalk::Beam& beam) const;
    void keep(Eigen::MatrixXd order_0, Eigen::VectorXd sky);
    Eigen::VectorXd sky_of(const Eigen::MatrixXd& from_air) const;
    std::shared_ptr<const EnergyFromAir> energy_from_air(const Eigen::VectorXd& mu_air) const;
    EnergyFromAir followed(const Eigen::VectorXd& mu_air) const;
    EnergyFromAir interpolated(const Eigen::VectorXd& mu_air) const;

    double index_;
    RoughSurface surface_;
    int order_count_;
    RefractionGrid grid_;
    double refinement_ = 1.0;                  ///< of facets
    std::vector<double> edges_;                ///< cosines inside where panels of other hosts end
    std::optional<PanelFunctions> functions_;  ///< these two only where rays are followed
    std::optional<FacetWalk> walk_;
    std::vector<Neighbour> neighbours_;  ///< and these where matrices are interpolated
    Eigen::VectorXd d_;                  ///< D inside
    Eigen::VectorXd g_;                  ///< n D of the nodes inside, then the same of those in air
    std::vector<Eigen::MatrixXd> inside_;
    Eigen::MatrixXd order_0_;  ///< all parts
    Eigen::VectorXd sky_;      ///< energy of diffuse light from air (nodes inside, nodes in air)
    double internal_ = 0.0, external_ = 0.0;
    /// The last requests: all wavelengths of a scene ask the neighbours for the same few lists of
    /// directions (those of values, of a table, of the outer lobe), one after the other.
    static constexpr std::size_t kKeptRequests = 8;
    mutable std::mutex mutex_;
    mutable std::list<std::shared_ptr<const EnergyFromAir>> kept_;
};

}  // namespace miebrdf::rte
