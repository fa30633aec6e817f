// Smooth boundaries and mirrors as the solvers of polarised light see them: rows of Stokes vectors
// along the axes of the meridian plane (StokesTables::along_axes), in which they are diagonal.
#pragma once

#include <vector>

#include "rte/boundary/fresnel_matrix.h"
#include "rte/boundary/smooth_boundary.h"
#include "rte/stokes/stokes_mode.h"

namespace miebrdf::rte {

/// Reflection from below at the nodes and at requested cosines, and from above at the nodes that
/// the medium below does not have.
struct FresnelReflections {
    double index_below = 1.0, index_above = 1.0;
    Eigen::Index nodes_above = 0;  ///< of the medium above, once each
    std::vector<FresnelMatrix> at_nodes, at_requested, trapped_above;

    /// @param nodes      of the medium below, once each
    /// @param above      of the medium above
    /// @param requested  cosines in the medium below, once each
    FresnelReflections(double below, double over, const ZenithGrid& nodes, const ZenithGrid& above,
                       const RequestedDirections& requested);
};

/// Fresnel's matrices at cosines in a medium of index `here`.
std::vector<FresnelMatrix> fresnel_reflections(double here, std::complex<double> beyond,
                                               const Eigen::VectorXd& mu);
std::vector<FresnelMatrix> passing(const std::vector<FresnelMatrix>& reflections);

/// One row for each component of a block at each cosine: parallel, across, and of U and V the real
/// part of `cross` times a sign.
Eigen::VectorXd fresnel_rows(const std::vector<FresnelMatrix>& matrices, const StokesBlock& block,
                             double sign_of_cross);

/// put_boundary_on takes it. Of the reflection between i_up and D4 i_down rows of U and V have -Re
/// c (FresnelMatrix): 1 where everything is reflected at normal incidence. What turns U into V is
/// left out.
SmoothBoundary polarised_boundary(const FresnelReflections& matrices, const StokesBlock& block);

/// The mirror under a medium of index `here` at cosines, likewise.
Eigen::VectorXd polarised_mirror(double here, std::complex<double> mirror,
                                 const Eigen::VectorXd& mu, const StokesBlock& block);

}  // namespace miebrdf::rte
