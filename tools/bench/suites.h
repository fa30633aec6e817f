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

struct Suite {
    const char* name;
    std::vector<BenchCase> (*cases)();
};
inline constexpr Suite kSuites[] = {{"mie", mie_suite},           {"half-space", half_space_suite},
                                    {"coat", coat_suite},         {"boundary", boundary_suite},
                                    {"stokes", stokes_suite},     {"surface", surface_suite},
                                    {"pipeline", pipeline_suite}, {"rules", rules_suite}};

}  // namespace miebrdf::bench
