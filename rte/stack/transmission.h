// What passes a film, direction by direction: from air on one side into air on the other.
#pragma once

#include <Eigen/Core>
#include <vector>

#include <miebrdf/optics.h>
#include <miebrdf/solver.h>
#include "rte/phase/stack_of_media.h"

namespace miebrdf::rte {

/// T as R is defined (BTDF = T / pi), row = cosine of what leaves below, column = of the light
/// above; azimuth 0 goes straight on. From below upwards T is the transpose: reciprocity.
struct TransmittedOrders {
    /// T^m of light scattered more than once: T = T^0 + 2 sum T^m cos(m azimuth).
    std::vector<Eigen::MatrixXd> orders;
    std::vector<double> plane_transmittance;  ///< at each cosine, by the discrete equations
    ScaledStack stack, upside_down;           ///< for light scattered once
    bool converged = true;                    ///< of iterations
    bool physical = true;
};

/// Why nothing is known of the directions that pass this stack; empty: it is a film in air.
const char* why_not_transmitted(const Stack& stack);

/// Emission of beams from below, followed through the steps of StackSolver: a layer passes on, and
/// adds what it scatters once or more; a boundary sends light back as often as it takes. Light
/// scattered once between two requested directions is left out (transmitted_once has it exactly).
/// @param stack   why_not_transmitted() is empty
/// @param mu      ascending, in (0, 1]
/// @param solved  the nodes and moments of a solution
TransmittedOrders tabulate_transmission(const Stack& stack, const std::vector<double>& mu,
                                        const SolverReport& solved, const SolverOptions& options);

/// Light scattered exactly once, by the exact phase functions; with delta-M the beams are those of
/// the scaled depths, as in R.
/// @param values  T at each cosine of an azimuth, added to
void add_transmitted_once(const TransmittedOrders& film, double mu_in, double mu_out,
                          const std::vector<double>& cos_azimuth, std::vector<double>& values);

/// The share of a beam that passes without being scattered, returns between boundaries included,
/// with the optical depths as they are.
double unscattered_transmittance(const Stack& stack, double mu);

}  // namespace miebrdf::rte
