// Our own CSV and JSON tables.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "pipeline/formats/common/grid_file.h"
#include "pipeline/formats/common/text_lines.h"

namespace miebrdf {
namespace {

constexpr std::string_view kHeader = "wavelength_nm,mu_in,mu_out,azimuth_deg,brdf";
/// Begins tables of Mueller matrices, whose element 11 is the BRDF; more columns follow.
constexpr std::string_view kMuellerHeader = "wavelength_nm,mu_in,mu_out,azimuth_deg,m11,m12";
/// A parsed JSON number takes 16 bytes and can be written in two: larger files take too much
/// memory.
constexpr std::size_t kLargestJson = std::size_t{512} << 20;

std::vector<double> number_list(const nlohmann::json& json, const char* name) {
    const auto found = json.find(name);
    if (found == json.end() || !found->is_array())
        throw InputError(fmt::format("json: no list '{}'", name));
    std::vector<double> numbers;
    for (const auto& element : *found) {
        if (!element.is_number())
            throw InputError(fmt::format("json: '{}' has something that is no number", name));
        numbers.push_back(element.get<double>());
    }
    return numbers;
}

/// The numbers of nested lists of known lengths, in order.
void flatten(const nlohmann::json& json, std::span<const std::size_t> shape,
             std::vector<double>& values) {
    if (shape.empty()) {
        if (!json.is_number()) throw InputError("json: 'brdf' has something that is no number");
        values.push_back(json.get<double>());
        return;
    }
    if (!json.is_array() || json.size() != shape[0]) {
        throw InputError(
            fmt::format("json: 'brdf' is not nested as its axes; expected a list of {}", shape[0]));
    }
    for (const auto& element : json) flatten(element, shape.subspan(1), values);
}

/// The JSON of `miebrdf brdf`: columns by name, one list of numbers for each direction.
std::unique_ptr<BrdfFile> read_json_rows(const nlohmann::json& json) {
    const auto& columns = json["columns"];
    const auto& rows = json["rows"];
    if (!columns.is_array() || !rows.is_array())
        throw InputError("json: 'columns' and 'rows' are lists");
    std::array<std::size_t, 5> places{};
    const char* const names[] = {"wavelength_nm", "mu_in", "mu_out", "azimuth_deg", "brdf"};
    for (std::size_t k = 0; k < places.size(); ++k) {
        auto found = std::find(columns.begin(), columns.end(), names[k]);
        if (found == columns.end() && k == 4)  // of a Mueller matrix
            found = std::find(columns.begin(), columns.end(), "m11");
        if (found == columns.end()) {
            throw InputError(
                fmt::format("json: no column '{}'; a table of a BRDF has {}", names[k], kHeader));
        }
        places[k] = static_cast<std::size_t>(found - columns.begin());
    }
    GridCollector collector("json", 1, rows.size());
    for (const auto& row : rows) {
        std::array<double, 5> v{};
        for (std::size_t k = 0; k < places.size(); ++k) {
            if (!row.is_array() || row.size() != columns.size() || !row[places[k]].is_number()) {
                throw InputError(
                    fmt::format("json: a row is no list of {} numbers", columns.size()));
            }
            v[k] = row[places[k]].get<double>();
        }
        collector.add(v[0], v[1], v[2], v[3], {&v[4], 1});
    }
    return make_grid_file(std::move(collector).table(Elevation::cosine));
}

Recognised recognise_csv(std::string_view content) {
    const std::string_view start = content.substr(0, 65536);
    const bool found =
        start.find(kHeader) != start.npos || start.find(kMuellerHeader) != start.npos;
    return found ? Recognised::by_structure : Recognised::no;
}

std::unique_ptr<BrdfFile> read_csv(std::string content) {
    TextLines lines(content, "csv");
    GridCollector rows("csv", 1, content.size() / 64);  // a line of ours has about 60 bytes
    std::size_t columns = 0;                            // 0: no header yet
    for (std::string_view line; lines.next(line);) {
        if (line.empty() || line[0] == '#') continue;
        if (columns == 0) {
            if (line != kHeader && !line.starts_with(kMuellerHeader))
                lines.refuse(fmt::format("expected the header '{}'", kHeader));
            columns = 1 + static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
            continue;
        }
        const std::vector<double> row = lines.numbers(line, ",");
        if (row.size() != columns)
            lines.refuse(fmt::format("{} fields; expected {}", row.size(), columns));
        rows.add(row[0], row[1], row[2], row[3], {&row[4], 1});
    }
    return make_grid_file(std::move(rows).table(Elevation::cosine));
}

Recognised recognise_json(std::string_view content) {
    const std::size_t first = content.find_first_not_of(" \t\r\n");
    const bool found = first != content.npos && content[first] == '{';
    return found ? Recognised::by_first_bytes : Recognised::no;
}

std::unique_ptr<BrdfFile> read_json(std::string content) {
    if (content.size() > kLargestJson) {
        throw InputError(
            fmt::format("json: {} bytes; allowed: at most {}", content.size(), kLargestJson));
    }
    const auto json = nlohmann::json::parse(content, nullptr, false);
    if (json.is_discarded() || !json.is_object())
        throw InputError("json: this is no valid JSON object");
    if (json.contains("columns") && json.contains("rows")) return read_json_rows(json);
    GridTable table;
    table.format = "json";
    table.wavelength_nm = number_list(json, "wavelength_nm");
    table.in = number_list(json, "mu_in");
    table.out = number_list(json, "mu_out");
    table.azimuth_deg = number_list(json, "azimuth_deg");
    const std::size_t shape[] = {table.wavelength_nm.size(), table.in.size(), table.out.size(),
                                 table.azimuth_deg.size()};
    if (!json.contains("brdf")) throw InputError("json: no list 'brdf'");
    std::vector<double> values;
    flatten(json["brdf"], shape, values);
    table.set_values(std::move(values));
    return make_grid_file(std::move(table));
}

}  // namespace

FormatReader csv_reader() { return {recognise_csv, read_csv}; }
FormatReader json_reader() { return {recognise_json, read_json}; }

}  // namespace miebrdf
