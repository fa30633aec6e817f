// How finely a stack is sampled (nodes, grid and moments, by its phase functions and the
// tolerance), and the estimated error of the result.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/transfer.h>
#include "rte/grid/directions.h"

namespace miebrdf::rte {

struct Discretisation {
    GridKind grid = GridKind::mapped_gauss;
    int streams = 0;
    int moments = 0;  ///< kept of each phase function, at most
};

/// The largest |chi_degree| of all media.
double largest_moment(const Stack& stack, int degree);

/// Moments kept for each node, at most. With more than 2 (NodeProjection) nodes make use of further
/// degrees; few nodes gain little by it, and R of faint light may turn negative.
int moments_per_node(int streams);

/// Nodes of the first solution for media of more than 8 moments.
int first_streams(double tolerance);

/// Whether a phase function has so large a moment chi_2n that the error does not yet fall
/// geometrically with the number n of nodes.
bool converges_slowly(const Stack& stack, int streams);

/// Grid and moments for a given number of nodes: as many moments as the nodes carry, without those
/// at the end that are too small to show at the tolerance.
Discretisation choose_discretisation(const Stack& stack, const SolverOptions& options, int streams);

/// A solution with one discretisation. Lists keep their memory for the next solution.
struct Solution {
    std::vector<double> values;  ///< reflection, or plane albedos and the spherical albedo
    /// Of a reflection; the second of Stokes vectors alone.
    std::vector<double> plane_albedo = {}, polarised_plane_albedo = {};
    /// The estimated error of each value, relative to the largest of its block; never NaN.
    std::vector<double> errors = {};
    SolverReport report;
    bool steps_converged = false;  ///< report.converged before solutions are compared
    bool physical = false;
    bool has_glory = false;  ///< some narrow features are not resolved by the nodes

    void clear();
};

/// The solutions that an error estimate compares, ascending in nodes.
struct Solutions {
    Solution coarsest, coarse, fine;
};

/// Fills a solution, which comes empty.
using Solve = std::function<void(const Discretisation&, Solution&)>;

/// The values of a solution, as their errors are judged.
struct JudgedValues {
    std::size_t count = 0;
    std::size_t block = 1;     ///< values of one incidence: errors are relative to the largest
    double least_scale = 0.0;  ///< errors are relative to this at least
    std::vector<bool> near_backwards = {};  ///< of each value; empty: none is
};

/// Solves with a number of nodes; again with fewer moments where the solution is not physical. A
/// solution that is physical with no number of moments has `count` values NaN. No error is
/// estimated.
void solve_with_nodes(const Stack& stack, const SolverOptions& options, int streams,
                      std::size_t count, const Solve& solve, Solution& solution);

/// Solves with several numbers of nodes, whose differences estimate the error of the finest. Unless
/// SolverOptions::streams is given, nodes are added until the estimate meets the tolerance or stops
/// falling. A solution that is not physical has `count` values NaN.
/// @param solutions  overwritten; `fine` is the result
Solution& solve_with_estimate(const Stack& stack, const SolverOptions& options,
                              const JudgedValues& judged, const Solve& solve, Solutions& solutions,
                              const RefinementCallback& refined = {});

}  // namespace miebrdf::rte
