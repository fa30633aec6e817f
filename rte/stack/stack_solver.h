// Reflection of a whole stack, one Fourier order after the other, and the memory it takes.
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <miebrdf/solver.h>
#include "rte/fourier/eigenmodes.h"
#include "rte/layer/layer.h"
#include "rte/stack/scaled_stack.h"

namespace miebrdf::rte {

/// Keeps what depends on directions, nodes and orders but on no medium: wavelengths and layers need
/// it again. Not for two threads.
class SharedTables {
  public:
    /// @param most_bytes  of Legendre tables; those beyond, and all for 0, are made again every
    /// time
    explicit SharedTables(std::size_t most_bytes = 16 << 20) : most_bytes_(most_bytes) {}

    /// @param kind, count  as of make_zenith_grid
    /// @return valid as long as this
    const ZenithGrid& grid(GridKind kind, int count);

    /// As make_phase_mode. Tables are kept until other directions are requested; those of grids
    /// that are not of this are not kept.
    /// @return valid until the next call
    const PhaseMode& mode(int order, int degrees, const ZenithGrid& grid,
                          const RequestedDirections& requested);

  private:
    struct Key {
        const ZenithGrid* grid;
        int order, degrees;
        auto operator<=>(const Key&) const = default;
    };

    bool owns(const ZenithGrid& grid) const;

    std::size_t most_bytes_;
    std::map<std::pair<GridKind, int>, ZenithGrid> grids_;
    RequestedDirections requested_;
    std::map<Key, PhaseMode> modes_;
    PhaseMode not_kept_;
    std::size_t bytes_ = 0;
};

/// All that a stack takes, for one order, one number of nodes and one stack after the other. Not
/// for two threads.
struct StackMemory {
    SharedTables tables = SharedTables();
    ScatteringMode medium = {};
    OrderWork work = {};
    LayerOperator layer = {};
    Reflector reflector = {}, below = {};
};

/// For one solution, which needs no table twice.
inline StackMemory memory_for_one() { return {.tables = SharedTables(0)}; }

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
