// One azimuthal order: the tables that every medium, wavelength and layer on a grid shares.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "rte/grid/zenith_grid.h"
#include "rte/math/scratch.h"

namespace miebrdf::rte {

/// The cosines a caller asked for, each once, and which of them are incident and outgoing.
struct RequestedDirections {
    Eigen::VectorXd mu;
    std::vector<int> out;  ///< indices into mu
    std::vector<int> in;
    /// The last so many of both lists were not asked for: two solutions are compared there.
    std::size_t probes = 0;

    std::size_t asked_out() const { return out.size() - probes; }
    std::size_t asked_in() const { return in.size() - probes; }
};

/// Legendre functions Y_l^m of one order m, columns l = m ... L - 1, rows = directions.
/// Columns alternate in parity: (-1)^(l-m) = +1 for column 0, 2, ...
struct PhaseMode {
    int order = 0;
    math::ScratchMatrix at_nodes;      ///< n x (L - m)
    math::ScratchMatrix scaled_nodes;  ///< sqrt(w / mu) Y: the form in which they enter equations
    math::ScratchMatrix at_requested;  ///< number of requested cosines x (L - m)
    math::ScratchMatrix at_out;        ///< the rows of at_requested of outgoing cosines
    math::ScratchMatrix at_in;         ///< and of incident ones
};

/// Rows of a table: result(k, .) = table(which[k], .).
void gather_rows(const Eigen::Ref<const Eigen::MatrixXd>& table, const std::vector<int>& which,
                 math::ScratchMatrix& result);

/// Tables for order m.
///
/// For m = 0 the functions are made orthogonal to Y_0 (even l) and Y_1 (odd l) under the grid's own
/// quadrature, at the nodes and by the same combination everywhere else. On a rule that integrates
/// products of two kept degrees exactly this changes nothing; on any other it restores conservation
/// of energy and of the diffusive flux, which half-range quadrature otherwise loses.
void make_phase_mode(int order, int degrees, const ZenithGrid& grid,
                     const RequestedDirections& requested, PhaseMode& mode);

using ColumnsOfOneParity = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ElementsOfOneParity = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<2>>;

/// Columns l - m = 0, 2, ... and 1, 3, ... of a table, without copying.
ColumnsOfOneParity even_columns(const Eigen::Ref<const Eigen::MatrixXd>& table);
ColumnsOfOneParity odd_columns(const Eigen::Ref<const Eigen::MatrixXd>& table);

/// Elements 0, 2, ... and 1, 3, ... of the strengths that belong to the columns, without copying.
ElementsOfOneParity even_part(const Eigen::Ref<const Eigen::VectorXd>& strengths);
ElementsOfOneParity odd_part(const Eigen::Ref<const Eigen::VectorXd>& strengths);

/// The strengths with the sign (-1)^(l-m) of their column.
math::ScratchVector alternating(const Eigen::Ref<const Eigen::VectorXd>& strengths);
void alternating(const Eigen::Ref<const Eigen::VectorXd>& strengths, math::ScratchVector& result);

}  // namespace miebrdf::rte
