// One Fourier order in azimuth: the Legendre tables that every medium, wavelength and layer on a
// grid shares, what a medium scatters in that order, and sums over degrees.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <vector>

#include "rte/grid/directions.h"
#include "rte/math/matrices.h"

namespace miebrdf::rte {

/// Legendre functions Y_l^m of one Fourier order m, columns l = m ... L - 1, rows = directions.
/// Columns alternate in parity: (-1)^(l-m) = +1 for column 0, 2, ...
///
/// For polarised light (rte/stokes) rows are components of Stokes vectors, several for each node,
/// and columns are its generalised spherical functions, sorted so that they alternate as well: all
/// that the solvers know of a column is its parity and its strength.
struct FourierMode {
    int fourier_order = 0;         ///< m
    Eigen::MatrixXd at_nodes;      ///< n x (L - m), as the nodes see them (NodeProjection)
    Eigen::MatrixXd scaled_nodes;  ///< sqrt(w / mu) Y: the form in which they enter equations
    Eigen::MatrixXd at_requested;  ///< number of requested cosines x (L - m)
    Eigen::VectorXd node_factors;  ///< sqrt(w / mu); in between other factors
    int rows_per_node = 1;
    /// Unpolarised light of intensity 1 in the rows of a node; all 0: they carry no energy.
    std::array<double, 4> unpolarised = {1.0, 0.0, 0.0, 0.0};

    bool has_intensity() const { return unpolarised[0] != 0.0; }
    /// Intensities, one in every row of its node, become unpolarised light.
    void keep_intensity(Eigen::Ref<Eigen::VectorXd> rows) const {
        for (Eigen::Index r = 0; r < rows.size(); ++r)
            rows[r] *= unpolarised[std::size_t(r % rows_per_node)];
    }
};

/// Functions of mu at finer nodes than those of a grid, and how these see them.
struct LegendreSampling {
    NodeProjections projections = {};  ///< of the grids and degrees so far
    Eigen::MatrixXd samples;           ///< at the fine nodes
};

/// Rows of a table: result(k, .) = table(which[k], .).
void gather_rows(const Eigen::Ref<const Eigen::MatrixXd>& table, const std::vector<int>& which,
                 Eigen::MatrixXd& result);

/// Tables for one Fourier order m: Y at the requested cosines, and its projection at the nodes,
/// with which light at the nodes is scattered as if the integrals over the polynomial through it
/// were exact for every degree. So many more than 2n moments may be kept, and U and V
/// (eigenmodes.h) stay positive definite: a projection makes no eigenvalue of scattering larger.
///
/// For m = 0 the functions are made orthogonal to Y_0 (even l) and Y_1 (odd l) under the grid's own
/// quadrature, at the nodes and by the same combination everywhere else. On a rule that integrates
/// products of two kept degrees exactly this changes nothing; on any other it restores conservation
/// of energy and of the diffusive flux, which half-range quadrature otherwise loses. Y_0 and Y_1
/// are normalised for the same reason.
/// @param sampling  used again by the next order
void make_fourier_mode(int fourier_order, int degrees, const ZenithGrid& grid,
                       const RequestedDirections& requested, LegendreSampling& sampling,
                       FourierMode& mode);

/// These tables for one medium after the other: as long as nodes, cosines and the number of degrees
/// stay, each order is found once.
class FourierModes {
  public:
    /// @param keep  false: the caller keeps what it needs of a table that is not known yet
    /// @return valid until the next call
    const FourierMode& find(int fourier_order, int degrees, const ZenithGrid& grid,
                            const RequestedDirections& requested, bool keep = true);

  private:
    struct Known {
        FourierMode mode = {};
        bool is_filled = false;
    };

    bool are_of(int degrees, const ZenithGrid& grid, const RequestedDirections& requested) const;

    int degrees_ = 0;
    ZenithGrid grid_;
    Eigen::VectorXd requested_;
    std::deque<Known> known_;  ///< by order
    Known passing_;            ///< of orders that are too many to be kept
    LegendreSampling sampling_;
};

using ColumnsOfOneParity = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ElementsOfOneParity = Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<2>>;

/// Columns l - m = 0, 2, ... and 1, 3, ... of a table, without copying.
ColumnsOfOneParity even_columns(const Eigen::Ref<const Eigen::MatrixXd>& table);
ColumnsOfOneParity odd_columns(const Eigen::Ref<const Eigen::MatrixXd>& table);

/// Elements 0, 2, ... and 1, 3, ... of the strengths that belong to the columns, without copying.
ElementsOfOneParity even_part(const Eigen::Ref<const Eigen::VectorXd>& strengths);
ElementsOfOneParity odd_part(const Eigen::Ref<const Eigen::VectorXd>& strengths);

/// The strengths with the sign (-1)^(l-m) of their column.
Eigen::VectorXd alternating(const Eigen::Ref<const Eigen::VectorXd>& strengths);
void alternating(const Eigen::Ref<const Eigen::VectorXd>& strengths, Eigen::VectorXd& result);

/// A medium in one Fourier order, as the solvers see it.
struct FourierMedium {
    Eigen::VectorXd strengths;      ///< alpha (2l+1) chi_l, l = m ... L - 1
    double one_minus_albedo = 1.0;  ///< carried separately, with all its digits
    int lowest_degree = 0;          ///< m
    std::vector<int> degrees = {};  ///< of the columns; empty: m, m + 1, ...
    /// FourierWork::brightness of order 0, where it is known: orders above it are solved to a share
    /// of that. 0: of their own largest value.
    double brightness = 0.0;

    /// Largest alpha |chi_l|, l >= m: bounds what part of a field one scattering returns, and how
    /// far the equations are from those without scattering.
    double strongest() const {
        double largest = 0.0;
        for (Eigen::Index c = 0; c < strengths.size(); ++c) {
            const double degree =
                degrees.empty() ? double(lowest_degree + c) : degrees[std::size_t(c)];
            largest = std::max(largest, std::abs(strengths[c]) / (2.0 * degree + 1.0));
        }
        return largest;
    }
};

/// Sums of sum_l s_l phi_l(mu_out) phi_l(mu_in) with phi = first + extra, without first * first:
/// that is the first order of scattering, which is known in closed form and would cancel digits.
class PairProducts {
  public:
    /// @param strengths  s_l
    /// @param extra      at all requested cosines
    /// @param first_out  at the outgoing ones; first_in at the incident ones
    /// @param sum        out x in, added to
    void add(const Eigen::Ref<const Eigen::VectorXd>& strengths,
             const Eigen::Ref<const Eigen::MatrixXd>& extra,
             const Eigen::Ref<const Eigen::MatrixXd>& first_out,
             const Eigen::Ref<const Eigen::MatrixXd>& first_in,
             const RequestedDirections& requested, Eigen::MatrixXd& sum);

    /// Subtracts the same with `direct` * first in place of first: of light that has been weakened
    /// on its way, by one factor for each requested cosine.
    void subtract_below(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                        const Eigen::Ref<const Eigen::MatrixXd>& extra,
                        const Eigen::Ref<const Eigen::VectorXd>& direct,
                        const Eigen::Ref<const Eigen::MatrixXd>& first_out,
                        const Eigen::Ref<const Eigen::MatrixXd>& first_in,
                        const RequestedDirections& requested, Eigen::MatrixXd& sum);

  private:
    /// Fills extra_out_, extra_in_ and weighted_ = s_l extra_in_.
    void gather(const Eigen::Ref<const Eigen::VectorXd>& strengths,
                const Eigen::Ref<const Eigen::MatrixXd>& extra,
                const RequestedDirections& requested);

    Eigen::MatrixXd extra_out_, extra_in_, weighted_, product_;
};

/// Divides by 4 (mu_out + mu_in).
void divide_by_cosines(const RequestedDirections& requested, Eigen::MatrixXd& reflection);

}  // namespace miebrdf::rte
