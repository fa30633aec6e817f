// Numbers of a scene that a formula makes of unknowns and the wavelength: power laws.
#pragma once

#include <miebrdf/fit.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "pipeline/scene/scene_template.h"

namespace miebrdf::fitting {

/// Null: there is none of this name.
const DerivedNumber* find_derived(const FitProblem& problem, const std::string& name);

/// Whether a formula's number stands in the words.
bool uses_derived(const FitProblem& problem, const std::vector<TemplateWord>& words);

/// The unknowns that stand in the words, or in the formulas of numbers that do.
std::set<std::string> unknowns_in(const FitProblem& problem,
                                  const std::vector<TemplateWord>& words);

/// @param number_of  an unknown's value
/// @throws UsageError  for what is no formula, and where it gives no finite number
double derived_number(const DerivedNumber& derived, double wavelength_nm,
                      const std::function<double(const std::string& unknown)>& number_of);

/// @throws UsageError  for names and formulas that cannot be
void check_derived(const FitProblem& problem);

}  // namespace miebrdf::fitting
