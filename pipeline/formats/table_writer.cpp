#include "pipeline/formats/table_writer.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "pipeline/formats/metadata.h"
#include "pipeline/formats/npz_writer.h"

namespace miebrdf::exports {
namespace {

nlohmann::ordered_json table_metadata(const BrdfSource& source, const char* format) {
    return metadata(
        source,
        {.format = format, .cosine_included = false, .azimuth_zero = "mirror side", .colour = ""});
}

std::string one_line(std::string text) {
    for (char& c : text) {
        if (c == '\n' || c == '\r') c = ' ';
    }
    return text;
}

void write_number_list(const std::vector<double>& numbers, std::ostream& out) {
    out << fmt::format("[{}]", fmt::join(numbers, ","));
}

}  // namespace

void write_table_csv(const BrdfSource& source, const TableGrid& grid, std::ostream& out,
                     const RunControl& control) {
    require_wavelengths(source, "csv");
    const std::vector<double> table = tabulate(source, grid, control);
    const auto facts = table_metadata(source, "csv");
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

void write_table_json(const BrdfSource& source, const TableGrid& grid, std::ostream& out,
                      const RunControl& control) {
    require_wavelengths(source, "json");
    const std::vector<double> table = tabulate(source, grid, control);
    out << "{\"metadata\": " << table_metadata(source, "json").dump();
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

void write_table_npz(const BrdfSource& source, const TableGrid& grid,
                     const std::filesystem::path& path, const RunControl& control) {
    require_wavelengths(source, "npz");
    NpzArchive archive;
    archive.add("wavelength_nm", source.wavelength_nm());
    archive.add("mu_in", grid.mu_in);
    archive.add("mu_out", grid.mu_out);
    archive.add("azimuth_deg", grid.azimuth_deg);
    archive.add("brdf", tabulate(source, grid, control),
                {source.wavelength_nm().size(), grid.mu_in.size(), grid.mu_out.size(),
                 grid.azimuth_deg.size()});
    archive.add_bytes("meta", table_metadata(source, "npz").dump(1));
    archive.write(path);
}

}  // namespace miebrdf::exports
