// A stack of media in one Fourier order after the other, for light as numbers or as Stokes vectors,
// and the memory that takes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/boundary/smooth_boundary.h"
#include "rte/first_order/first_order.h"
#include "rte/fourier/eigenmodes.h"
#include "rte/layer/layer.h"
#include "rte/stack/scaled_stack.h"
#include "rte/stokes/coupled.h"
#include "rte/stokes/stokes_mode.h"

namespace miebrdf::rte {

class RoughTop;

/// A boundary at the cosines where it was last needed.
struct KnownBoundary {
    SmoothBoundary boundary;
    Eigen::VectorXd nodes, requested;  ///< of the medium below
};

/// One Fourier order of the reflection between requested cosines, by light with c components.
struct StackOrder {
    /// R^m of light scattered more than once, row = out * c + component, column = in * c +
    /// component. Of the four blocks (I, Q) and (U, V) those on the diagonal belong to cos(m
    /// azimuth), the lower left one to sin(m azimuth), the upper right one to -sin(m azimuth).
    Eigen::MatrixXd multiple;
    /// The rest is of order 0. At the incident cosines: the reflected share of the flux of
    /// unpolarised light, mirrors included, and what it changes by if the light is fully polarised
    /// parallel to the plane of incidence.
    std::vector<double> plane_albedo, polarised_plane_albedo;
    double spherical_albedo = 0.0;  ///< of uniform unpolarised light
    /// ScaledStack::transmits adds the net flux into the ground, at the incident cosines and then
    /// of uniform light.
    std::vector<double> transmittance;
    int iterations = 0;
    double residual = 0.0;
    bool converged = true;
    bool physical = true;

    void clear();
};

/// All matrices and tables that a stack takes, for one Fourier order, one number of nodes and one
/// stack after the other. Wavelengths solved in the same memory save 15 % of the time at 16 nodes
/// and 14 % at 32: tables, and pages that every new memory takes from the system (31 coated
/// half-spaces, 100 pairs of directions). Results are the same to the last bit. At n nodes and c
/// components about 25 matrices of c n rows: 1.8 MB for n = 32, c = 3. Not thread-safe.
struct StackMemory {
    // Tables of numbers and of Stokes vectors, by index; of the order that is being solved.
    std::vector<FourierModes> tables = {};
    std::vector<const FourierMode*> modes = {};
    std::vector<StokesTables> stokes_tables = {};
    FourierMode stokes_mode = {};  ///< of the block and medium that are being solved
    FourierMedium medium = {};     ///< that is being solved
    FourierWork work = {};
    CoupledWork coupled = {};
    LayerOperator layer = {};
    GroundOrders ground = {};
    /// Two in each medium, by index: what has been solved so far, and what comes next. Sizes differ
    /// from index to index.
    std::vector<std::array<Reflector, 2>> reflectors = {};
    std::vector<RequestedDirections> requested = {};  ///< by index
    std::vector<KnownBoundary> boundaries = {};
    std::vector<double> brightness = {};  ///< of order 0, of media solved as half-spaces
    /// Row by row at the nodes in air: downward radiance of the sky, weights of what enters, and
    /// uniform light.
    Eigen::VectorXd sky = {}, let_in = {}, uniform = {};
    StackOrder order = {};
};

/// What StackSolver has just solved; all of it is valid during the call.
struct StackStep {
    /// `mirrors`: of an order in which nothing is scattered; `whole`: the block is complete.
    enum class Kind { half_space, ground, mirrors, layer, boundary, rough_top, whole };
    Kind kind;
    const Reflector* result;
    const Reflector* below = nullptr;           ///< what it was put on
    std::size_t medium = 0;                     ///< of a half-space or layer
    const FourierMode* mode = nullptr;          ///< of these and the ground
    const FourierMedium* scattering = nullptr;  ///< of a half-space or layer
    const ZenithGrid* grid = nullptr;           ///< by rows, of the medium
    const RequestedDirections* requested =
        nullptr;  ///< likewise; of boundaries in the medium below
    const LayerOperator* layer = nullptr;
    const SmoothBoundary* boundary = nullptr;
    const RoughTop* rough = nullptr;
    EigenmodeSolver* eigenmodes = nullptr;  ///< of a half-space or layer
    bool has_eigenmodes = true;             ///< false: they have not been found
};

/// Sees the steps from the bottom up.
class StackFollower {
  public:
    virtual void follow(const StackStep& step) = 0;

  protected:
    ~StackFollower() = default;
};

/// Solves the base and puts the coats and boundaries on it. Light as a number is the block
/// of one row; of Stokes vectors a Fourier order falls into blocks of components that do not mix
/// (stokes_blocks), and the same solvers take rows of these. Not thread-safe.
class StackSolver {
  public:
    /// The arguments must outlive this.
    /// @param stack       with 3 or 4 components its boundaries are smooth
    /// @param requested   in air
    /// @param components  1: light as a number; 3: (I, Q, U); 4: with V
    StackSolver(const ScaledStack& stack, const StackGrids& grids,
                const RequestedDirections& requested, int components, const SolverOptions& options,
                StackMemory& memory);
    ~StackSolver();

    /// That there are: one for each moment, and more where a rough boundary lies over mirrors,
    /// which have an azimuthal series of their own.
    int fourier_orders() const;
    /// A rough boundary's own orders, of light that comes back unscattered, are among them.
    bool has_boundary_orders() const { return unscattered_.size() > 0; }

    /// The whole stack, boundary included; in order 0 with its albedos.
    /// @return valid until the next call
    const StackOrder& solve(int fourier_order);
    /// Order 0 of I (and Q) alone: all that albedos need. `plane_albedo` is the flux under the
    /// weights `let_out`, `spherical_albedo` is of light that enters by `let_in`.
    /// @param let_in, let_out  at the nodes of StackGrids::top, times flux_weights
    const StackOrder& solve_albedos(const Eigen::VectorXd& let_in, const Eigen::VectorXd& let_out);

    /// Light as a number, or blocks that do not couple V: all is symmetric, and steps can be seen.
    void let_follow(StackFollower& follower) { follower_ = &follower; }
    /// StackOrder::multiple from that of the block which is being solved.
    void spread_block(const Eigen::MatrixXd& solved, Eigen::MatrixXd& all) const;
    const StokesBlock& block() const { return *block_; }

  private:
    /// Nodes and requested cosines of a medium, by the rows of a node.
    struct Rows {
        std::array<ZenithGrid, 5> grids;
        std::array<RequestedDirections, 5> requested;
    };

    void start(int fourier_order);
    /// @param let_in, let_out  null: all of it is let in and out
    void solve_block(const StokesBlock& block, const Eigen::VectorXd* let_in = nullptr,
                     const Eigen::VectorXd* let_out = nullptr);
    void find_skies(const Eigen::VectorXd* let_in, const Eigen::VectorXd* let_out);
    void spread_over_rows(const Eigen::VectorXd& at_nodes, Eigen::VectorXd& rows) const;
    /// Solves what lies below the first coat to be put on, whose index is returned: the base, or a
    /// coat so deep for this order that it is a half-space itself.
    std::size_t solve_lowest();
    /// All of what lies below a rough boundary, where nothing is scattered.
    std::size_t solve_mirrors();
    void solve_base();
    /// After set_medium.
    void solve_as_half_space(HalfSpaceMethod method, std::size_t medium);
    void solve_ground();
    void find_ground_emission(const FourierMode& mode, const ZenithGrid& grid,
                              const RequestedDirections& requested, Reflector& ground) const;
    void put_on_coat(std::size_t medium, ReflectorParts parts);
    void put_on_boundary(double below, double above, ReflectorParts parts);
    /// The boundary to air.
    void put_on_top(ReflectorParts parts);
    const SmoothBoundary& boundary_between(double below, double above);
    Eigen::VectorXd mirror_at(double index, const Eigen::VectorXd& mu) const;
    /// Degrees that a medium has no moments for scatter nothing.
    void set_medium(std::size_t medium);
    void keep_pairs();
    void tell(StackStep step) const;
    void keep_albedos();
    /// Every method is the default: the paper's treat each coat and base as it is.
    bool may_leave_out_layers() const;
    /// Total reflection, metals or b2 make the equations of the block unsymmetric.
    bool is_coupled() const;

    Reflector& free_reflector(double index);
    std::size_t place_of(double index) const;
    const FourierMode& mode_of(double index) const;
    const StokesTables& stokes_tables_of(double index) const {
        return memory_.stokes_tables[place_of(index)];
    }
    /// Nodes and requested cosines, each as often as the block has rows, or once.
    const ZenithGrid& grid_of(double index) const;
    const ZenithGrid& nodes_of(double index) const { return grids_.of(index); }
    const RequestedDirections& requested_in(double index) const;
    const RequestedDirections& cosines_in(double index) const {
        return memory_.requested[place_of(index)];
    }

    const ScaledStack& stack_;
    const StackGrids& grids_;
    const RequestedDirections& asked_;
    const SolverOptions& options_;
    const int components_;
    double tolerance_;  ///< of the equations of one order
    /// Boundaries or mirrors: rows of Stokes vectors along the axes of the meridian planes.
    const bool has_fresnel_;
    bool couples_V_ = false;                  ///< b2, or boundaries and mirrors
    std::vector<MatrixStrengths> strengths_;  ///< of the media, for Stokes vectors
    std::vector<Rows> rows_;                  ///< by index, for Stokes vectors
    std::unique_ptr<RoughTop> rough_top_;
    Eigen::VectorXd unscattered_;  ///< of the nodes below a rough boundary over mirrors
    StackMemory& memory_;
    int fourier_order_ = 0;
    const StokesBlock* block_ = nullptr;  ///< that is being solved
    Reflector* reflector_ = nullptr;      ///< of all that has been solved so far in this order
    StackFollower* follower_ = nullptr;
};

}  // namespace miebrdf::rte
