// How a phase table is built: nodes and polynomials of its panels.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include <miebrdf/ensemble.h>

namespace miebrdf::mie {

/// Angles in radians of the nodes of a panel, ascending from lower to upper: Chebyshev points with
/// both ends.
std::vector<double> panel_nodes(double lower, double upper);

/// sum_l (2l + 1) chi_l P_l at those nodes, one column per panel between the edges (radians).
Eigen::MatrixXd series_on_panels(std::span<const double> chi, const std::vector<double>& edges);

/// Chebyshev coefficients from the values at those nodes.
Eigen::VectorXd panel_coefficients(const Eigen::VectorXd& values);

/// The polynomial with these coefficients (PhaseTable::kPanelNodes) at t, -1 to 1 over the panel.
double panel_value(const double* coefficients, double t);

/// A table from P at the nodes of its panels.
/// @param values  one column per panel, at panel_nodes
/// @param parts  all but coefficients and mean, which follow from the values
/// @param least_noise  that is stated of each panel that has any, relative to its mean P
PhaseTable make_phase_table(PhaseTable::Parts parts, const Eigen::MatrixXd& values,
                            double least_noise);

/// P of all its moments, on even panels; each has the rms of the noise around it.
/// @param chi     all, so that the table gave them
/// @param noise   of P at `angles`, relative to max(P, floor); empty: none
/// @param angles  radians, those of Gauss nodes
/// @param tolerance  of the moments
PhaseTable table_of_series(const std::vector<double>& chi, const Eigen::ArrayXd& noise,
                           const Eigen::ArrayXd& angles, double floor, double tolerance);

/// Half periods of the fastest wave of P: the nodes of a Gauss rule are about as far apart. The
/// change of P at a node is one random number, and small by chance: nodes so far apart count
/// together.
inline constexpr double kNoiseReach = 4;

/// The rms of the noise within kNoiseReach of an interval; the largest near 180 degrees.
double noise_around(double lower, double upper, const Eigen::ArrayXd& noise,
                    const Eigen::ArrayXd& angles, double half_period);

}  // namespace miebrdf::mie
