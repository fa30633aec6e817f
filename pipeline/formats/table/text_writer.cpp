// csv and json: tables for spreadsheets, browsers and scripts. docs/formats/table.md
#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

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

/// `wavelength_nm,mu_in,mu_out,azimuth_deg,brdf`, one row for each value, metadata in '#' lines.
void write_csv(const ExportJob& job, std::ostream& out) {
    const BrdfSource& source = job.spectral;
    const rte::Directions grid = table_directions(job.options);
    const std::vector<double> table = tabulate(source, grid, job.control);
    const auto facts = text_metadata(source, "csv");
    for (const auto& [name, value] : facts.items()) {
        out << "# " << name << ": "
            << one_line(value.is_string() ? value.get<std::string>() : value.dump()) << '\n';
    }
    out << "wavelength_nm,mu_in,mu_out,azimuth_deg,brdf\n";
    std::size_t index = 0;
    for (const double wavelength : source.wavelength_nm()) {
        for (const double mu_in : grid.mu_in) {
            fmt::memory_buffer lines;
            for (const double mu_out : grid.mu_out) {
                for (const double azimuth : grid.azimuth_deg) {
                    fmt::format_to(std::back_inserter(lines), "{},{},{},{},{}\n", wavelength, mu_in,
                                   mu_out, azimuth, table[index++]);
                }
            }
            out.write(lines.data(), static_cast<std::streamsize>(lines.size()));
        }
    }
}

/// One object: metadata, the four axes, and "brdf" nested in their order.
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
    out << ",\n\"brdf\": [";
    const std::size_t row = grid.azimuth_deg.size();
    auto next = table.begin();
    for (std::size_t w = 0; w < source.wavelength_nm().size(); ++w) {
        out << (w == 0 ? "\n[" : ",\n[");
        for (std::size_t i = 0; i < grid.mu_in.size(); ++i) {
            out << (i == 0 ? "[" : ",\n [");
            for (std::size_t o = 0; o < grid.mu_out.size(); ++o) {
                const auto last = next + static_cast<std::ptrdiff_t>(row);
                out << (o == 0 ? "" : ",\n  ") << fmt::format("[{}]", fmt::join(next, last, ","));
                next = last;
            }
            out << ']';
        }
        out << ']';
    }
    out << "]}\n";
}

}  // namespace

Format csv_format() { return table_format("csv", "spreadsheets", ".csv", write_csv, csv_reader()); }

Format json_format() {
    return table_format("json", "browsers and scripts", ".json", write_json, json_reader());
}

}  // namespace miebrdf
