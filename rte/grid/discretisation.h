// The discretisation of a stack (nodes, grid and moments, chosen by its phase functions and the
// tolerance), and the error of the result, estimated by solutions with fewer nodes.
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
    int moments = 0;  ///< most moments kept of a phase function
};

/// The largest |chi_degree| of all media.
double largest_moment(const Stack& stack, int degree);

/// Most moments kept for each node. n nodes resolve 2n degrees; projected on them (NodeProjection),
/// further degrees still reduce the error, but little where nodes are few, and there R of faint
/// light may turn negative.
int moments_per_node(int streams);

/// Nodes of the first solution for media of more than 8 moments.
int first_streams(double tolerance);

/// Whether the error does not yet fall geometrically with the number n of nodes: a phase function
/// has a large moment chi_2n, or the ground has a hot spot.
bool converges_slowly(const Stack& stack, int streams);

/// Grid and moments for a given number of nodes: moments_per_node() for each node, without the last
/// moments whose effect on R is below the tolerance.
Discretisation choose_discretisation(const Stack& stack, const SolverOptions& options, int streams);

/// A solution with one discretisation; its lists keep their memory for the next solution.
struct Solution {
    std::vector<double> values;  ///< reflection, or plane albedos and the spherical albedo
    /// Set beside a reflection; the second for Stokes vectors alone.
    std::vector<double> plane_albedo = {}, polarised_plane_albedo = {};
    /// The estimated error of each value, relative to the largest of its block; never NaN.
    std::vector<double> errors = {};
    SolverReport report;
    bool steps_converged = false;  ///< the iterations converged, whatever the estimated error is
    /// The solution exists: the discrete equations are positive definite
    /// (rte/fourier/eigenmodes.h). False too for a solution that was never computed.
    bool physical = false;
    bool has_glory = false;  ///< the nodes do not resolve some narrow features of a phase function

    void clear();
};

/// The solutions that an error estimate compares, ascending in nodes.
struct Solutions {
    Solution coarsest, coarse, fine;
};

/// Computes a solution; the second argument comes cleared.
using Solve = std::function<void(const Discretisation&, Solution&)>;

/// The scale of the error of each value: the largest |value| of its block, or least_scale if that
/// is larger.
struct JudgedValues {
    std::size_t count = 0;
    std::size_t block = 1;  ///< number of values of one incidence
    double least_scale = 0.0;
    std::vector<bool> near_backwards = {};  ///< near retro-reflection, by value; empty: none is
    /// The smaller cosine of each value's two directions, in the topmost medium; empty: none
    /// grazes.
    std::vector<double> cosines = {};
};

/// Solves with a number of nodes, and as long as the solution is not physical again with fewer
/// moments. Where no number of moments helps, all `count` values are NaN. Estimates no error.
void solve_with_nodes(const Stack& stack, const SolverOptions& options, int streams,
                      std::size_t count, const Solve& solve, Solution& solution);

/// Solves with several numbers of nodes; the differences estimate the error of the finest solution.
/// Unless SolverOptions::streams is given, nodes are added until the estimate meets the tolerance
/// or stops falling. Values of a solution that is not physical are NaN.
/// @param solutions  overwritten; `fine` is the result
Solution& solve_with_estimate(const Stack& stack, const SolverOptions& options,
                              const JudgedValues& judged, const Solve& solve, Solutions& solutions,
                              const RefinementCallback& refined = {});

}  // namespace miebrdf::rte
