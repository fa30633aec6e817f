// How finely a stack is sampled: nodes, grid and moments, from the phase functions and tolerance;
// and how far off the result may be.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/transfer.h>
#include "rte/grid/directions.h"

namespace miebrdf::rte {

struct Discretisation {
    GridKind grid = GridKind::mapped_gauss;
    int streams = 0;
    int moments = 0;  ///< at most this many are kept
};

/// |chi_degree| of the medium where it is largest.
double largest_moment(const Stack& stack, int degree);

/// Most moments kept for each node: nodes see more than 2n degrees as far as they can resolve them
/// (NodeProjection). Few nodes gain little, and lose the sign of the faintest light.
int moments_per_node(int streams);

/// Nodes that the automatic choice begins with for media of more than a few moments.
int first_streams(double tolerance);

/// Whether a phase function has so much beyond degree n that the error does not yet fall
/// geometrically with the number of nodes.
bool converges_slowly(const Stack& stack, int streams);

/// Grid and moments for a given number of nodes. Of moments that fall off no more are kept than the
/// tolerance shows.
Discretisation choose_discretisation(const Stack& stack, const SolverOptions& options, int streams);

/// One solution with one discretisation. Its lists keep their memory from one to the next.
struct Solution {
    std::vector<double> values;        ///< reflection, or plane albedos and the spherical albedo
    std::vector<double> plane_albedo;  ///< beside a reflection
    std::vector<double> polarised_plane_albedo = {};  ///< likewise, of Stokes vectors
    /// The estimated error of each value, relative to the largest of its block; never NaN.
    std::vector<double> errors = {};
    SolverReport report;
    bool steps_converged = false;  ///< all but the comparison with other numbers of nodes
    bool physical = false;
    bool has_glory = false;  ///< narrow features that the nodes do not resolve all of

    void clear();
};

/// The solutions that an error estimate compares, ascending in nodes.
struct Solutions {
    Solution coarsest, coarse, fine;
};

/// The solution comes empty.
using Solve = std::function<void(const Discretisation&, Solution&)>;

/// Watches the estimates of a ladder of stream counts. Directions that no number of nodes in reach
/// resolves (a forward peak seen along the horizon) keep the estimate where it is: climbing on
/// would cost n^3 and gain nothing.
class LadderProgress {
  public:
    /// True once the estimate has grown to twice the best before it, or two steps (twice the nodes)
    /// have not halved it.
    bool has_stalled_at(double estimate);

  private:
    double best_ = std::numeric_limits<double>::infinity();
    double best_before_ = std::numeric_limits<double>::infinity();  ///< without the last estimate
};

/// A solution with so little work is tried even if more nodes did not help before.
bool is_worth_a_try(int streams, int fourier_orders);

/// The values of a solution, as their errors are judged.
struct JudgedValues {
    std::size_t count = 0;
    std::size_t block = 1;     ///< of one incidence: errors are relative to the largest of them
    double least_scale = 0.0;  ///< but to no less than this
    std::vector<bool> near_backwards = {};  ///< of each value; empty: none is
};

/// A solution with so many nodes, and fewer moments than they can keep where it is not physical
/// with these; then still not: `count` times NaN. Its error is not estimated.
void solve_with_nodes(const Stack& stack, const SolverOptions& options, int streams,
                      std::size_t count, const Solve& solve, Solution& solution);

/// Two numbers of nodes give the result and what its error may be; without a given number of nodes
/// they grow until the estimate meets the tolerance or stops falling. A result that is not physical
/// is `count` times NaN.
/// @param solutions  overwritten; `fine` is the result
Solution& solve_with_estimate(const Stack& stack, const SolverOptions& options,
                              const JudgedValues& judged, const Solve& solve, Solutions& solutions,
                              const RefinementCallback& refined = {});

/// Errors of a solution's values, none less than that of the azimuths beside it, nor than half of
/// all at its incidence: two solutions may agree by accident at single values.
std::vector<double> largest_nearby(const std::vector<double>& errors, const Directions& directions);

/// The cosines of a request; a small one gets others beside them, where two solutions are compared
/// as well.
RequestedDirections collect_with_probes(const Directions& directions);

}  // namespace miebrdf::rte
