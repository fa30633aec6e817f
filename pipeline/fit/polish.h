// The last steps of a search among sizes: from values of a lattice to averages of their own.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/fit/least_squares.h"
#include "pipeline/fit/minima.h"

namespace miebrdf::fitting {

/// Averages from a lattice that move a number by more of its standard error than this are replaced
/// by those of a finer one, or by averages of their own, from their minimum on.
inline constexpr double kMostShift = 0.1;

/// Numbers of the scene for fitted ones, slot by slot.
std::vector<double> numbers_of(const FitProblem& problem, const Model& model,
                               std::span<const double> t);

/// The values and derivatives that residuals and Jacobian were made of.
void keep_known(const Minimum& best, const Target& target, Search& found);

/// How far averages of their own move a minimum that was found with the lattice, in standard
/// errors.
double lattice_shift(const FitProblem& problem, Model& model, const Target& target,
                     const Minimum& best);

/// Whether polish() may follow a coarse search: sums of squares, whose values nothing else
/// corrects.
bool may_be_polished(const FitProblem& problem);

/// Steps by values as the problem asks for them, with averages of their own, and derivatives of the
/// coarse search. Behind a step these values are those before it and the change of the search's,
/// which errs by kSearchTolerance of itself, as long as that is good enough. Where columns of the
/// Jacobian nearly cancel in a direction, so that its condition is c, derivatives along it err by c
/// times what those by single numbers do, and so the minimum by kSearchTolerance c standard errors,
/// and likewise the change by a step by that share of it.
/// @return that, and the step that is left, in standard errors; empty: more than kMostShift, and
///         best stays
std::optional<double> polish(const FitProblem& problem, Model& model, const Target& target,
                             Minimum& best, const std::function<bool()>& is_cancelled);

}  // namespace miebrdf::fitting
