// Anything that reflects below the layers, in the forms that layers above it need, and
// the reflection by a semi-infinite homogeneous medium, a Lambertian ground or nothing.
// Symbols, signs and normalisation: docs/conventions.md.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <miebrdf/solver.h>
#include <miebrdf/surface.h>
#include "rte/math/matrices.h"

namespace miebrdf::rte {

struct FourierMedium;
struct FourierMode;
struct FourierWork;
struct RequestedDirections;
struct ZenithGrid;

/// How much of a reflector its user needs besides `multiple`, the BRDF.
enum class ReflectorParts {
    pairs,  ///< nothing more
    sky,    ///< `sky_at_requested`, `sky_at_nodes`: plane and spherical albedos
    nodes,  ///< `rows` and `nodes`: anything that lies under a coat
};

/// Reflection R^m(mu_out, mu_in) of one Fourier order on a grid of n nodes and r requested
/// cosines. Every form is exact for the discrete equation; requested cosines act like nodes of
/// weight zero.
struct Reflector {
    /// X = 2 D R D with D = (W M)^(1/2), n x n, symmetric: takes downward to upward radiance in
    /// the normalisation where the flux is the square of the Euclidean norm. ||X|| <= 1.
    Eigen::MatrixXd nodes;
    /// 2 R(mu, mu_q) D_q, r x n: upward radiance at a requested cosine from downward ones at nodes.
    Eigen::MatrixXd rows;
    /// R(mu_out, mu_in) of light scattered more than once in the media, out x in. The first order
    /// of scattering is known in closed form (first_order.h) and never summed over Fourier orders.
    Eigen::MatrixXd multiple;
    /// Upward radiance under a given sky, a vector of downward radiance at the nodes: rows * sky
    /// and nodes * sky.
    Eigen::VectorXd sky_at_requested;
    Eigen::VectorXd sky_at_nodes;
    /// Upward radiance of uniform unit emission by a ground that lies below everything, in the
    /// normalisations of the sky's, where somebody asked. Reciprocity makes it the transmittance:
    /// of light incident at that cosine, the flux that arrives at the ground, counted as often as
    /// it does.
    Eigen::VectorXd transmittance_at_requested;
    Eigen::VectorXd transmittance_at_nodes;
    bool has_transmittance = false;
    /// The share of a beam at each requested cosine that comes back into the mirror direction
    /// without being scattered; `rows` and `multiple` are without it, `nodes` has it on the
    /// diagonal. Empty: none.
    Eigen::VectorXd specular;
    /// Polarised light with V: `specular` also turns U into V, by this times the other row.
    Eigen::VectorXd specular_twist;
    int iterations = 0;     ///< of an iterative method, else 0
    double residual = 0.0;  ///< largest (mu + mu') |change of R| in the last step, relative
    bool converged = true;  ///< of the iteration
    bool physical = false;  ///< positive definite equations: a physical solution exists
};

/// (W M)^(1/2) of a grid.
Eigen::VectorXd flux_weights(const ZenithGrid& grid);

/// The light that one more order of scattering adds to incident light: 2 (-1)^(l-m) mu sum R W Y,
/// so that Y + this is Ambartsumian's function phi_l. From rows (2 R D) at cosines mu: rows x (L -
/// m).
void reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows, const FourierMode& mode,
                       Eigen::MatrixXd& moments);
Eigen::MatrixXd reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                                  const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                  const FourierMode& mode);

/// Reflection by a ground that is the same in all directions (Lambert), albedo in [0, 1]: Fourier
/// order 0 only, zero for any other.
void lambertian_ground(double albedo, const FourierMode& mode, const ZenithGrid& grid,
                       const RequestedDirections& requested, Reflector& ground);

/// The Fourier orders of a ground's BRDF, found once for nodes and cosines.
class GroundOrders {
  public:
    /// Reflection by a ground; unpolarised light leaves it. Light that nothing else scatters is
    /// left out of `multiple` (ground_reflection).
    /// @param nodes, cosines  each once, however many rows they have
    /// @param orders          that are needed at most
    void fill(const GroundBrdf& ground, const FourierMode& mode, const ZenithGrid& nodes,
              const RequestedDirections& cosines, int orders, const ZenithGrid& grid,
              const RequestedDirections& requested, Reflector& reflector);

  private:
    void find(int first, int orders);

    GroundBrdf ground_;
    Eigen::VectorXd nodes_, cosines_;
    int first_ = 0;                        ///< order of the first matrix
    std::vector<Eigen::MatrixXd> orders_;  ///< R^m: rows nodes, then cosines; columns nodes
};

/// Reflection by a smooth mirror of reflectance s: sent to where it came from and nowhere else.
/// @param at_nodes, at_requested  s, in [0, 1]
void mirror_ground(const Eigen::VectorXd& at_nodes, const Eigen::VectorXd& at_requested,
                   const RequestedDirections& requested, Reflector& mirror);

/// Nothing below: black.
void no_reflection(const ZenithGrid& grid, const RequestedDirections& requested, Reflector& none);

/// Solves Ambartsumian's equation (Chen et al. 2013, eq. 3) for one Fourier order.
///
/// `automatic`: in closed form. The equation is a symmetric algebraic Riccati equation whose
/// physical solution is a matrix geometric mean: with the matrices of eigenmodes.h,
/// Z = F k F^T solves Z V Z = U, and X = 2 (I + Z)^-1 - I; then one application of eq. (3) removes
/// the rounding at grazing nodes. About 19 n^3 operations, exact at albedo 1. High Fourier orders,
/// where a few sweeps of the fixed point reach the tolerance, are solved by these instead: to the
/// tolerance times their own largest (mu + mu') R or a tenth of that of order 0
/// (FourierMedium::brightness), whichever is more.
/// `fixed_point`: the paper's iteration from single scattering; the number of steps grows without
/// bound as the albedo tends to 1.
/// `doubling`: structured doubling from a thin layer, quadratically convergent; independent of any
/// eigenproblem.
///
/// @param tolerance  of the iterative methods: remaining error of (mu + mu') R, relative
/// Not converging is an outcome: read `converged` and `physical`.
/// @param work  matrices that one Fourier order after the other can use
/// @param result  overwritten
void solve_half_space(HalfSpaceMethod method, const FourierMedium& medium, const FourierMode& mode,
                      const ZenithGrid& grid, const RequestedDirections& requested,
                      double tolerance, FourierWork& work, Reflector& result);
Reflector solve_half_space(HalfSpaceMethod method, const FourierMedium& medium,
                           const FourierMode& mode, const ZenithGrid& grid,
                           const RequestedDirections& requested, double tolerance = 1e-12);

/// X by the paper's fixed-point iteration; fills nodes, iterations, residual, converged, physical.
Reflector iterate_half_space(const FourierMedium& medium, const FourierMode& mode,
                             const ZenithGrid& grid, double tolerance);

/// X by structured doubling; fills the same.
Reflector double_to_half_space(const FourierMedium& medium, const FourierMode& mode,
                               const ZenithGrid& grid, double tolerance);

}  // namespace miebrdf::rte
