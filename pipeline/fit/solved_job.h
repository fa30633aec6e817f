// One scene with numbers in place of its unknowns: the values that were measured of it.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/fit.h>

#include <span>
#include <string>
#include <vector>

#include "pipeline/fit/job.h"

namespace miebrdf::fitting {

/// Values in the order of a job's uses, and derivatives by each of the names asked for in turn.
struct SolvedJob {
    std::vector<double> values;
    std::vector<std::vector<double>> derivatives;  ///< [name][use]
    int streams = 0;                               ///< most that the solver has used
    int components = 1;                            ///< most, of light, that it has used
};

/// The scene of a job. @param names  of numbers that the scene is to know by their names
Request request_of(const FitProblem& problem, const std::vector<Slot>& slots, const Job& job,
                   std::span<const double> numbers, const std::vector<std::string>& names);

/// Traces the light that leaves the sample beside the ports, for the job's uses that ask for it.
/// @return the largest change of a share; 0: none asks
double trace_lost_light(Job& job, const Request& request, const Control& control);

/// @param names  of the derivatives that are wanted; none of a scattered job
/// @throws UsageError  for scenes and derivatives that cannot be; Cancelled
SolvedJob solve_job(const Job& job, const Request& request, const Control& control,
                    const std::vector<std::string>& names);

}  // namespace miebrdf::fitting
