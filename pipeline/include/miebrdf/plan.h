// A plan says what a request will cost, what of it is left out, and why, before it is computed: the
// rules that the solver itself asks, and rough formulas for the times.
#pragma once

#include <miebrdf/brdf.h>

#include <set>
#include <string>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// A stage of the computation.
struct PlannedStep {
    std::string stage;     ///< as progress names it
    std::string what;      ///< in words
    std::size_t jobs = 0;  ///< how many, in parallel
    double seconds = 0.0;  ///< estimate for one thread (docs/command-line.md#plan: how good)
};

/// Something that is not computed, and why.
struct Omission {
    std::string rule;      ///< its name, the same for every request
    std::string reason;    ///< why it holds here
    double saved_s = 0.0;  ///< estimate for one thread
};

/// The work that would be done; none of it is.
struct Plan {
    std::vector<PlannedStep> steps;   ///< in their order
    std::vector<Omission> omissions;  ///< what is not computed
    /// The most that a process with one thread holds at once, the program included; an estimate.
    double memory_bytes = 0.0;

    double seconds() const;                          ///< sum over the steps, one thread
    bool leaves_out(const std::string& rule) const;  ///< whether the rule of this name holds
};

/// The work that a run has done before its next result is planned (Control::memo).
struct EarlierWork {
    std::set<std::string> optics;  ///< names of Mie jobs
};

/// Plans brdf.evaluate(directions, parts); the cache of its Control is looked into. Nothing is
/// computed for it: milliseconds.
/// @param earlier  of the same run; this request's own work is added. Null: it is the only one
Plan plan_evaluate(const Brdf& brdf, const Directions& directions, const BrdfParts& parts = {},
                   EarlierWork* earlier = nullptr);
/// Plans brdf.albedo(mu_in).
Plan plan_albedo(const Brdf& brdf, const std::vector<double>& mu_in,
                 EarlierWork* earlier = nullptr);

}  // namespace miebrdf
#pragma GCC visibility pop
