// A stack of media as polarised light sees it: the Mueller matrix in one Fourier order after the
// other, by the solvers of half-spaces and layers that the scalar equations use, and their sum.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "rte/fourier/eigenmodes.h"
#include "rte/layer/layer.h"
#include "rte/stack/fourier_sum.h"
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

/// Element (row, column) of R at an azimuth is the sum over m of (m = 0 ? 1 : 2) times that of R^m
/// (StokesOrder::multiple) times `sign` and cos(m azimuth), or sin(m azimuth) where `is_sine`.
struct StokesHarmonic {
    bool is_sine = false;
    double sign = 1.0;
};
StokesHarmonic stokes_harmonic(int row, int column);

/// R^0 + 2 sum over m of R^m without the first order of scattering: its diagonal blocks (I, Q) and
/// (U, V) times cos(m azimuth), the lower left one times sin(m azimuth), the upper right one times
/// -sin(m azimuth). Ends, and takes over orders of a coarser solution, as sum_fourier_orders does.
/// With vertical rays orders above 2 vanish.
struct StokesScattering {
    /// [((i * outs + o) * c^2 + row * c + column) * azimuths + a]
    std::vector<double> reflection;
    std::vector<double> plane_albedo, polarised_plane_albedo;  ///< at the incident cosines
    int fourier_orders = 0;
    int iterations = 0;
    double residual = 0.0;
    double tail = 0.0;  ///< as of MultipleScattering
    bool converged = true;
    bool physical = true;
    FourierOrders by_fourier_order;  ///< StokesOrder::multiple; as of MultipleScattering
};

/// Which orders the sum keeps in by_fourier_order.
enum class KeptOrders {
    for_finer,  ///< those that a finer solution may take over, probes included
    asked_for,  ///< all of them, at the directions asked for: what a table is made of
};

StokesScattering sum_stokes_orders(const ScaledStack& stack, const StackGrids& grids,
                                   const RequestedDirections& requested,
                                   std::span<const double> azimuth_deg, int components,
                                   double tail_tolerance, const SolverOptions& options,
                                   StokesMemory& memory, const FourierOrders& coarser,
                                   KeptOrders kept = KeptOrders::for_finer);

}  // namespace miebrdf::rte
