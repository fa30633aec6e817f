// What a sweep will cost, from a timed sample of its scenes.
#pragma once

#include <cstddef>

#include "pipeline/sweep/parts.h"

namespace miebrdf::sweep {

struct SweepPlan {
    std::size_t scenes = 0, groups = 0, chunks = 0;
    double values = 0.0;        ///< numbers in the table
    double netcdf_bytes = 0.0;  ///< before compression
    double csv_bytes = 0.0;     ///< about
    double memory_bytes = 0.0;  ///< at most, of shared single scattering and one chunk
    std::size_t sampled = 0;    ///< scenes that were timed
    std::size_t sampled_groups = 0;
    double sample_seconds = 0.0;  ///< what timing them took
    double seconds = 0.0;         ///< of the whole, on this machine with these threads
    /// Standard error of `seconds` from the spread among the groups timed; 0 for a single one.
    double seconds_error = 0.0;
};

/// Times scenes in groups that are spread evenly over the sweep, as they would be computed; stops
/// after about `budget_s`, with at least one group. Nothing is stored.
/// @throws Cancelled
SweepPlan plan_sweep(const Sweep& sweep, const Layout& layout, double budget_s,
                     const Control& control);

}  // namespace miebrdf::sweep
