#include "pipeline/measured/spectra_in_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "pipeline/measured/columns.h"

namespace miebrdf::measured {
namespace {

std::size_t first_wavelength(const Sheet& sheet) {
    std::size_t first = sheet.names.size();
    while (first > 0 && wavelength_in_name(sheet.names[first - 1])) --first;
    return first;
}

/// Columns that name samples: those that say so, else those with words in them, else all.
std::vector<std::size_t> naming_columns(const Sheet& sheet, std::size_t first) {
    std::vector<std::size_t> all, say, words;
    for (std::size_t c = 0; c < first; ++c) {
        all.push_back(c);
        if (column_role(sheet.names[c]).role == Role::sample) say.push_back(c);
        if (std::any_of(sheet.rows.begin(), sheet.rows.end(), [&](const SheetRow& row) {
                return !row.cells[c].number && !row.cells[c].is_missing;
            }))
            words.push_back(c);
    }
    if (!say.empty()) {
        words.insert(words.end(), say.begin(), say.end());
        std::sort(words.begin(), words.end());
        words.erase(std::unique(words.begin(), words.end()), words.end());
    }
    return words.empty() ? all : words;
}

}  // namespace

bool has_directions(const Sheet& sheet) {
    const auto end = sheet.names.begin() + std::ptrdiff_t(first_wavelength(sheet));
    return std::any_of(sheet.names.begin(), end, [](const std::string& name) {
        const ColumnRole column = column_role(name);
        return column.is_axis() && column.role != Role::wavelength;
    });
}

Sheet one_value_a_line(const Sheet& sheet) {
    const std::size_t first = first_wavelength(sheet);
    Sheet lines;
    lines.names.assign(sheet.names.begin(), sheet.names.begin() + std::ptrdiff_t(first));
    lines.names.insert(lines.names.end(), {"wavelength_nm", "value"});
    lines.names_line = sheet.names_line;
    lines.remarks = sheet.remarks;
    for (const SheetRow& row : sheet.rows) {
        for (std::size_t c = first; c < sheet.names.size(); ++c) {
            SheetRow line{row.line, {row.cells.begin(), row.cells.begin() + std::ptrdiff_t(first)}};
            line.cells.push_back({sheet.names[c], wavelength_in_name(sheet.names[c])});
            line.cells.push_back(row.cells[c]);
            lines.rows.push_back(std::move(line));
        }
    }
    return lines;
}

Measurements read_spectra_in_rows(const MeasuredFile& file, const Sheet& sheet,
                                  const MeasuredOptions& options) {
    Measurements list;
    const std::size_t first = first_wavelength(sheet);
    const std::vector<std::size_t> naming = naming_columns(sheet, first);
    bool percent = sheet.says_percent();
    std::size_t missing = 0;
    int first_missing = 0;
    double largest = 0.0;
    for (const SheetRow& row : sheet.rows) {
        for (std::size_t c = first; c < row.cells.size(); ++c)
            largest = std::max(largest, row.cells[c].number.value_or(0.0));
    }
    percent = percent && largest > 2.0;
    for (std::size_t c = first; c < sheet.names.size(); ++c)
        percent = percent || says_percent(sheet.names[c]);
    const double factor = share_factor(list, options, percent, "as the file says");
    for (const SheetRow& row : sheet.rows) {
        std::string name;
        for (const std::size_t c : naming) {
            if (row.cells[c].text.empty()) continue;
            name += (name.empty() ? "" : " ") + row.cells[c].text;
        }
        if (name.empty()) name = fmt::format("row {}", list.samples.size() + 1);
        std::vector<double> nm, values;
        for (std::size_t c = first; c < sheet.names.size(); ++c) {
            const SheetCell& cell = row.cells[c];
            if (!cell.number) {
                if (!cell.is_missing) {
                    refuse(file, row.line,
                           fmt::format("'{}' at {} is not a number", cell.text, sheet.names[c]));
                }
                if (missing++ == 0) first_missing = row.line;
                continue;
            }
            nm.push_back(*wavelength_in_name(sheet.names[c]));
            values.push_back(*cell.number * (cell.is_percent ? 1.0 : factor));
        }
        NamedGeometry geometry = geometry_in(name);
        // A cell of its own may say it: "SCI".
        for (std::size_t c = 0; c < first; ++c) {
            const ColumnRole role = column_role(row.cells[c].text);
            if (role.kind && role.kind->geometry != MeasuredGeometry::unknown)
                geometry.geometry = role.kind->geometry;
        }
        add_spectrum(list, name, {MeasuredQuantity::reflectance, geometry.geometry}, geometry.mu_in,
                     nm, values, std::vector<int>(nm.size(), row.line));
    }
    if (missing > 0) {
        list.doubts.push_back(fmt::format("{}:{}: {} field{} without a number, left out", file.path,
                                          first_missing, missing, missing > 1 ? "s" : ""));
    }
    return list;
}

}  // namespace miebrdf::measured
