// Reflection of a whole stack, one azimuthal order after the other.
#pragma once

#include <vector>

#include "rte/half_space.h"
#include "rte/layer.h"
#include "rte/scaled_stack.h"
#include "rte/solver_options.h"

namespace miebrdf::rte {

/// Solves the base and puts the coats on it. Owns all matrices this takes: orders after the first
/// find them ready (but for the paper's methods, which are there for comparison).
class StackSolver {
  public:
    /// The arguments must outlive this.
    StackSolver(const ScaledStack& stack, const ZenithGrid& grid,
                const RequestedDirections& requested, const SolverOptions& options);

    /// @param sky  for ReflectorParts::sky: downward radiance at the nodes
    /// @return valid until the next call
    const Reflector& solve(int order, ReflectorParts parts, const Eigen::VectorXd& sky = {});

  private:
    void solve_base();
    void put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky);
    /// Degrees that a medium has no moments for scatter nothing.
    void set_medium(const ScaledMedium& medium);

    const ScaledStack& stack_;
    const ZenithGrid& grid_;
    const RequestedDirections& requested_;
    const SolverOptions& options_;
    double tolerance_;
    PhaseMode mode_;
    ScatteringMode medium_;
    HalfSpaceWork half_space_;
    std::vector<LayerWork> coats_;  ///< one for each medium: what depends on optical depth stays
    LayerOperator layer_;
    Reflector reflector_, below_;
};

}  // namespace miebrdf::rte
