// Reflection of a whole stack, one azimuthal order after the other.
#pragma once

#include <vector>

#include <miebrdf/solver.h>
#include "rte/stack/scaled_stack.h"
#include "rte/stack/stack_memory.h"

namespace miebrdf::rte {

/// Solves the base and puts the coats on it. Orders after the first find their matrices ready (but
/// for the paper's methods, which are there for comparison).
class StackSolver {
  public:
    /// The arguments must outlive this.
    StackSolver(const ScaledStack& stack, const ZenithGrid& grid,
                const RequestedDirections& requested, const SolverOptions& options,
                StackMemory& memory);

    /// @param sky  for ReflectorParts::sky: downward radiance at the nodes
    /// @return valid until the next call
    const Reflector& solve(int order, ReflectorParts parts, const Eigen::VectorXd& sky = {});

  private:
    /// What light sees below the first coat to be put on, whose index is returned: the base, or a
    /// coat so deep for this order that it is a half-space itself.
    std::size_t solve_lowest();
    void solve_base();
    bool hides_what_is_below(const ScaledMedium& coat);
    void put_on_coat(std::size_t index, ReflectorParts parts, const Eigen::VectorXd& sky);
    /// Degrees that a medium has no moments for scatter nothing.
    void set_medium(const ScaledMedium& medium);

    const ScaledStack& stack_;
    const ZenithGrid& grid_;
    const RequestedDirections& requested_;
    const SolverOptions& options_;
    double tolerance_;
    StackMemory& memory_;
    const PhaseMode* mode_ = nullptr;  ///< of the order that is being solved
};

}  // namespace miebrdf::rte
