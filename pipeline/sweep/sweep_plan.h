// What a sweep will cost, from a timed sample of its scenes.
#pragma once

#include <cstddef>

namespace miebrdf {
struct Control;
}

namespace miebrdf::sweep {

struct Layout;
struct Sweep;

struct SweepPlan {
    std::size_t scenes = 0, groups = 0, chunks = 0;
    double values = 0.0;             ///< numbers in the table
    double netcdf_bytes = 0.0;       ///< before compression
    double csv_bytes = 0.0;          ///< about
    double memory_bytes = 0.0;       ///< at most, of shared single scattering and one chunk
    std::size_t sampled = 0;         ///< pairs of a group and a wavelength that were timed
    double sample_seconds = 0.0;     ///< processor time that they took
    double processor_seconds = 0.0;  ///< of the whole, all threads together
    /// Standard error of `processor_seconds` from the spread of the sample; not-a-number for a
    /// single pair.
    double processor_seconds_error = 0.0;
    std::size_t processors = 1;  ///< as many threads as the sweep would have
};

/// Times single wavelengths of groups on one thread: a low-discrepancy sequence over both, ended
/// after about `budget_s` of processor time, with at least two of them. Of each: every species'
/// Mie theory, which counts once for all groups that share it; what the first scene of the group
/// costs besides; and another scene of it. Processor time does not feel what else the machine does,
/// but for its share of caches. Nothing is stored.
/// @throws Cancelled
SweepPlan plan_sweep(const Sweep& sweep, const Layout& layout, double budget_s,
                     const Control& control);

}  // namespace miebrdf::sweep
