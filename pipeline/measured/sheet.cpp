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

/// "Wavelength Range: 350": a word about the measurement, with its value.
bool says_something_of(const std::string& field) {
    const std::size_t mark = field.find_first_of(":=");
    return mark != std::string::npos &&
           !materials::without_blanks(std::string_view(field).substr(mark + 1)).empty() &&
           field.find("45:0") == std::string::npos;
}

bool is_number(const std::string& field) { return materials::table_number(field).has_value(); }

/// A line of names has wavelengths or a direction. Samples may be numbers beside wavelengths alone:
/// "SZA,45" says one angle of all.
bool names_columns(const std::vector<std::string>& fields) {
    if (wavelengths_at_end(fields) >= kFewestWavelengths) return true;
    bool axis = false, wavelengths = false;
    for (const std::string& name : fields) {
        const ColumnRole column = column_role(name);
        axis = axis || column.is_axis();
        wavelengths = wavelengths || column.role == Role::wavelength;
    }
    // "Instrument: Lambda 1050", where blanks separate.
    const bool has_key = std::any_of(fields.begin(), fields.end(), [&](const std::string& field) {
        return field.ends_with(':') && &field != &fields.back();
    });
    return axis && !has_key && std::none_of(fields.begin(), fields.end(), says_something_of) &&
           (wavelengths || std::none_of(fields.begin(), fields.end(), is_number));
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
            const bool is_one_of_all = wavelengths_at_end(fields) < kFewestWavelengths &&
                                       std::any_of(fields.begin(), fields.end(), is_number);
            if ((below == count && !is_one_of_all) || has_blank_name || numbers) {
                table.take_names();
                return true;
            }
        }
        sheet.remarks.push_back(fmt::format("{}", fmt::join(fields, " ")));
        sheet.above = std::move(fields);
    }
    return false;
}

/// JASCO's texts name both columns by "XUNITS" and "YUNITS" above a line "XYDATA", to which the
/// table goes.
bool find_named_units(TextTable& table, Sheet& sheet) {
    std::string x, y;
    while (table.next() && !is_number(table.fields()[0])) {
        const std::vector<std::string>& fields = table.fields();
        if (fields[0] == "XYDATA" && fields.size() == 1 && !x.empty() && !y.empty()) {
            sheet.names = {x, y};
            return true;
        }
        const std::string text = fmt::format("{}", fmt::join(fields, " "));
        if (fields.size() > 1 && fields[0] == "XUNITS") x = text.substr(7);
        if (fields.size() > 1 && fields[0] == "YUNITS") y = text.substr(7);
        sheet.remarks.push_back(text);
    }
    sheet.remarks.clear();
    return false;
}

/// A line above numbers without names that is about the measurement: "% Date: ...", "SZA,45", a
/// title. Two words may name columns, of which nothing is known.
bool is_remark(const TextTable& table) {
    const std::vector<std::string>& fields = table.fields();
    if (is_number(fields[0])) return false;
    return table.content().find_first_of("%!/*;") == 0 || fields.size() == 1 ||
           std::any_of(fields.begin(), fields.end(), says_something_of) ||
           std::any_of(fields.begin(), fields.end(), is_number);
}

/// The units of all columns, in a line below their names: "[nm];[counts]", "nm,%".
bool is_line_of_units(const std::vector<std::string>& fields) {
    const auto is_unit = [](const std::string& field) {
        return field.empty() || field == "%" || field.front() == '[' || field.front() == '(' ||
               materials::parse_unit(field).has_value();
    };
    return !fields.front().empty() && std::all_of(fields.begin(), fields.end(), is_unit);
}

/// The column that says where the values of a row belong.
std::size_t axis_column(const Sheet& sheet) {
    if (sheet.names_are_wavelengths) return sheet.names.size() - wavelengths_at_end(sheet.names);
    const auto is_axis = [](const std::string& name) { return column_role(name).is_axis(); };
    const auto found = std::find_if(sheet.names.begin(), sheet.names.end(), is_axis);
    return found == sheet.names.end() ? 0 : std::size_t(found - sheet.names.begin());
}

/// The last line with a number in that column: below it there are only words, as programs write
/// them about the measurement.
int last_line_of_numbers(TextTable table, std::size_t axis) {
    int last = 0;
    while (table.next()) {
        if (table.fields().size() > axis && is_number(table.fields()[axis])) last = table.line();
    }
    return last;
}

/// The fields of a line without names whose empty fields are lost where blanks separate: split at
/// tabs or commas, or with an empty one at its end.
std::vector<std::string> with_empty_fields(const TextTable& table, std::size_t expected) {
    std::vector<std::string> fields = table.fields();
    for (const char separator : {'\t', ','}) {
        auto split = materials::split_fields(table.content(), separator);
        if (split.size() == expected) return split;
    }
    if (fields.size() + 1 == expected && table.ends_with_blank()) fields.emplace_back();
    return fields;
}

/// Names of samples are text, whatever they look like: "1,5".
SheetCell cell_of(TextTable& table, const std::string& text, bool is_name) {
    SheetCell cell{text};
    cell.is_missing = says_missing(text);
    if (is_name || cell.is_missing || !materials::table_number(text)) return cell;
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

ValueMeaning Sheet::meaning() const {
    static constexpr std::string_view kKeys[] = {"y axis",
                                                 "y units",
                                                 "yunits",
                                                 "y-axis",
                                                 "ordinate",
                                                 "data type",
                                                 "measurement type",
                                                 "measurement mode",
                                                 "photometric mode",
                                                 "mode",
                                                 "units",
                                                 "unit",
                                                 "quantity",
                                                 "data"};
    for (const std::string& remark : remarks) {
        const std::size_t mark = remark.find_first_of(":=");
        const std::string key = lower_case(remark.substr(0, mark));
        if (mark == std::string::npos ||
            std::find(std::begin(kKeys), std::end(kKeys), key) == std::end(kKeys))
            continue;
        if (const auto meaning = value_meaning(without_blanks(remark).substr(mark + 1)))
            return *meaning;
    }
    return {};
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
    if (text.starts_with('%')) text = lower_case(text.substr(1));  // "%T"
    text.erase(std::min(text.find_first_of("([{%"), text.size()));
    text = lower_case(text);
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == ' ' || c == '-' || c == '.'; }, '_');
    for (const std::string_view unit :
         {"_deg", "_degree", "_degrees", "_rad", "_radian", "_radians", "_percent", "_pct"}) {
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
    if (find_named_units(table, sheet)) {
        sheet.names_line = table.line();
    } else if (table = TextTable(file.content, file.path);
               find_names(table, sheet, has_blank_name)) {
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
    const std::size_t axis = axis_column(sheet);
    const int last_numbers = last_line_of_numbers(table, axis);
    std::size_t cells = 0;
    std::vector<bool> is_name;
    while (table.next()) {
        std::vector<std::string> fields = table.fields();
        if (sheet.names.empty() && sheet.rows.empty() && is_remark(table)) {
            sheet.remarks.push_back(fmt::format("{}", fmt::join(fields, " ")));
            continue;
        }
        const std::size_t expected = !sheet.names.empty()  ? sheet.names.size()
                                     : !sheet.rows.empty() ? sheet.rows.front().cells.size()
                                                           : fields.size();
        while (fields.size() > expected && fields.back().empty()) fields.pop_back();
        if (sheet.rows.empty() && fields.size() <= sheet.names.size() && is_line_of_units(fields)) {
            for (std::size_t c = 0; c < fields.size(); ++c) {
                if (fields[c].empty()) continue;
                const bool is_open = fields[c].front() == '[' || fields[c].front() == '(';
                sheet.names[c] += is_open ? " " + fields[c] : " [" + fields[c] + "]";
            }
            continue;
        }
        // Words below the numbers are about the measurement.
        const bool has_words = fields.size() != expected || !says_missing(fields[axis]);
        if (table.line() > last_numbers && has_words && !sheet.rows.empty()) {
            sheet.remarks.push_back(fmt::format("{}", fmt::join(fields, " ")));
            if (sheet.lines_below++ == 0) sheet.first_below = table.line();
            continue;
        }
        if (fields.size() != expected && sheet.names.empty())
            fields = with_empty_fields(table, expected);
        if (fields.size() != expected) {
            table.refuse(
                fmt::format("{} fields; the lines above have {}. Decimal commas need semicolons "
                            "between the fields; a file may be cut off",
                            fields.size(), expected));
        }
        materials::ReadingBudget::require_values(cells += fields.size(), file.path, table.line());
        while (is_name.size() < fields.size()) {
            const std::size_t c = is_name.size();
            is_name.push_back(c < sheet.names.size() &&
                              column_role(sheet.names[c]).role == Role::sample);
        }
        SheetRow row{table.line()};
        row.cells.reserve(fields.size());
        for (std::size_t c = 0; c < fields.size(); ++c)
            row.cells.push_back(cell_of(table, fields[c], is_name[c]));
        sheet.rows.push_back(std::move(row));
    }
    sheet.remarks.insert(sheet.remarks.end(), table.comments().begin(), table.comments().end());
    return sheet;
}

}  // namespace miebrdf::measured
