// Checks computed values by physics and statistics, and says whether a result is converged.
#pragma once

#include <miebrdf/brdf.h>

#include <vector>

#include <miebrdf/optics.h>

namespace miebrdf {

/// Reciprocity and the least value.
/// @param values  BRDF, laid out as BrdfValues::Slice; not empty
PhysicsReport physics_of(const std::vector<double>& values, const Directions& directions);

/// The part of the tolerance that Mie theory leaves, so that both estimates together stay within
/// it. A tolerance of the size average that leaves nothing was the user's choice: half is for the
/// streams all the same.
double tolerance_for_transfer(double tolerance, double mie_error_estimate);

/// The error that points of the phase function may have at each value: their share of the
/// tolerance, or most of what the estimates of the other steps have left of it there, if that is
/// more.
/// @param transfer_errors  of rte::ReflectionTable
std::vector<double> rest_for_phase(double tolerance, double mie_error_estimate,
                                   const std::vector<double>& transfer_errors);

/// The one place that decides whether values are converged: all estimates together (transfer, size
/// averages, points of the phase function) are within `tolerance`, and transfer says so. A size
/// average that missed its own share of the tolerance matters by its estimate alone.
/// @param report         its solver's part is set
/// @param with_transfer  of PhaseErrors; of values without points of P the solver's own estimate
void judge(WavelengthReport& report, double with_transfer, double mie_error_estimate,
           double tolerance);
void judge(WavelengthReport& report, double mie_error_estimate, double tolerance);

}  // namespace miebrdf
