// Questions about a problem that need no solution, and what is wrong with it.
#pragma once

#include <miebrdf/fit.h>

#include <set>
#include <string>
#include <vector>

#include "pipeline/scene/scene_template.h"

namespace miebrdf::fitting {

/// The names that stand in braces in the words.
std::set<std::string> names_in(const std::vector<TemplateWord>& words);

/// The unknown that a data set with a free scale brings.
std::string name_of_scale(const FitData& data);
/// Likewise with a free shift of its wavelengths.
std::string name_of_shift(const FitData& data);

/// Of the solver: a tenth of the smallest relative error of the data, within
/// what makes sense.
double tolerance_of(const FitProblem& problem);

/// Whether each wavelength is a problem of its own.
bool is_separable(const FitProblem& problem);

/// The part at one wavelength of a separable problem.
FitProblem at_wavelength(const FitProblem& problem, double wavelength_nm);

/// "snow.csv, 550 nm, mu_in 0.67"
std::string describe(const FitData& data, const MeasuredValue& value);

/// Of light from all sides alike.
bool is_of_all_sides(const MeasuredValue& value);

/// Whether all values have a standard deviation.
bool has_sigmas(const FitProblem& problem);

/// What checked() looks at, for whoever knows where it stands. @throws UsageError, InputError
void check_search(const FitProblem& problem);
void check_data(const FitData& data);
/// Whether the scene of a data set can be at the start, as far as words tell.
void check_scene(const FitProblem& problem, const FitData& data);

/// With the unknowns that free scales bring, everything held to what it may be.
/// @throws UsageError, InputError  as fit()
FitProblem checked(FitProblem problem);

}  // namespace miebrdf::fitting
