#include "pipeline/sweep/samples.h"

#include <fmt/format.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/sobol.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <cmath>

#include "materials/database/names.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/sweep/axis_values.h"

namespace miebrdf::sweep {
namespace {

constexpr std::size_t kMostSamples = 1'000'000, kMostColumns = 1000;

void require_counts(std::size_t count, std::size_t columns) {
    if (!(count >= 1 && count <= kMostSamples))
        throw UsageError("samples", double(count), fmt::format("1 to {}", kMostSamples));
    if (!(columns >= 1 && columns <= kMostColumns)) {
        throw UsageError(
            fmt::format("samples of {} columns; allowed: 1 to {}, each written as "
                        "radius_um = \"50:1000 log\"",
                        columns, kMostColumns));
    }
}

/// @param x  in [0, 1]
double value_at(const SampleRange& range, double x) {
    const double value = range.is_logarithmic ? range.first * std::pow(range.last / range.first, x)
                                              : range.first + x * (range.last - range.first);
    return std::stod(fmt::format("{:.12g}", value));  // as in ranges: twelve digits
}

std::vector<Axis> axes_of_points(const std::vector<std::vector<double>>& columns,
                                 const std::vector<SampleRange>& ranges) {
    std::vector<Axis> axes;
    for (std::size_t c = 0; c < ranges.size(); ++c) {
        std::vector<double> values;
        for (const double x : columns[c]) values.push_back(value_at(ranges[c], x));
        axes.push_back(axis_of(ranges[c].name, std::move(values)));
    }
    return axes;
}

}  // namespace

SampleRange parse_sample_range(const std::string& name, const std::string& text) {
    const std::string whole = trimmed_text(text);
    const std::size_t blank = std::min(whole.find_first_of(" \t"), whole.size());
    const std::string spacing = trimmed_text(whole.substr(blank));
    const std::vector<std::string> ends = split_list(whole.substr(0, blank), ':');
    if (ends.size() != 2 || !(spacing.empty() || spacing == "log" || spacing == "linear")) {
        throw UsageError(
            fmt::format("axis {}: '{}' is not a range of samples; write first:last, first:last "
                        "linear or first:last log, e.g. 50:1000 log",
                        name, text));
    }
    const SampleRange range{name, parse_number(ends[0], "axis " + name),
                            parse_number(ends[1], "axis " + name), spacing == "log"};
    if (range.is_logarithmic && !(range.first > 0.0 && range.last > 0.0)) {
        throw UsageError(
            fmt::format("axis {}: '{}' goes through numbers that are not positive", name, text));
    }
    return range;
}

std::vector<Axis> sobol_samples(std::size_t count, const std::vector<SampleRange>& ranges) {
    require_counts(count, ranges.size());
    boost::random::sobol engine(ranges.size());
    constexpr double all = 18446744073709551616.0;  // 2^64: the engine fills its integers
    static_assert((boost::random::sobol::max)() == ~std::uint64_t{0});
    std::vector<std::vector<double>> columns(ranges.size(), std::vector<double>(count));
    for (std::size_t i = 0; i < count; ++i) {
        for (std::vector<double>& column : columns) column[i] = double(engine()) / all;
    }
    return axes_of_points(columns, ranges);
}

std::vector<Axis> latin_hypercube_samples(std::size_t count, const std::vector<SampleRange>& ranges,
                                          std::uint32_t seed) {
    require_counts(count, ranges.size());
    boost::random::mt19937_64 engine(seed);
    boost::random::uniform_01<double> uniform;
    std::vector<std::vector<double>> columns(ranges.size());
    for (std::vector<double>& column : columns) {
        for (std::size_t i = 0; i < count; ++i)
            column.push_back((double(i) + uniform(engine)) / double(count));
        for (std::size_t i = count; i-- > 1;) {
            boost::random::uniform_int_distribution<std::size_t> upto(0, i);
            std::swap(column[i], column[upto(engine)]);
        }
    }
    return axes_of_points(columns, ranges);
}

}  // namespace miebrdf::sweep
