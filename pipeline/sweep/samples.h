// Samples that fill a box of several parameters evenly: Sobol's sequence and Latin hypercubes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/sweep/sweep.h"

namespace miebrdf::sweep {

/// The range that a column of samples spans.
struct SampleRange {
    std::string name;
    double first = 0.0, last = 1.0;
    bool is_logarithmic = false;  ///< even in the logarithm
};

/// Reads `50:1000 log`, `0:1 linear` or `0:1` (the same).
/// @throws UsageError  for anything else, and for logarithms through numbers that are not positive
SampleRange parse_sample_range(const std::string& name, const std::string& text);

/// The first points of Sobol's sequence (Boost.Random, direction numbers of Joe and Kuo 2008)
/// without the origin: 1/2, 3/4, 1/4, 3/8, ... in every column, each in an order of its own. Any
/// 2^k - 1 first ones leave one of 2^k equal intervals empty, that at the start of the range.
/// @return one axis for each range, of `count` values
/// @throws UsageError  for counts outside 1 ... 1,000,000, no ranges, more than 1000 ranges
std::vector<Axis> sobol_samples(std::size_t count, const std::vector<SampleRange>& ranges);

/// A Latin hypercube (McKay et al. 1979): every column has one value in each of `count` equal
/// intervals, at a random place in it, the intervals in random order. The same seed gives the same
/// values everywhere.
/// @throws UsageError  as of sobol_samples
std::vector<Axis> latin_hypercube_samples(std::size_t count, const std::vector<SampleRange>& ranges,
                                          std::uint32_t seed);

}  // namespace miebrdf::sweep
