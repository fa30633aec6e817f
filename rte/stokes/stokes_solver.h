// A stack of media as polarised light sees it: the Mueller matrix in one Fourier order after the
// other, by the solvers of half-spaces and layers that the scalar equations use.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "rte/fourier/eigenmodes.h"
#include "rte/layer/layer.h"
#include "rte/stack/stack_solver.h"
#include "rte/stokes/coupled.h"
#include "rte/stokes/stokes_mode.h"

namespace miebrdf::rte {

/// All matrices that it takes, for one block, order, number of nodes and stack after the other. At
/// n nodes and c components about 25 matrices of c n rows: 1.8 MB for n = 32, c = 3. Not
/// thread-safe.
struct StokesMemory {
    std::vector<StokesTables> tables = {};  ///< of the order that is being solved, by index
    FourierMode mode = {};
    FourierMedium medium = {};
    FourierWork work = {};
    LayerOperator layer = {};
    Reflector reflector = {}, below = {};
    CoupledWork coupled = {};
};

/// One Fourier order of the Mueller matrix of light scattered more than once.
struct StokesOrder {
    /// R^m, row = out * c + component, column = in * c + component. Of the four blocks (I, Q) and
    /// (U, V) those on the diagonal belong to cos(m azimuth), the lower left one to sin(m azimuth),
    /// the upper right one to -sin(m azimuth).
    Eigen::MatrixXd multiple;
    /// Of order 0, at the incident cosines: MuellerTable.
    std::vector<double> plane_albedo, polarised_plane_albedo;
    double spherical_albedo = 0.0;  ///< of order 0
    /// Of order 0 with ScaledStack::transmits, of unpolarised light: the flux that arrives at the
    /// ground, at the incident cosines and of uniform light, counted as often as it does.
    std::vector<double> transmittance;
    int iterations = 0;
    double residual = 0.0;
    bool converged = true;
    bool physical = true;
};

class StokesSolver {
  public:
    /// The arguments must outlive this.
    /// @param stack  boundaries are smooth
    /// @param requested  in air
    StokesSolver(const ScaledStack& stack, const StackGrids& grids,
                 const RequestedDirections& requested, int components, const SolverOptions& options,
                 StokesMemory& memory);

    /// @return valid until the next call
    const StokesOrder& solve(int fourier_order);
    /// Order 0 of I and Q alone: all that albedos need.
    const StokesOrder& solve_albedos();

  private:
    /// Nodes and requested cosines of a medium, by the rows of a node.
    struct Rows {
        std::array<ZenithGrid, 5> grids;
        std::array<RequestedDirections, 5> requested;
    };

    void start(int fourier_order);
    void solve_block(const StokesBlock& block);
    std::size_t solve_lowest(const StokesBlock& block);
    void solve_base(const StokesBlock& block);
    void solve_ground(const StokesBlock& block);
    void solve_medium_as_half_space(std::size_t index, const StokesBlock& block);
    void put_on_coat(std::size_t index, const StokesBlock& block, ReflectorParts parts);
    void put_on_boundary(double below, double above, const StokesBlock& block,
                         ReflectorParts parts);
    void set_medium(const StokesBlock& block, std::size_t index);
    void keep(const StokesBlock& block);
    void keep_albedos();
    ReflectorParts parts_of(int fourier_order, const StokesBlock& block) const;
    std::size_t place_of(double index) const;
    const StokesTables& tables_of(double index) const { return memory_.tables[place_of(index)]; }
    const ZenithGrid& grid_of(double index, std::size_t rows) const {
        return rows_[place_of(index)].grids[rows];
    }
    const RequestedDirections& requested_of(double index, std::size_t rows) const {
        return rows_[place_of(index)].requested[rows];
    }

    const ScaledStack& stack_;
    const StackGrids& grids_;
    const int components_;
    /// Boundaries or mirrors: rows along the axes of the meridian planes.
    const bool has_fresnel_;
    std::vector<MatrixStrengths> strengths_;  ///< of the media
    bool couples_V_ = false;                  ///< b2, or boundaries and mirrors
    std::vector<Rows> rows_;                  ///< by index
    double tolerance_;                        ///< of the equations of one order
    Eigen::VectorXd sky_;
    StokesMemory& memory_;
    StokesOrder order_;
};

}  // namespace miebrdf::rte
