// A smooth boundary between media of two refractive indices, on what lies below it.
// Equations and conventions: docs/maths-boundary.md.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "rte/grid/refraction_grid.h"
#include "rte/half_space/half_space.h"

namespace miebrdf::rte {

/// Fresnel reflectance of unpolarised light that meets `beyond` from a medium of index `here`, at
/// cosines in that medium; exactly 1 where it is totally reflected.
/// @param beyond  n + ik
double boundary_reflectance(double here, std::complex<double> beyond, double mu);
Eigen::VectorXd boundary_reflectance(double here, std::complex<double> beyond,
                                     const Eigen::VectorXd& mu);

/// The boundary at the nodes of the medium below it and at requested cosines. Of polarised light
/// (rte/stokes) each row is a component at a node or cosine; rows of U have reflectances between -1
/// and 1, and more or less than 1 - r passes.
struct SmoothBoundary {
    double index_below = 1.0, index_above = 1.0;
    Eigen::VectorXd at_nodes;             ///< reflectance r at the nodes of the medium below
    Eigen::VectorXd at_requested;         ///< and at the requested cosines
    Eigen::VectorXd passes_at_nodes;      ///< 1 - r
    Eigen::VectorXd passes_at_requested;  ///< 1 - r
    Eigen::Index nodes_above = 0;         ///< of the medium above
    Eigen::VectorXd trapped_above;  ///< r of those nodes above that the medium below does not have

    SmoothBoundary() = default;
    /// @param requested  cosines in the medium below
    SmoothBoundary(double below, double above, const RefractionGrid& grid,
                   const RequestedDirections& requested);
};

/// Light that is reflected for ever between two boundaries, as nothing lies between them: none gets
/// there, and none of it is seen.
void leave_out_unreachable(const Eigen::MatrixXd& X, Eigen::VectorXd& reflectance);

/// Reflection of one Fourier order by `below` seen through the boundary from above. Light that
/// comes back is reflected down again as often as it takes: with X of what lies below and Gamma =
/// diag(r),
///     X' = Gamma + (I - Gamma) X (I - Gamma X)^-1 (I - Gamma)
/// at the nodes that both media have, total reflection at the others; all by one Cholesky
/// decomposition of I - Gamma^(1/2) X Gamma^(1/2), or of polarised light with negative rows in
/// Gamma by elimination. Conserves energy to rounding on any grid.
///
/// @param below   with nodes and rows, in the cosines of the medium below
/// @param parts   what of the result is needed
/// @param sky     for ReflectorParts::sky: downward radiance at the nodes of the medium above
/// @param result  overwritten, in the cosines of the medium above; not `below`. Its specular part
///                has what the boundary itself reflects
void put_boundary_on(const SmoothBoundary& boundary, const Reflector& below,
                     const RequestedDirections& requested, ReflectorParts parts,
                     const Eigen::VectorXd& sky, FourierWork& work, Reflector& result);

}  // namespace miebrdf::rte
