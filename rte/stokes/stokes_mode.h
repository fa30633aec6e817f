// One Fourier order of polarised light in the form of FourierMode: rows are components of Stokes
// vectors at nodes or cosines, so that the solvers of the scalar equations solve these as well.
#pragma once

#include <span>
#include <vector>

#include "rte/fourier/fourier_mode.h"
#include "rte/phase/matrix_strengths.h"

namespace miebrdf::rte {

enum class StokesComponent { I, Q, U, V };

/// Components that one Fourier order couples; their number is the rows of a node.
using StokesBlock = std::vector<StokesComponent>;

/// (I, Q) and (U) in order 0, all three in the others; V beside them, coupled or on its own.
std::vector<StokesBlock> stokes_blocks(int fourier_order, int components, bool has_b2);

/// Nodes or cosines, each as often as a block has components. Of two cosines beside another the
/// second follows rows_per_node places behind the first.
ZenithGrid repeated(const ZenithGrid& grid, int rows_per_node);
RequestedDirections repeated(const RequestedDirections& requested, int rows_per_node);

/// P, R and T of one Fourier order (docs/maths-polarisation.md), shared by all media on a grid.
/// Columns l = m ... L - 1; R and T are 0 for l < 2.
struct StokesTable {
    Eigen::MatrixXd P, R, T;
};
struct StokesTables {
    int fourier_order = 0;
    StokesTable nodes, requested;
    /// Rows of I and Q are those of light polarised parallel to the meridian plane and across it,
    /// (I + Q, I - Q) / 2^(1/2): the axes in which Fresnel's matrices are diagonal.
    bool along_axes = false;
    FourierMode scalar;         ///< P
    LegendreSampling sampling;  ///< used again by the next order
};
void make_stokes_tables(int fourier_order, int degrees, const ZenithGrid& grid,
                        const RequestedDirections& requested, StokesTables& tables);

/// Functions of one block as a FourierMode: U is the sum over its even columns, V over its odd
/// ones, a column for each degree and axis of its block (MatrixStrengths). Columns of strength 0
/// fill up the shorter list.
///
/// In a block with both U and V the columns are the axes of [[a3, -b2], [-b2, -a4]]: sums are then
/// over strength y y^T J, J = -1 in the rows of V (coupled.h).
/// @param grid, requested  repeated()
/// @param medium  degrees that it has no strengths for scatter nothing
/// @param fourier_medium  strengths and degrees of the columns; one_minus_albedo is left alone
void make_block_mode(const StokesTables& tables, const StokesBlock& block,
                     const MatrixStrengths& medium, const ZenithGrid& grid,
                     const RequestedDirections& requested, FourierMode& mode,
                     FourierMedium& fourier_medium);

/// A change of the strengths of a mode's columns: of each, and of the pairs that a column and the
/// next of its parity make, where polarised light turns their axes (empty: nowhere).
struct StrengthChange {
    Eigen::VectorXd own, beside = {};

    bool is_zero() const {
        return (own.size() == 0 || own.cwiseAbs().maxCoeff() == 0.0) &&
               (beside.size() == 0 || beside.cwiseAbs().maxCoeff() == 0.0);
    }
};

/// plus - minus in the columns that make_block_mode gives `middle`.
/// @param degrees  L
StrengthChange block_change(int fourier_order, int degrees, const StokesBlock& block,
                            const MatrixStrengths& middle, const MatrixStrengths& plus,
                            const MatrixStrengths& minus);

}  // namespace miebrdf::rte
