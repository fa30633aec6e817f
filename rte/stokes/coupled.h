// Stokes vectors of which V is coupled to U, by b2 of a medium, by total reflection or by a metal:
// the equations are no longer symmetric. Eigenmodes, half-spaces, layers; smooth boundaries and
// mirrors, in rows of Stokes vectors along the axes of the meridian plane
// (StokesTables::along_axes), in which they are diagonal.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "rte/boundary/fresnel_matrix.h"
#include "rte/boundary/smooth_boundary.h"
#include "rte/fourier/eigenmodes.h"
#include "rte/half_space/half_space.h"
#include "rte/layer/layer.h"
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

/// A matrix close to the rates of eigenmodes is to these equations what eigenmodes are to
/// symmetric ones.
/// With J = diag(1, 1, 1, -1): U^T = J U J, V^T = J V J, and Z V Z = U still has the wanted
/// solution, J Z symmetric. In the eigenmodes of the symmetric parts, F = diag(F_l, F_c) (l: the
/// rows of I, Q and U, c: those of V),
///     F^T V F = I + [[0, w], [-w^T, 0]],  F^-1 U F^-T = k^2 + [[0, u], [-u^T, 0]],
///     F^-1 Z F^-T = [[S, K], [-K^T, T]], S and T symmetric,
/// found by Newton's method with the derivative of b2 = 0: dZ_ij = (U - Z V Z)_ij / (k_i + k_j).
class CoupledModes {
  public:
    /// @param block  ends with V
    /// @param grid, requested  once each
    /// @param tolerance  of the changes, relative
    /// @return false where the equations have no physical solution or the steps do not converge
    bool find(const StokesTables& tables, const StokesBlock& block, const MatrixStrengths& medium,
              double one_minus_albedo, const ZenithGrid& grid, const RequestedDirections& requested,
              double tolerance);

    const Eigenmodes& linear() const { return linear_.eigenmodes(); }
    const Eigenmodes& circular() const { return circular_.eigenmodes(); }
    /// S, K, T of F^-1 Z F^-T.
    Eigen::MatrixXd S, K, T;
    /// F^T V Z F^-T: the field s inside a half-space, F^T V a elsewhere, is exp(-rates tau) of that
    /// on top. Close to diag(k).
    Eigen::MatrixXd rates;
    /// F^-T = V F of the symmetric parts.
    Eigen::MatrixXd inverse_linear, inverse_circular;
    int steps = 0;

  private:
    void form_couplings(const StokesTables& tables, const StokesBlock& block,
                        const MatrixStrengths& medium, const ZenithGrid& grid);
    bool iterate(double tolerance);

    EigenmodeSolver linear_, circular_;
    FourierMode linear_mode_, circular_mode_;
    FourierMedium linear_medium_, circular_medium_;
    Eigen::MatrixXd omega_, upsilon_;  ///< w, u
    Eigen::MatrixXd R11_, R12_, R22_, SW_, KW_;
};

/// Memory of the coupled solvers.
struct CoupledWork {
    CoupledModes modes;
    FourierWork fourier;  ///< of the pairs
};

/// The sources of light at the requested cosines out of s and a in the coordinates of CoupledModes:
/// E F^-T and O F Z^ (ScatteringKernels, Z^ = F^-1 Z F^-T), requested x eigenmodes.
struct CoupledSources {
    Eigen::MatrixXd even, odd;
};
CoupledSources sources_of(const FourierMode& mode, const FourierMedium& medium,
                          const CoupledModes& modes, int rows_per_node);

/// Rows in those coordinates times F^T: rows over the nodes of the block.
Eigen::MatrixXd sources_at_nodes(const CoupledModes& modes, const Eigen::MatrixXd& rows,
                                 int rows_per_node);

/// [[linear, mixed], [-mixed^T, circular]] with its rows node by node.
Eigen::MatrixXd joined(const Eigen::MatrixXd& linear, const Eigen::MatrixXd& mixed,
                       const Eigen::MatrixXd& circular, int rows_per_node);

/// The rows of a block that are V: its last component. J, as signs of rows.
Eigen::VectorXd metric(Eigen::Index rows, int rows_per_node);

/// X = 2 (I + Z)^-1 - I, rows as in Reflector: node by node, V last.
/// @return false if there is no physical solution
bool reflection_of(const Eigen::MatrixXd& Z_linear, const Eigen::MatrixXd& Z_mixed,
                   const Eigen::MatrixXd& Z_circular, int rows_per_node, Eigen::MatrixXd& X);

/// Works as solve_half_space does, for a block that ends with V and a medium with b2.
/// @param mode, medium  of the whole block (make_block_mode)
/// @param grid, requested  repeated(); `nodes`, `cosines` are the same once each
/// @param result  `nodes` and `rows` are X, which is not symmetric; `multiple` is X as well
void solve_coupled_half_space(const StokesTables& tables, const StokesBlock& block,
                              const MatrixStrengths& strengths, const FourierMode& mode,
                              const FourierMedium& medium, const ZenithGrid& nodes,
                              const RequestedDirections& cosines, const ZenithGrid& grid,
                              const RequestedDirections& requested, double tolerance,
                              CoupledWork& work, Reflector& result);

/// Mueller matrices, one for each node or cosine, as they act on rows of Stokes vectors that end
/// with U and V: each row times `diagonal`, and of U and V the other row times `twist`, which has
/// opposite signs in both. They commute.
struct TwistedRows {
    Eigen::VectorXd diagonal, twist;

    Eigen::MatrixXd times(const Eigen::MatrixXd& rows, int rows_per_node) const;
    TwistedRows following(const TwistedRows& other, int rows_per_node) const;
    Eigen::MatrixXd of_node(Eigen::Index node, int rows_per_node) const;
};

/// Reflector::specular and its twist; zeros without.
TwistedRows specular_of(const Reflector& reflector, Eigen::Index rows);

/// The light that arrives at the nodes from some of the requested cosines, columns, out of the
/// light that leaves from the nodes there, rows: J rows^T J.
Eigen::MatrixXd arriving(const Eigen::MatrixXd& rows, const std::vector<int>& which,
                         int rows_per_node);

/// Works as solve_layer does, out of the complex eigenmodes of CoupledModes::rates: Z_p = Z tanh(A
/// tau/2), Z_m = Z coth(A tau/2). About 30 times the work of the symmetric equations.
/// @param layer  reflection, transmission, rows, `multiple` and `direct`; as X, not symmetric
/// Arguments as of solve_coupled_half_space.
void solve_coupled_layer(double scaled_optical_depth, const StokesTables& tables,
                         const StokesBlock& block, const MatrixStrengths& strengths,
                         const FourierMode& mode, const FourierMedium& medium,
                         const ZenithGrid& nodes, const RequestedDirections& cosines,
                         const RequestedDirections& requested, double tolerance, CoupledWork& work,
                         LayerOperator& layer);

/// Works as put_on does, for reflectors and layers that are not symmetric, without sky and
/// transmittance.
void put_on_coupled(const LayerOperator& layer, const Reflector& base,
                    const RequestedDirections& requested, int rows_per_node, ReflectorParts parts,
                    Reflector& result);

// Total reflection and metals turn U into V.

/// Works as mirror_ground does, for a block that ends with V.
/// @param nodes, cosines  in the medium above it, once each
/// @param requested       repeated()
void coupled_mirror(double here, std::complex<double> mirror, const ZenithGrid& nodes,
                    const RequestedDirections& cosines, const RequestedDirections& requested,
                    const StokesBlock& block, Reflector& result);

/// Works as put_boundary_on does, for such blocks: nothing is symmetric, and there is no sky.
/// @param requested  repeated(), in the medium below
/// @param parts      `pairs` or `nodes`
void put_boundary_on_coupled(const FresnelReflections& matrices, const StokesBlock& block,
                             const RequestedDirections& requested, ReflectorParts parts,
                             const Reflector& below, Reflector& result);

}  // namespace miebrdf::rte
