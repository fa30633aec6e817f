#include "pipeline/formats/table/tabulate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/solve/parallel.h"

namespace miebrdf {

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

rte::Directions table_directions(const ExportOptions& options) {
    rte::Directions directions = options.directions;
    if (directions.mu_in.empty()) directions.mu_in = sine_squared_cosines(options.resolution);
    if (directions.mu_out.empty()) directions.mu_out = sine_squared_cosines(options.resolution);
    if (directions.azimuth_deg.empty()) {
        directions.azimuth_deg = equally_spaced(0.0, 180.0, options.resolution + 3);
    }
    for (const auto& [field, cosines] :
         {std::pair{"mu_in", &directions.mu_in}, std::pair{"mu_out", &directions.mu_out}}) {
        for (const double mu : *cosines) {
            if (!(mu > 0.0 && mu <= 1.0)) throw UsageError(field, mu, "(0, 1]");
        }
    }
    return directions;
}

std::size_t size_of(const rte::Directions& directions) {
    return directions.mu_in.size() * directions.mu_out.size() * directions.azimuth_deg.size();
}

namespace {

/// [channel][mu_in][mu_out][azimuth][number] of `numbers` for each direction and channel.
template <typename Evaluate>
std::vector<double> tabulate_numbers(std::size_t channels, std::size_t numbers,
                                     const rte::Directions& grid, const Control& control,
                                     const Evaluate& evaluate) {
    const std::size_t rows = grid.mu_out.size() * grid.azimuth_deg.size();
    const std::size_t size = size_of(grid);
    std::vector<double> table(channels * size * numbers);
    run_parallel("table", grid.mu_in.size(), control, [&](std::size_t i) {
        std::vector<Direction> directions;
        directions.reserve(rows);
        for (const double mu_out : grid.mu_out) {
            for (const double azimuth : grid.azimuth_deg) {
                directions.push_back({grid.mu_in[i], mu_out, azimuth});
            }
        }
        std::vector<double> values(rows * channels * numbers);
        evaluate(directions, values);
        for (std::size_t r = 0; r < rows; ++r) {
            for (std::size_t c = 0; c < channels; ++c) {
                std::copy_n(&values[(r * channels + c) * numbers], numbers,
                            &table[(c * size + i * rows + r) * numbers]);
            }
        }
    });
    return table;
}

}  // namespace

std::vector<double> tabulate(const BrdfSource& source, const rte::Directions& grid,
                             const Control& control) {
    return tabulate_numbers(source.channels().size(), 1, grid, control,
                            [&](std::span<const Direction> directions, std::span<double> values) {
                                source.evaluate(directions, values);
                            });
}

std::vector<double> tabulate_mueller(const BrdfSource& source, const rte::Directions& grid,
                                     const Control& control) {
    if (source.components() == 1) return {};
    const auto elements = static_cast<std::size_t>(source.components() * source.components());
    return tabulate_numbers(source.channels().size(), elements, grid, control,
                            [&](std::span<const Direction> directions, std::span<double> values) {
                                source.evaluate_mueller(directions, values);
                            });
}

std::vector<std::string> mueller_names(int components) {
    std::vector<std::string> names;
    for (int row = 1; row <= components; ++row) {
        for (int column = 1; column <= components; ++column)
            names.push_back(fmt::format("m{}{}", row, column));
    }
    return names;
}

Format table_format(const char* name, const char* readers, const char* ending,
                    void (*write)(const ExportJob& job, std::ostream& out),
                    const FormatReader& reader) {
    constexpr int kCosines = 16, kMostCosines = 4096;
    return {.name = name,
            .readers = readers,
            .holds = "every wavelength, any directions, exact",
            .endings = {ending},
            .content = FormatContent::table,
            .resolution = {"cosines", kCosines, 1, kMostCosines, kMostCosines},
            .takes_directions = true,
            .files = {{.write = write}},
            .reader = reader};
}

}  // namespace miebrdf
