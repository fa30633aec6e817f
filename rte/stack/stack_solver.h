// A stack of media as the discrete equations see it, its reflection in one Fourier order after the
// other, and the memory that takes.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/fourier/eigenmodes.h"
#include "rte/layer/layer.h"
#include "rte/phase/scaled_medium.h"

namespace miebrdf::rte {

struct ScaledStack {
    std::vector<ScaledMedium> media;  ///< from the bottom up; media[0] is the half-space, if any
    BaseKind base = BaseKind::half_space;
    double ground_albedo = 0.0;
    int moments = 1;  ///< Legendre moments of the medium that has most
    /// The flux into what lies below is wanted (Reflector::glow_at_requested): nothing is left out.
    bool transmits = false;
    /// Lower bound of the largest reflection at every incidence (least_brightness): below a deep
    /// coat is left out what does not show beside that. 0: nothing is.
    double brightness = 0.0;
};

/// delta-M for every medium; layers without depth are left out, and so is everything below a coat
/// of infinite depth.
/// @param moments  as of scale_optics
ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m);

/// All matrices that a stack takes, for one Fourier order, one number of nodes and one stack after
/// the other. Wavelengths solved in the same memory save 0 to 5 % of the time at 16 and 24 nodes
/// and 9 to 19 % at 48, where every new memory is fresh pages of the system (31 coated half-spaces,
/// 1 to 1024 pairs of directions). Results are the same to the last bit. Not thread-safe.
struct StackMemory {
    FourierMode mode = {};      ///< of the order that is being solved
    FourierMedium medium = {};  ///< of the base or coat that is being solved
    FourierWork work = {};
    LayerOperator layer = {};
    Reflector reflector = {}, below = {};
};

/// Solves the base and puts the coats on it. Fourier orders after the first find their matrices
/// allocated (except by the paper's methods, which are there for comparison). Not thread-safe.
class StackSolver {
  public:
    /// The arguments must outlive this.
    StackSolver(const ScaledStack& stack, const ZenithGrid& grid,
                const RequestedDirections& requested, const SolverOptions& options,
                StackMemory& memory);

    /// @param sky  for ReflectorParts::sky: downward radiance at the nodes
    /// @return valid until the next call
    const Reflector& solve(int fourier_order, ReflectorParts parts,
                           const Eigen::VectorXd& sky = {});

  private:
    /// What light sees below the first coat to be put on, whose index is returned: the base, or a
    /// coat so deep for this order that it is a half-space itself.
    std::size_t solve_lowest();
    void solve_base();
    void put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky);
    /// Degrees that a medium has no moments for scatter nothing.
    void set_medium(const ScaledMedium& medium);
    /// Every method is the default: the paper's treat each coat and base as it is.
    bool may_leave_out_layers() const;

    const ScaledStack& stack_;
    const ZenithGrid& grid_;
    const RequestedDirections& requested_;
    const SolverOptions& options_;
    double tolerance_;  ///< of the equations of one order
    StackMemory& memory_;
};

}  // namespace miebrdf::rte
