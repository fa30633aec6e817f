// The half-space whose b2 couples V to U.
#pragma once

#include <Eigen/Core>

#include "rte/half_space/half_space.h"
#include "rte/stokes/coupled_modes.h"

namespace miebrdf::rte {

/// Memory of the coupled solvers.
struct CoupledWork {
    CoupledModes modes;
    FourierWork fourier;  ///< of the pairs
};

/// What scatters into the requested cosines out of s and a in the coordinates of CoupledModes: E
/// F^-T and O F Z^ (phase_rows, Z^ = F^-1 Z F^-T), requested x eigenmodes.
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

/// Which rows of a block are V: its last component. J, as signs of rows.
Eigen::VectorXd metric(Eigen::Index rows, int rows_per_node);

/// X = 2 (I + Z)^-1 - I, rows as in Reflector: node by node, V last.
/// @return false if there is no physical solution
bool reflection_of(const Eigen::MatrixXd& Z_linear, const Eigen::MatrixXd& Z_mixed,
                   const Eigen::MatrixXd& Z_circular, int rows_per_node, Eigen::MatrixXd& X);

/// As solve_half_space, for a block that ends with V and a medium with b2.
/// @param mode, medium  of the whole block (make_block_mode)
/// @param grid, requested  repeated(); `nodes`, `cosines` are the same once each
/// @param result  `nodes` and `rows` are X, which is not symmetric; `multiple` is X as well
void solve_coupled_half_space(const StokesTables& tables, const StokesBlock& block,
                              const MatrixStrengths& strengths, const FourierMode& mode,
                              const FourierMedium& medium, const ZenithGrid& nodes,
                              const RequestedDirections& cosines, const ZenithGrid& grid,
                              const RequestedDirections& requested, double tolerance,
                              CoupledWork& work, Reflector& result);

}  // namespace miebrdf::rte
