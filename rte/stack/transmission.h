// Transmission by a film, from directions in air on one side into directions in air on the other.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/phase/stack_of_media.h"

namespace miebrdf::rte {

/// T = pi BTDF, as R = pi BRDF; row = cosine of the light that leaves below, column = cosine of the
/// light that enters above; azimuth 0 is straight on. By reciprocity transmission upwards is the
/// transpose.
struct TransmittedOrders {
    /// T^m of light scattered more than once: T = T^0 + 2 sum T^m cos(m azimuth).
    std::vector<Eigen::MatrixXd> orders;
    std::vector<double> plane_transmittance;  ///< at each cosine, of all light
    ScaledStack stack, upside_down;           ///< for light scattered once
    bool converged = true;                    ///< of all iterations
    bool physical = true;
};

/// Why tabulate_transmission cannot solve this stack; empty where it is a film in air.
const char* why_not_transmitted(const Stack& stack);

/// Follows beams that enter from below through the steps of StackSolver: each layer transmits them
/// and adds scattered light, each boundary reflects light any number of times. Light scattered once
/// is left out (add_transmitted_once adds it with exact phase functions).
/// @param stack   why_not_transmitted() is empty
/// @param mu      ascending, in (0, 1]
/// @param solved  report of a reflection: gives nodes and moments
TransmittedOrders tabulate_transmission(const Stack& stack, const std::vector<double>& mu,
                                        const SolverReport& solved, const SolverOptions& options);

/// Adds light scattered once, by exact phase functions and, as in R, optical depths scaled by
/// delta-M.
/// @param values  T at each of cos_azimuth, to which the light is added
void add_transmitted_once(const TransmittedOrders& film, double mu_in, double mu_out,
                          const std::vector<double>& cos_azimuth, std::vector<double>& values);

/// The share of a beam that passes unscattered, with all reflections between boundaries; optical
/// depths are not scaled.
double unscattered_transmittance(const Stack& stack, double mu);

}  // namespace miebrdf::rte
