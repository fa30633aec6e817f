// csv and json: tables for spreadsheets, browsers and scripts. docs/formats/table.md
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "pipeline/formats/table/tabulate.h"

namespace miebrdf {

FormatReader csv_reader();  // text_reader.cpp
FormatReader json_reader();

namespace {

nlohmann::ordered_json text_metadata(const BrdfSource& source, const char* format) {
    return metadata(
        source,
        {.format = format, .cosine_included = false, .azimuth_zero = "mirror side", .colour = ""});
}

void write_number_list(const std::vector<double>& numbers, std::ostream& out) {
    out << fmt::format("[{}]", fmt::join(numbers, ","));
}

/// Degree of linear polarisation, and the angle from the meridian plane in degrees, of what is
/// reflected of unpolarised light.
std::array<double, 2> polarisation_of(const double* matrix, std::size_t components) {
    const double I = matrix[0], Q = matrix[components], U = matrix[2 * components];
    const double angle = 0.5 * std::atan2(U, Q) * 180.0 / std::numbers::pi;
    return {I > 0.0 ? std::hypot(Q, U) / I : 0.0, angle < 0.0 ? angle + 180.0 : angle};
}

/// `wavelength_nm,mu_in,mu_out,azimuth_deg,brdf`, one row for each value, metadata in '#' lines; of
/// a source that knows its Mueller matrix m11, m12, ..., dolp, aolp_deg in place of brdf.
void write_csv(const ExportJob& job, std::ostream& out) {
    const BrdfSource& source = job.spectral;
    const rte::Directions grid = table_directions(job.options);
    const auto components = static_cast<std::size_t>(source.components());
    const std::size_t elements = components * components;
    const bool polarised = components > 1;
    const std::vector<double> table = polarised ? tabulate_mueller(source, grid, job.control)
                                                : tabulate(source, grid, job.control);
    const auto facts = text_metadata(source, "csv");
    for (const auto& [name, value] : facts.items()) {
        out << "# " << name << ": "
            << one_line(value.is_string() ? value.get<std::string>() : value.dump()) << '\n';
    }
    out << "wavelength_nm,mu_in,mu_out,azimuth_deg,";
    if (polarised) {
        out << fmt::format("{},dolp,aolp_deg\n",
                           fmt::join(mueller_names(source.components()), ","));
    } else {
        out << "brdf\n";
    }
    std::size_t index = 0;
    for (const double wavelength : source.wavelength_nm()) {
        for (const double mu_in : grid.mu_in) {
            fmt::memory_buffer lines;
            for (const double mu_out : grid.mu_out) {
                for (const double azimuth : grid.azimuth_deg) {
                    const double* const first = table.data() + elements * index++;
                    fmt::format_to(std::back_inserter(lines), "{},{},{},{},{}", wavelength, mu_in,
                                   mu_out, azimuth, fmt::join(first, first + elements, ","));
                    if (polarised) {
                        fmt::format_to(std::back_inserter(lines), ",{}",
                                       fmt::join(polarisation_of(first, components), ","));
                    }
                    lines.push_back('\n');
                }
            }
            out.write(lines.data(), static_cast<std::streamsize>(lines.size()));
        }
    }
}

/// Numbers as nested lists of these lengths, line by line but for the last two axes.
const double* write_nested(const double* next, std::span<const std::size_t> shape,
                           std::ostream& out) {
    if (shape.size() == 1) {
        out << fmt::format("[{}]", fmt::join(next, next + shape[0], ","));
        return next + shape[0];
    }
    for (std::size_t i = 0; i < shape[0]; ++i) {
        out << (i == 0 ? "[" : shape.size() > 2 ? ",\n" : ",");
        next = write_nested(next, shape.subspan(1), out);
    }
    out << ']';
    return next;
}

/// One object: metadata, the four axes, "brdf" nested in their order, and where it is known
/// "mueller", with rows and columns inside.
void write_json(const ExportJob& job, std::ostream& out) {
    const BrdfSource& source = job.spectral;
    const rte::Directions grid = table_directions(job.options);
    const std::vector<double> table = tabulate(source, grid, job.control);
    out << "{\"metadata\": " << text_metadata(source, "json").dump();
    out << ",\n\"wavelength_nm\": ";
    write_number_list(source.wavelength_nm(), out);
    out << ",\n\"mu_in\": ";
    write_number_list(grid.mu_in, out);
    out << ",\n\"mu_out\": ";
    write_number_list(grid.mu_out, out);
    out << ",\n\"azimuth_deg\": ";
    write_number_list(grid.azimuth_deg, out);
    std::vector<std::size_t> shape = {source.wavelength_nm().size(), grid.mu_in.size(),
                                      grid.mu_out.size(), grid.azimuth_deg.size()};
    out << ",\n\"brdf\": ";
    write_nested(table.data(), shape, out);
    if (source.components() > 1) {
        const auto components = static_cast<std::size_t>(source.components());
        shape.insert(shape.end(), {components, components});
        out << ",\n\"mueller\": ";
        write_nested(tabulate_mueller(source, grid, job.control).data(), shape, out);
    }
    out << "}\n";
}

}  // namespace

Format csv_format() { return table_format("csv", "spreadsheets", ".csv", write_csv, csv_reader()); }

Format json_format() {
    return table_format("json", "browsers and scripts", ".json", write_json, json_reader());
}

}  // namespace miebrdf
