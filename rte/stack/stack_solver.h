// A stack of media as the discrete equations see it, its reflection in one Fourier order after the
// other, and the memory that takes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/boundary/smooth_boundary.h"
#include "rte/fourier/eigenmodes.h"
#include "rte/grid/refraction_grid.h"
#include "rte/layer/layer.h"
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

struct ScaledStack {
    std::vector<ScaledMedium> media;  ///< from the bottom up; media[0] is the half-space, if any
    BaseKind base = BaseKind::half_space;
    double ground_albedo = 0.0;
    std::complex<double> mirror_index = 1.0;
    /// Of what lies on the ground or mirror, and of the topmost medium. Both as far as boundaries
    /// see them: without a boundary the topmost is 1, media have their neighbours' index.
    double ground_index = 1.0, top_index = 1.0;
    std::optional<Boundary> boundary = {};  ///< empty too where the topmost medium is as air
    int moments = 1;                        ///< Legendre moments of the medium that has most
    /// The flux into what lies below is wanted (Reflector::glow_at_requested): nothing is left out.
    bool transmits = false;
    /// Lower bound of the largest reflection at every incidence (least_brightness): below a deep
    /// coat is left out what does not show beside that. 0: nothing is.
    double brightness = 0.0;

    /// Any index but one: nodes and requested cosines differ from medium to medium.
    bool refracts() const;
    /// Beams come back from mirrors or boundaries below a medium.
    bool has_mirrors() const;
};

class RoughTop;

/// A boundary at the cosines where it was last needed.
struct KnownBoundary {
    SmoothBoundary boundary;
    Eigen::VectorXd nodes, requested;  ///< of the medium below
};

enum class NarrowPart { split, ignored };

/// delta-M for every medium; layers without depth are left out, and so is everything below a coat
/// of infinite depth.
/// @param moments  as of scale_optics
/// @param narrow   ignored: ScaledMedium::narrow is left empty, for those who want no light
///        scattered once
ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m,
                        NarrowPart narrow = NarrowPart::split);
/// @param scaled  overwritten; its memory is used again
void scale_stack(const Stack& stack, int moments, bool delta_m, NarrowPart narrow,
                 ScaledStack& scaled);

/// What lies below the layers that are left, as scale_stack finds it.
BaseKind lowest_kind(const Stack& stack);

/// Nodes of all media of a stack: one grid, or one for each index (refraction_grid.h).
class StackGrids {
  public:
    /// One for all.
    StackGrids(ZenithGrid grid);
    StackGrids(const ScaledStack& stack, GridKind kind, int count);

    /// They are what these arguments give.
    bool fit(const ScaledStack& stack, GridKind kind, int count) const;

    /// Of light that enters and leaves.
    const ZenithGrid& top() const { return grids_.front(); }
    const ZenithGrid& of(double index) const;
    /// Index 1 first, where there are several.
    const std::vector<double>& indices() const { return indices_; }
    const RefractionGrid& refraction() const { return *refraction_; }

  private:
    GridKind kind_ = GridKind::automatic;
    int count_ = 0;
    std::vector<double> scattering_;  ///< indices of the media; empty where nothing refracts
    std::vector<double> indices_;
    std::vector<ZenithGrid> grids_;
    std::optional<RefractionGrid> refraction_;
};

/// Narrow features of all degrees (ScaledMedium::narrow), and which of them these nodes resolve.
void split_by_resolution(ScaledStack& stack, const StackGrids& grids);

/// All matrices and tables that a stack takes, for one Fourier order, one number of nodes and one
/// stack after the other. Wavelengths solved in the same memory save 15 % of the time at 16 nodes
/// and 14 % at 32: tables, and pages that every new memory takes from the system (31 coated
/// half-spaces, 100 pairs of directions). Results are the same to the last bit. Not thread-safe.
struct StackMemory {
    std::vector<FourierModes> tables = {};       ///< by index
    std::vector<const FourierMode*> modes = {};  ///< of the order that is being solved, by index
    FourierMedium medium = {};                   ///< of the base or coat that is being solved
    FourierWork work = {};
    LayerOperator layer = {};
    /// Two in each medium, by index: what has been solved so far, and what comes next. Sizes differ
    /// from index to index.
    std::vector<std::array<Reflector, 2>> reflectors = {};
    std::vector<RequestedDirections> requested = {};  ///< by index
    std::vector<KnownBoundary> boundaries = {};
    std::vector<double> brightness = {};  ///< of order 0, of media solved as half-spaces
};

/// Solves the base and puts the coats on it. Fourier orders after the first find their matrices
/// allocated (except by the paper's methods, which are there for comparison). Not thread-safe.
class StackSolver {
  public:
    /// The arguments must outlive this.
    /// @param requested  in air
    StackSolver(const ScaledStack& stack, const StackGrids& grids,
                const RequestedDirections& requested, const SolverOptions& options,
                StackMemory& memory);
    ~StackSolver();

    /// Of the whole stack, boundary included. Where there is one, `specular` is the reflection into
    /// the mirror direction, the same in all orders.
    /// @param sky  for ReflectorParts::sky: downward radiance at the nodes of StackGrids::top
    /// @return valid until the next call
    const Reflector& solve(int fourier_order, ReflectorParts parts,
                           const Eigen::VectorXd& sky = {});

  private:
    /// What light sees below the first coat to be put on, whose index is returned: the base, or a
    /// coat so deep for this order that it is a half-space itself.
    std::size_t solve_lowest();
    void solve_base();
    /// The boundary to air.
    void put_on_top(int fourier_order, ReflectorParts parts, const Eigen::VectorXd& sky);
    const SmoothBoundary& boundary_between(double below, double above);
    void put_on_boundary(double below, double above, ReflectorParts parts,
                         const Eigen::VectorXd& sky);
    void put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky);
    /// Degrees that a medium has no moments for scatter nothing.
    void set_medium(std::size_t index);
    /// After set_medium.
    void solve_as_half_space(HalfSpaceMethod method, std::size_t index);
    /// Every method is the default: the paper's treat each coat and base as it is.
    bool may_leave_out_layers() const;

    Reflector& free_reflector(double index);
    std::size_t place_of(double index) const;
    const FourierMode& mode_of(double index) const { return *memory_.modes[place_of(index)]; }
    const RequestedDirections& requested_in(double index) const {
        return memory_.requested[place_of(index)];
    }

    const ScaledStack& stack_;
    const StackGrids& grids_;
    std::unique_ptr<RoughTop> rough_top_;
    const SolverOptions& options_;
    double tolerance_;  ///< of the equations of one order
    StackMemory& memory_;
    Reflector* reflector_ = nullptr;  ///< of all that has been solved so far in this order
};

}  // namespace miebrdf::rte
