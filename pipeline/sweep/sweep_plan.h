// A plan says what a sweep will cost, and which of its scenes cannot be computed, before it runs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace miebrdf {
struct Control;
}

namespace miebrdf::sweep {

struct Layout;
struct Sweep;

struct SweepPlan {
    std::size_t scenes = 0, groups = 0, chunks = 0;
    double values = 0.0;         ///< numbers in the table
    double netcdf_bytes = 0.0;   ///< before compression
    double csv_bytes = 0.0;      ///< about
    double memory_bytes = 0.0;   ///< at most, of shared single scattering and one chunk
    std::size_t looked_at = 0;   ///< scenes, spread evenly; all of them where that is soon done
    std::size_t refused = 0;     ///< scenes of those that cannot be computed at all
    std::size_t incomplete = 0;  ///< scenes of those that lack some wavelengths
    std::vector<std::string> refusals = {};  ///< the first of both, each with its values and why
    double processor_seconds = 0.0;          ///< of the whole, all threads together
    std::size_t processors = 1;              ///< as many threads as the sweep would have
};

/// Puts the rules and formulas of `plan` (miebrdf/plan.h) to the scenes of a sweep. Mie theory that
/// several scenes share counts once. Computes nothing and stores nothing.
/// @param budget_s  of processor time: half of it to look for scenes that cannot be computed, half
///                  to plan what scenes cost
/// @throws Cancelled
SweepPlan plan_sweep(const Sweep& sweep, const Layout& layout, double budget_s,
                     const Control& control);

}  // namespace miebrdf::sweep
