// What the data tell of numbers at a minimum, and what they leave open.
#pragma once

#include <miebrdf/fit.h>

#include <string>
#include <vector>

#include "pipeline/fit/minima.h"
#include "pipeline/fit/model.h"

namespace miebrdf::fitting {

struct Certainty {
    /// Of each slot; NaN where a number is at a bound or the data do not tell it.
    std::vector<double> standard_error, interval_low, interval_high;
    std::vector<bool> at_bound;
    std::vector<double> correlation;  ///< [i * slots + j]
    std::vector<std::string> undetermined;
};

/// @param values, derivatives  of the model at the numbers (Model::evaluate)
/// @param sigma  of a residual: 1 where sigmas are known, else what the
/// residuals say; 0: nothing
/// @param quantile  of a 95 % interval, in standard errors
Certainty certainty_of(const FitProblem& problem, const Model& model, const Target& target,
                       const std::vector<double>& numbers, const std::vector<double>& values,
                       const std::vector<double>& derivatives, double sigma, double quantile);

/// "radius", "k at 550 nm"
std::string name_of(const FitProblem& problem, const Model& model, std::size_t slot);

}  // namespace miebrdf::fitting
