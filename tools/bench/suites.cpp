#include "tools/bench/suites.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <miebrdf/error.h>

namespace miebrdf::bench {

const std::vector<std::string>& suite_names() {
    static const std::vector<std::string> names = {"mie",    "half-space", "coat",     "boundary",
                                                   "stokes", "surface",    "pipeline", "rules"};
    return names;
}

std::vector<BenchCase> suite(const std::string& name) {
    if (name == "mie") return mie_suite();
    if (name == "half-space") return half_space_suite();
    if (name == "coat") return coat_suite();
    if (name == "boundary") return boundary_suite();
    if (name == "stokes") return stokes_suite();
    if (name == "surface") return surface_suite();
    if (name == "pipeline") return pipeline_suite();
    if (name == "rules") return rules_suite();
    throw UsageError(
        fmt::format("unknown suite '{}'; allowed: {}", name, fmt::join(suite_names(), ", ")));
}

Results run_cases(const std::vector<BenchCase>& cases, const MeasureOptions& options,
                  const std::function<void(const std::string&)>& watch) {
    Results results;
    results.facts = machine_facts();
    for (const BenchCase& c : cases) {
        if (watch) watch(c.suite + ": " + c.name);
        results.facts.emplace_back("case " + c.suite + "/" + c.name,
                                   c.quantity + " Truth: " + c.truth);
        for (Measurement& m : measure(c, options)) results.measurements.push_back(std::move(m));
    }
    return results;
}

}  // namespace miebrdf::bench
