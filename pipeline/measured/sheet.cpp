#include "pipeline/measured/sheet.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"
#include "pipeline/measured/columns.h"

namespace miebrdf::measured {
namespace {

using materials::lower_case;
using materials::TextTable;
using materials::without_blanks;

/// As many columns named by wavelengths make a table of spectra in rows.
constexpr std::size_t kFewestWavelengths = 3;

bool is_missing(std::string_view text) {
    const std::string word = lower_case(text);
    return word.empty() || word == "nan" || word == "n/a" || word == "na" || word == "null" ||
           word == "-" || word == "inf" || word == "-inf";
}

/// How many fields at the end of a line of names are ascending wavelengths.
std::size_t wavelengths_at_end(const std::vector<std::string>& names) {
    std::size_t count = 0;
    double after = INFINITY;
    while (count < names.size()) {
        const auto nm = wavelength_in_name(names[names.size() - 1 - count]);
        if (!nm || !(*nm < after)) break;
        after = *nm;
        ++count;
    }
    return count;
}

bool names_columns(const std::vector<std::string>& fields) {
    if (wavelengths_at_end(fields) >= kFewestWavelengths) return true;
    const auto is_axis = [](const std::string& name) { return column_role(name).is_axis(); };
    return std::any_of(fields.begin(), fields.end(), is_axis);
}

/// Goes to the line of names, of which the next line has as many fields; false where none does.
/// Lines above it are remarks.
bool find_names(TextTable& table, Sheet& sheet, bool& has_blank_name) {
    while (table.next()) {
        std::vector<std::string> fields = table.fields();
        const std::size_t count = fields.size();
        while (!fields.empty() && fields.back().empty()) fields.pop_back();
        if (names_columns(fields)) {
            TextTable ahead = table;
            ahead.take_names();
            const bool any = ahead.next();
            const std::size_t below = any ? ahead.fields().size() : count;
            // A blank that names the column of samples is lost where tabs separate.
            has_blank_name =
                wavelengths_at_end(fields) == fields.size() && below == fields.size() + 1;
            const bool numbers = any && materials::table_number(ahead.fields().front());
            if (below == count || has_blank_name || numbers) {
                table.take_names();
                return true;
            }
        }
        sheet.remarks.push_back(fmt::format("{}", fmt::join(fields, " ")));
        sheet.above = std::move(fields);
    }
    return false;
}

/// Whether no line begins with a number any more: what programs write below their data.
bool only_words_follow(TextTable table) {
    while (table.next()) {
        if (materials::table_number(table.fields().front())) return false;
    }
    return true;
}

SheetCell cell_of(TextTable& table, const std::string& text) {
    SheetCell cell{text};
    cell.is_missing = is_missing(text);
    if (cell.is_missing || !materials::table_number(text)) return cell;
    cell.number = table.number(text);  // refuses decimal points mixed with commas
    cell.is_percent = text.ends_with('%');
    return cell;
}

}  // namespace

bool says_percent(std::string_view name) {
    const std::string text = lower_case(name);
    return text.find('%') != std::string::npos || text.find("percent") != std::string::npos ||
           text.find("pct") != std::string::npos;
}

bool Sheet::says_percent() const {
    return std::any_of(remarks.begin(), remarks.end(), [](const std::string& remark) {
        const std::string text = lower_case(remark);
        return text.find("in percent") != std::string::npos ||
               text.find("in %") != std::string::npos || text.find("(%)") != std::string::npos ||
               text.find("[%]") != std::string::npos || text == "%";
    });
}

std::optional<double> wavelength_in_name(std::string_view name) {
    static constexpr std::string_view kBefore[] = {
        "spectral_nm_", "spectral_nm", "spectral_", "spec_", "r_",    "r", "nm_",
        "nm",           "wl_",         "wl",        "x",     "refl_", ""};
    std::string text = lower_case(name);
    for (const std::string_view end : {"nm", "_nm", " "}) {
        if (text.ends_with(end)) text = lower_case(text.substr(0, text.size() - end.size()));
    }
    if (text.ends_with('_')) text.pop_back();
    for (const std::string_view before : kBefore) {
        if (!text.starts_with(before)) continue;
        const auto number = materials::table_number(std::string_view(text).substr(before.size()));
        // Ultraviolet to far infrared: other numbers in names are not wavelengths.
        if (number && *number >= 150.0 && *number <= 50000.0) return number;
    }
    return std::nullopt;
}

std::string bare_name(std::string_view name) {
    std::string text = lower_case(name);
    text.erase(std::min(text.find_first_of("([{%"), text.size()));
    text = lower_case(text);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == ' ' || c == '-' || c == '.'; }, '_');
    for (const std::string_view unit :
         {"_deg", "_degree", "_degrees", "_rad", "_percent", "_pct"}) {
        if (text.ends_with(unit)) text.erase(text.size() - unit.size());
    }
    while (text.ends_with('_')) text.pop_back();
    return text;
}

std::vector<std::string> sheet_names(const MeasuredFile& file) {
    TextTable table(file.content.substr(0, 200000), file.path);
    Sheet sheet;
    bool has_blank_name = false;
    if (!find_names(table, sheet, has_blank_name)) return {};
    return table.fields();
}

Sheet read_sheet(const MeasuredFile& file) {
    TextTable table(file.content, file.path);
    Sheet sheet;
    bool has_blank_name = false;
    if (find_names(table, sheet, has_blank_name)) {
        sheet.names = table.fields();
        // Spreadsheets end lines with separators.
        while (sheet.names.back().empty()) sheet.names.pop_back();
        sheet.names_line = table.line();
        sheet.names_are_wavelengths = wavelengths_at_end(sheet.names) >= kFewestWavelengths;
        if (has_blank_name) sheet.names.insert(sheet.names.begin(), "");
    } else {
        table = TextTable(file.content, file.path);
        sheet.remarks.clear();
    }
    while (table.next()) {
        std::vector<std::string> fields = table.fields();
        const std::size_t expected = sheet.names.empty() && !sheet.rows.empty()
                                         ? sheet.rows.front().cells.size()
                                     : sheet.names.empty() ? fields.size()
                                                           : sheet.names.size();
        while (fields.size() > expected && fields.back().empty()) fields.pop_back();
        if (fields.size() != expected) {
            if (!sheet.rows.empty() && !materials::table_number(fields.front()) &&
                only_words_follow(table)) {
                sheet.remarks.push_back(fmt::format("{}", fmt::join(fields, " ")));
                continue;
            }
            table.refuse(
                fmt::format("{} fields; the lines above have {}. Decimal commas need semicolons "
                            "between the fields; a file may be cut off",
                            fields.size(), expected));
        }
        SheetRow row{table.line()};
        for (const std::string& field : fields) row.cells.push_back(cell_of(table, field));
        sheet.rows.push_back(std::move(row));
    }
    sheet.remarks.insert(sheet.remarks.end(), table.comments().begin(), table.comments().end());
    return sheet;
}

}  // namespace miebrdf::measured
