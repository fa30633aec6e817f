// Anything that reflects, one azimuthal order, in the forms that layers above it need.
#pragma once

#include <Eigen/Core>

#include "rte/grid/zenith_grid.h"
#include "rte/phase/phase_mode.h"

namespace miebrdf::rte {

/// How much of a reflector its user needs beside `multiple`, the BRDF.
enum class ReflectorParts {
    pairs,  ///< nothing
    sky,    ///< `sky_at_requested`, `sky_at_nodes`: plane and spherical albedos
    nodes,  ///< `rows` and `nodes`: anything that lies under a coat
};

/// Reflection R^m(mu_out, mu_in) of one azimuthal order on a grid of n nodes and r requested
/// cosines. Every form is exact for the discrete equation; requested cosines act like nodes of
/// weight zero.
struct Reflector {
    /// X = 2 D R D with D = (W M)^(1/2), n x n, symmetric: takes downward to upward radiance in
    /// the normalisation where the flux is the square of the Euclidean norm. ||X|| <= 1.
    Eigen::MatrixXd nodes;
    /// 2 R(mu, mu_q) D_q, r x n: upward radiance at a requested cosine from downward ones at nodes.
    Eigen::MatrixXd rows;
    /// R(mu_out, mu_in) of light scattered more than once in the media, out x in. The first order
    /// is known in closed form (single_scattering.h) and never summed in modes.
    Eigen::MatrixXd multiple;
    /// Upward radiance under a given sky, a vector of downward radiance at the nodes: rows * sky
    /// and nodes * sky.
    Eigen::VectorXd sky_at_requested;
    Eigen::VectorXd sky_at_nodes;
    int iterations = 0;     ///< of an iterative method, else 0
    double residual = 0.0;  ///< largest (mu + mu') |change of R| in the last step, relative
    bool converged = true;  ///< of the iteration
    bool physical = false;  ///< positive definite equations: a physical solution exists
};

/// (W M)^(1/2) of a grid.
Eigen::VectorXd flux_weights(const ZenithGrid& grid);

/// What one order of scattering more adds to incident light: 2 (-1)^(l-m) mu sum R W Y, so that
/// Y + this is Ambartsumian's function phi_l. From rows (2 R D) at cosines mu: rows x (L - m).
void reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                       const Eigen::Ref<const Eigen::MatrixXd>& rows, const PhaseMode& mode,
                       math::ScratchMatrix& moments);
math::ScratchMatrix reflected_moments(const Eigen::Ref<const Eigen::VectorXd>& mu,
                                      const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                      const PhaseMode& mode);

/// Reflection by a surface that is the same for all directions (Lambert), albedo in [0, 1]: order 0
/// only, zero for any other.
void lambertian_ground(double albedo, const PhaseMode& mode, const ZenithGrid& grid,
                       const RequestedDirections& requested, Reflector& ground);

/// Nothing below: black.
void no_reflection(const ZenithGrid& grid, const RequestedDirections& requested, Reflector& none);

}  // namespace miebrdf::rte
