#include "pipeline/formats/table_grid.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include <miebrdf/error.h>
#include "pipeline/solve/parallel.h"

namespace miebrdf::exports {
void validate(const TableGrid& grid) {
    if (grid.size() == 0) throw UsageError("a table needs at least one mu_in, mu_out and azimuth");
    for (const auto* cosines : {&grid.mu_in, &grid.mu_out}) {
        for (const double mu : *cosines) {
            if (!(mu > 0.0 && mu <= 1.0)) {
                throw UsageError(fmt::format("cosine {} is out of range; allowed: (0, 1]", mu));
            }
        }
    }
}

std::vector<double> sine_squared_cosines(int intervals) {
    std::vector<double> cosines;
    for (int k = 1; k <= intervals; ++k) {
        const double sine = std::sin(std::numbers::pi * k / (2.0 * intervals));
        cosines.push_back(k == intervals ? 1.0 : sine * sine);
    }
    return cosines;
}

std::vector<double> equally_spaced(double first, double last, int count) {
    std::vector<double> numbers;
    numbers.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        numbers.push_back(count == 1 ? first : first + (last - first) * i / (count - 1));
    }
    return numbers;
}

std::vector<double> tabulate(const BrdfSource& source, const TableGrid& grid,
                             const RunControl& control) {
    validate(grid);
    const std::size_t channels = source.channels().size();
    const std::size_t rows = grid.mu_out.size() * grid.azimuth_deg.size();
    std::vector<double> table(channels * grid.size());
    run_parallel("table", grid.mu_in.size(), control, [&](std::size_t i) {
        std::vector<Direction> directions;
        directions.reserve(rows);
        for (const double mu_out : grid.mu_out) {
            for (const double azimuth : grid.azimuth_deg) {
                directions.push_back({grid.mu_in[i], mu_out, azimuth});
            }
        }
        std::vector<double> values(rows * channels);
        source.evaluate(directions, values);
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < channels; ++c) {
                table[c * grid.size() + i * rows + r] = values[r * channels + c];
            }
        }
    });
    return table;
}

}  // namespace miebrdf::exports
