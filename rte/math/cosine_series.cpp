#include "rte/math/cosine_series.h"

#include <Eigen/Core>

namespace miebrdf::math {
namespace {

constexpr std::size_t kLanes = kSeriesLanes;
using Lanes = Eigen::Array<double, kLanes, 1>;

// Some neighbouring lanes of a sum over a table; n of them share the reading of the weights and, a
// line of the processor's cache being 16 numbers wide, that of lines.
template <int n>
void add_up_lanes(const SeriesTable& table, std::size_t order, const SeriesTable::Weights& rows,
                  const SeriesTable::Weights& columns, double* sum) {
    using FloatLanes = Eigen::Array<float, n* int(kLanes), 1>;
    FloatLanes total = FloatLanes::Zero();
    for (std::size_t i = 0; i < SeriesTable::kNeighbours; ++i) {
        const float* series = table.first + order + i * table.next_row;
        FloatLanes row = FloatLanes::Zero();
        for (std::size_t j = 0; j < SeriesTable::kNeighbours; ++j, series += table.next_column)
            row += columns[j] * Eigen::Map<const FloatLanes>(series);
        total += rows[i] * row;
    }
    Eigen::Map<Eigen::Array<double, n* int(kLanes), 1>>(sum + order) =
        total.template cast<double>();
}

}  // namespace

double cosine_sum(std::span<const double> a, double cos_azimuth) {
    // cos(m azimuth) by products of lower orders, each ready sooner than after steps of one order.
    static_assert(kLanes == 8);
    const double c1 = cos_azimuth;
    const double c2 = 2.0 * c1 * c1 - 1.0, c3 = 2.0 * c1 * c2 - c1;
    const double c4 = 2.0 * c2 * c2 - 1.0, c5 = 2.0 * c2 * c3 - c1;
    const double c6 = 2.0 * c3 * c3 - 1.0, c7 = 2.0 * c3 * c4 - c1;
    const double c8 = 2.0 * c4 * c4 - 1.0;
    Lanes here, lower;  // cos(m azimuth) and, kLanes orders lower, cos((kLanes - m) azimuth)
    here << 1.0, c1, c2, c3, c4, c5, c6, c7;
    lower << c8, c7, c6, c5, c4, c3, c2, c1;
    const double step = 2.0 * c8;
    Lanes next = Lanes::Zero(), after = Lanes::Zero();
    for (std::size_t m = a.size() - kLanes; m > 0; m -= kLanes) {
        const Lanes current = (Eigen::Map<const Lanes>(&a[m]) - after) + step * next;
        after = next;
        next = current;
    }
    const Lanes sum =
        here * (Eigen::Map<const Lanes>(a.data()) - after) + (step * here - lower) * next;
    return sum.sum();
}

void SeriesTable::add_up(const Weights& rows, const Weights& columns, std::span<double> sum) const {
    std::size_t order = 0;
    for (; order + 2 * kLanes <= sum.size(); order += 2 * kLanes)
        add_up_lanes<2>(*this, order, rows, columns, sum.data());
    if (order < sum.size()) add_up_lanes<1>(*this, order, rows, columns, sum.data());
}

}  // namespace miebrdf::math
