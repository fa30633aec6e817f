// Even Fourier series of the azimuth: their values, and weighted sums of neighbours in a table.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace miebrdf::math {

/// Orders are summed so many at a time: lists of coefficients are filled up with zeros to a
/// multiple of it.
inline constexpr std::size_t kSeriesLanes = 8;

/// a_0 + sum a_m cos(m azimuth) by Clenshaw's recurrence over every kSeriesLanes-th order.
/// @param a  a multiple of kSeriesLanes coefficients, at least one
double cosine_sum(std::span<const double> a, double cos_azimuth);

/// Series of a table with two axes: series (i, j) begins at first[i * next_row + j * next_column].
struct SeriesTable {
    static constexpr std::size_t kNeighbours = 6;
    using Weights = std::array<float, kNeighbours>;

    const float* first;
    std::size_t next_row;
    std::size_t next_column;

    /// The sum over i, j < kNeighbours of rows[i] columns[j] times series (i, j), in single
    /// precision.
    /// @param sum  as many orders as are wanted, a multiple of kSeriesLanes
    void add_up(const Weights& rows, const Weights& columns, std::span<double> sum) const;
};

}  // namespace miebrdf::math
