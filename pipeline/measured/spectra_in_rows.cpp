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

Sheet first_value_of_rows(const Sheet& sheet) {
    const std::size_t first = first_wavelength(sheet);
    const auto end = std::ptrdiff_t(first);
    Sheet lines;
    lines.names.assign(sheet.names.begin(), sheet.names.begin() + end);
    lines.names.insert(lines.names.end(), {"wavelength_nm", "value"});
    lines.names_line = sheet.names_line;
    lines.remarks = sheet.remarks;
    for (const SheetRow& row : sheet.rows) {
        SheetRow& line = lines.rows.emplace_back(
            SheetRow{row.line, {row.cells.begin(), row.cells.begin() + end}});
        line.cells.push_back({sheet.names[first], wavelength_in_name(sheet.names[first])});
        line.cells.push_back(row.cells[first]);
    }
    return lines;
}

/// What the values of a row are: a cell says it ("SCI", "transmittance" under "type"), or nothing.
std::optional<ValueMeaning> meaning_of_row(const Sheet& sheet, const SheetRow& row,
                                           std::size_t first) {
    static constexpr std::string_view kNames[] = {"quantity", "mode",      "type",    "measurement",
                                                  "measured", "component", "specular"};
    std::optional<ValueMeaning> meaning;
    for (std::size_t c = 0; c < first; ++c) {
        const auto said = value_meaning(row.cells[c].text);
        if (!said) continue;
        const std::string name = bare_name(sheet.names[c]);
        const bool is_asked =
            std::find(std::begin(kNames), std::end(kNames), name) != std::end(kNames);
        if (is_asked || said->kind.geometry != MeasuredGeometry::unknown) meaning = said;
    }
    return meaning;
}

Measurements read_spectra_in_rows(const MeasuredFile& file, const Sheet& sheet,
                                  const MeasuredOptions& options) {
    Measurements list;
    const std::size_t first = first_wavelength(sheet);
    const std::vector<std::size_t> naming = naming_columns(sheet, first);
    bool percent = sheet.says_percent();
    double largest = 0.0;
    for (const SheetRow& row : sheet.rows) {
        for (std::size_t c = first; c < row.cells.size(); ++c)
            largest = std::max(largest, row.cells[c].number.value_or(0.0));
    }
    percent = percent && largest > 2.0;
    std::vector<double> nm;
    for (std::size_t c = first; c < sheet.names.size(); ++c) {
        percent = percent || says_percent(sheet.names[c]);
        nm.push_back(*wavelength_in_name(sheet.names[c]));
    }
    const double factor = share_factor(list, options, percent, "as the file says");
    const ValueMeaning of_all = sheet.meaning();
    for (const SheetRow& row : sheet.rows) {
        std::string name;
        for (const std::size_t c : naming) {
            if (row.cells[c].text.empty()) continue;
            name += (name.empty() ? "" : " ") + row.cells[c].text;
        }
        if (name.empty()) name = fmt::format("row {}", list.samples.size() + 1);
        ValueMeaning meaning = meaning_of_row(sheet, row, first).value_or(of_all);
        if (!meaning.refused.empty() && options.quantity.empty())
            refuse(file, row.line, refusal_of(name, meaning.refused));
        std::vector<double> values;
        for (std::size_t c = first; c < sheet.names.size(); ++c) {
            const SheetCell& cell = row.cells[c];
            if (!cell.number && !cell.is_missing) {
                refuse(file, row.line,
                       fmt::format("'{}' at {} is not a number", cell.text, sheet.names[c]));
            }
            const double number = cell.number.value_or(MeasuredValue::kNone);
            values.push_back(meaning.conversion != Conversion::none
                                 ? converted(number, meaning.conversion)
                                 : number * (cell.is_percent ? 1.0 : factor));
        }
        const NamedGeometry geometry = geometry_in(name);
        if (meaning.kind.geometry == MeasuredGeometry::unknown)
            meaning.kind.geometry = geometry.geometry;
        add_spectrum(list, name, meaning.kind, geometry.mu_in, nm, values,
                     std::vector<int>(nm.size(), row.line));
    }
    return list;
}

}  // namespace miebrdf::measured
