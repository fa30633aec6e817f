// How finely a stack is sampled: nodes, grid and moments, from the phase functions and tolerance.
#pragma once

#include <vector>

#include "rte/fourier/fourier_reflection.h"
#include "rte/stack/stack.h"

namespace miebrdf::rte {

struct Discretisation {
    GridKind grid = GridKind::mapped_gauss;
    int streams = 0;
    int moments = 0;  ///< at most this many are kept
};

/// Grid and moments for a given number of nodes.
Discretisation choose_discretisation(const Stack& stack, const SolverOptions& options, int streams);

/// A phase function with so much beyond degree n (chi_n > 1e-3) that the error does not yet fall
/// geometrically with the number of nodes.
bool converges_slowly(const Stack& stack, int streams);

/// Nodes to try, ascending: from what the tolerance and the phase functions suggest up to 256.
std::vector<int> stream_ladder(const Stack& stack, const SolverOptions& options);

/// Fewer nodes, to estimate the error of `streams` nodes by comparison.
int coarser_streams(int streams);

/// The stack as the discrete equations see it: delta-M, layers without depth left out, everything
/// below an infinitely deep coat left out.
ScaledStack scale_stack(const Stack& stack, int moments, bool delta_m);

}  // namespace miebrdf::rte
