// The memory in which stacks are solved.
#pragma once

#include "rte/half_space/half_space.h"
#include "rte/layer/layer.h"
#include "rte/stack/shared_tables.h"

namespace miebrdf::rte {

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

}  // namespace miebrdf::rte
