// The suites of `miebrdf bench`: what is computed, by whom, and against which truth.
#pragma once

#include <string>
#include <vector>

#include "tools/bench/measurement.h"
#include "tools/bench/results.h"

namespace miebrdf::bench {

std::vector<BenchCase> mie_suite();
std::vector<BenchCase> half_space_suite();
std::vector<BenchCase> coat_suite();
std::vector<BenchCase> boundary_suite();
std::vector<BenchCase> stokes_suite();
std::vector<BenchCase> surface_suite();
std::vector<BenchCase> pipeline_suite();
/// One case for each rule of `plan` (pipeline/plan/rules.h): the full and the reduced request.
std::vector<BenchCase> rules_suite();

/// "mie", "half-space", "coat", "boundary", "stokes", "surface", "pipeline", "rules".
const std::vector<std::string>& suite_names();

/// @throws miebrdf::UsageError  for an unknown name, listing the known ones
std::vector<BenchCase> suite(const std::string& name);

/// Measures cases and describes them in the facts.
/// @param watch  called with the name of each case before it is run
Results run_cases(const std::vector<BenchCase>& cases, const MeasureOptions& options,
                  const std::function<void(const std::string&)>& watch = {});

}  // namespace miebrdf::bench
