// StackSolver: the reflection of a stack of media, one Fourier order after the other, by light with
// 1, 3 or 4 Stokes components; and the memory that it uses.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/boundary/smooth_boundary.h"
#include "rte/first_order/first_order.h"
#include "rte/fourier/eigenmodes.h"
#include "rte/layer/layer.h"
#include "rte/stack/kept_layers.h"
#include "rte/stack/scaled_stack.h"
#include "rte/stokes/coupled.h"
#include "rte/stokes/stokes_mode.h"

namespace miebrdf::rte {

class RoughTop;

/// A boundary, and the cosines in the medium below for which it was made.
struct KnownBoundary {
    SmoothBoundary boundary;
    Eigen::VectorXd nodes, requested;
};

/// One Fourier order of the reflection between requested cosines, by light with c components.
struct StackOrder {
    /// R^m of light scattered more than once, row = out * c + component, column = in * c +
    /// component. The blocks (I, Q) x (I, Q) and (U, V) x (U, V) are the factors of cos(m azimuth),
    /// the block (U, V) x (I, Q) of sin(m azimuth), the block (I, Q) x (U, V) of -sin(m azimuth).
    Eigen::MatrixXd multiple;
    // Albedos and transmittance are set in order 0 alone.
    /// At the incident cosines, mirrors included: the plane albedo for unpolarised light, and its
    /// change for light fully polarised parallel to the plane of incidence.
    std::vector<double> plane_albedo, polarised_plane_albedo;
    double spherical_albedo = 0.0;  ///< of uniform unpolarised light
    /// Where ScaledStack::transmits: the net flux into the ground, for light from each incident
    /// cosine, then for uniform light.
    std::vector<double> transmittance;
    int iterations = 0;
    double residual = 0.0;
    bool converged = true;
    bool physical = true;

    void clear();
};

/// The matrices and tables of StackSolver, used again for the next Fourier order and the next
/// stack: about 25 matrices of c n rows for n nodes and c components (1.8 MB for n = 32, c = 3).
/// That saves 15 % of the time at 16 nodes and 14 % at 32 (31 coated half-spaces, 100 pairs of
/// directions) and changes no bit of the results. Not thread-safe.
struct StackMemory {
    // Tables of the present order for 1 component and for more, by refractive index.
    std::vector<FourierModes> tables = {};
    std::vector<const FourierMode*> modes = {};
    std::vector<StokesTables> stokes_tables = {};
    FourierMode stokes_mode = {};  ///< of the present block and medium
    FourierMedium medium = {};     ///< of the present step (set_medium)
    FourierWork work = {};
    CoupledWork coupled = {};
    LayerOperator layer = {};
    GroundOrders ground = {};
    /// Two for each refractive index (sizes differ from index to index): one holds the layers
    /// solved so far, the other receives the next step.
    std::vector<std::array<Reflector, 2>> reflectors = {};
    std::vector<RequestedDirections> requested = {};  ///< by refractive index
    std::vector<KnownBoundary> boundaries = {};
    std::vector<double> brightness = {};  ///< of half-spaces in order 0, by medium
    /// At the rows of the nodes in air: radiance of the sky, weights of the light that enters, and
    /// a uniform sky.
    Eigen::VectorXd sky = {}, let_in = {}, uniform = {};
    StackOrder order = {};
};

/// One step of StackSolver, with its result; pointers are valid during the call.
struct StackStep {
    /// `mirrors`: all layers below a rough boundary, in an order in which nothing is scattered;
    /// `whole`: the end of the block.
    enum class Kind { half_space, ground, mirrors, layer, boundary, rough_top, whole };
    Kind kind;
    const Reflector* result;
    const Reflector* below = nullptr;           ///< the layers before this step
    std::size_t medium = 0;                     ///< of a half-space or layer
    const FourierMode* mode = nullptr;          ///< of a half-space, layer or ground
    const FourierMedium* scattering = nullptr;  ///< of a half-space or layer
    const ZenithGrid* grid = nullptr;           ///< rows of the nodes in the medium
    /// Rows of the requested cosines in the medium; of a boundary in the medium below.
    const RequestedDirections* requested = nullptr;
    const LayerOperator* layer = nullptr;
    const SmoothBoundary* boundary = nullptr;
    const RoughTop* rough = nullptr;
    EigenmodeSolver* eigenmodes = nullptr;  ///< of a half-space or layer
    bool has_eigenmodes = true;             ///< false: a half-space solved without them
};

/// Is called after each step, from the bottom up.
class StackFollower {
  public:
    /// Half-spaces, layers and boundaries of blocks that couple V (unsymmetric equations) are left
    /// out.
    virtual void follow(const StackStep& step) = 0;

  protected:
    ~StackFollower() = default;
};

/// Solves the base and puts coats and boundaries on it. A Fourier order of Stokes vectors falls
/// into blocks of components that do not mix (stokes_blocks). A block of c components has c rows
/// for each node; unpolarised light is one block with c = 1. Not thread-safe.
class StackSolver {
  public:
    /// The arguments must outlive this.
    /// @param stack       with 3 or 4 components its boundaries are smooth
    /// @param requested   in air
    /// @param components  1: unpolarised light; 3: (I, Q, U); 4: (I, Q, U, V)
    StackSolver(const ScaledStack& stack, const StackGrids& grids,
                const RequestedDirections& requested, int components, const SolverOptions& options,
                StackMemory& memory);
    ~StackSolver();

    /// The number of Fourier orders: one for each moment, and more where a rough boundary lies over
    /// mirrors, because light that returns unscattered has a longer series.
    int fourier_orders() const;
    /// Whether orders of light that returns unscattered through a rough boundary are among them.
    bool has_boundary_orders() const { return unscattered_.size() > 0; }

    /// Solves the whole stack with its boundary; in order 0 with albedos.
    /// @return valid until the next call
    const StackOrder& solve(int fourier_order);
    /// Solves order 0 of I (and Q), which is enough for albedos. `let_in` and `let_out` weigh light
    /// that enters and leaves: the plane albedo counts flux by `let_out`, the spherical albedo is
    /// that of light weighted by `let_in`.
    /// @param let_in, let_out  at the nodes of StackGrids::top, times flux_weights
    const StackOrder& solve_albedos(const Eigen::VectorXd& let_in, const Eigen::VectorXd& let_out);

    void let_follow(StackFollower& follower) { follower_ = &follower; }
    /// Writes R^m of the present block into StackOrder::multiple of all components.
    void spread_block(const Eigen::MatrixXd& solved, Eigen::MatrixXd& all) const;
    const StokesBlock& block() const { return *block_; }

  private:
    /// Nodes and requested cosines of a medium, each repeated c times; indexed by c.
    struct Rows {
        std::array<ZenithGrid, 5> grids;
        std::array<RequestedDirections, 5> requested;
    };

    void set_up_stokes();
    /// Sets below_top_, where there are such layers and their methods are automatic.
    void name_layers_below_top();
    void start(int fourier_order);
    /// @param let_in, let_out  null: weights of 1
    void solve_block(const StokesBlock& block, const Eigen::VectorXd* let_in = nullptr,
                     const Eigen::VectorXd* let_out = nullptr);
    void find_skies(const Eigen::VectorXd* let_in, const Eigen::VectorXd* let_out);
    void spread_over_rows(const Eigen::VectorXd& at_nodes, Eigen::VectorXd& rows) const;
    /// The topmost coat that hides the layers below in this order and is solved as a half-space.
    std::optional<std::size_t> find_hiding_coat();
    /// Solves the base, or that coat.
    /// @return the place of the next coat in ScaledStack::media
    std::size_t solve_lowest(std::optional<std::size_t> hiding);
    KeptLayers::Place place_of_block(std::optional<std::size_t> hiding) const;
    /// All layers without the topmost one, as they were solved for another stack; false: they were
    /// not.
    bool take_kept_layers(std::optional<std::size_t> hiding);
    /// Sets the reflection of all layers below a rough boundary in an order in which none scatters.
    /// @return the number of media: no coat is left
    std::size_t solve_mirrors();
    void solve_base();
    /// @pre set_medium(medium)
    void solve_as_half_space(HalfSpaceMethod method, std::size_t medium);
    void solve_ground();
    void find_ground_emission(const FourierMode& mode, const ZenithGrid& grid,
                              const RequestedDirections& requested, Reflector& ground) const;
    void put_on_coat(std::size_t medium, ReflectorParts parts);
    void put_on_boundary(double below, double above, ReflectorParts parts);
    /// Puts on the boundary to air.
    void put_on_top(ReflectorParts parts);
    const SmoothBoundary& boundary_between(double below, double above);
    Eigen::VectorXd mirror_at(double index, const Eigen::VectorXd& mu) const;
    /// Sets memory_.medium.
    void set_medium(std::size_t medium);
    void keep_pairs();
    void tell(StackStep step) const;
    void keep_albedos();
    /// False where transmittance is wanted, or where a method of the paper treats every layer.
    bool may_leave_out_layers() const;
    bool has_automatic_methods() const;
    /// Whether the present block couples V to U (by total reflection, metals or b2), which makes
    /// its equations unsymmetric.
    bool is_coupled() const;

    Reflector& free_reflector(double index);
    std::size_t place_of(double index) const;
    const FourierMode& mode_of(double index) const;
    const StokesTables& stokes_tables_of(double index) const {
        return memory_.stokes_tables[place_of(index)];
    }
    /// Nodes and requested cosines in a medium: grid_of and requested_in have one for each row of
    /// the block, nodes_of and cosines_in have each once.
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
    /// There are boundaries or mirrors. The first two rows of Stokes vectors are then light
    /// polarised parallel and perpendicular to the meridian plane, in place of I and Q.
    const bool has_fresnel_;
    bool couples_V_ = false;                  ///< by b2, boundaries or mirrors
    std::vector<MatrixStrengths> strengths_;  ///< of the media, for Stokes vectors
    std::vector<Rows> rows_;                  ///< by index, for Stokes vectors
    std::string below_top_;  ///< KeptLayers' name of all but the topmost medium; empty: none
    std::unique_ptr<RoughTop> rough_top_;
    /// Share of light that returns to a node below a rough boundary unscattered from mirrors.
    Eigen::VectorXd unscattered_;
    StackMemory& memory_;
    int fourier_order_ = 0;
    const StokesBlock* block_ = nullptr;  ///< the present one
    Reflector* reflector_ = nullptr;      ///< of the layers solved so far in this order
    StackFollower* follower_ = nullptr;
};

}  // namespace miebrdf::rte
