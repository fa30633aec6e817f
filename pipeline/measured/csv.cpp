// Tables: spectra in columns or in rows, one value a line, goniometers' lists of directions, and
// what this program writes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "materials/readers/text.h"
#include "pipeline/measured/azimuth.h"
#include "pipeline/measured/columns.h"
#include "pipeline/measured/sheet.h"
#include "pipeline/measured/spectra_in_rows.h"

namespace miebrdf::measured {
namespace {

using materials::lower_case;

/// Wavelengths of a column without a unit: numbers below are micrometres, above nanometres.
constexpr double kLeastNm = 100.0;

struct ValueColumn {
    std::size_t index = 0;
    std::string name;
    std::optional<MeasuredKind> kind;  ///< nothing: the rows say it, or the options
    bool times_mu_out = false;
    double factor = 1.0;
    std::optional<std::size_t> sigma = {}, wavelength = {};
};

/// A table whose lines have one wavelength or direction each.
class LongTable {
  public:
    LongTable(const MeasuredFile& file, Sheet sheet, const MeasuredOptions& options)
        : file_(file), sheet_(std::move(sheet)), options_(options) {
        for (std::size_t c = 0; c < sheet_.names.size(); ++c)
            roles_.push_back(column_role(sheet_.names[c]));
        // `phi` beside the azimuth of reflection is that of incidence.
        if (find(Role::phi_out) && !find(Role::phi_in)) {
            for (ColumnRole& column : roles_) {
                if (column.role == Role::phi) column.role = Role::phi_in;
            }
        }
    }

    Measurements read() {
        choose_columns();
        find_sigmas();
        find_units();
        for (ValueColumn& column : columns_) {
            const bool says = says_percent(sheet_.names[column.index]) ||
                              (sheet_.says_percent() && is_large(column));
            column.factor = share_factor(list_, options_, says, column.name);
        }
        drop_repeated_facts();
        for (const SheetRow& row : sheet_.rows) read_row(row);
        if (!raw_.empty()) set_directions(list_, raw_, options_, file_);
        if (list_.values.empty()) refuse(file_, first_missing_, "no number");
        if (missing_ > 0) {
            list_.doubts.push_back(
                fmt::format("{}:{}: no number; left out{}", file_.path, first_missing_,
                            missing_ > 1 ? fmt::format(" ({} in all)", missing_) : std::string()));
        }
        return std::move(list_);
    }

  private:
    std::optional<std::size_t> find(Role role) const {
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            if (roles_[c].role == role) return c;
        }
        return std::nullopt;
    }
    bool has_numbers(std::size_t column) const {
        return std::any_of(sheet_.rows.begin(), sheet_.rows.end(), [&](const SheetRow& row) {
            return row.cells[column].number.has_value();
        });
    }
    /// A remark about percent is believed where values are too large for shares.
    bool is_large(const ValueColumn& column) const {
        return std::any_of(sheet_.rows.begin(), sheet_.rows.end(), [&](const SheetRow& row) {
            return row.cells[column.index].number.value_or(0.0) > 2.0;
        });
    }

    /// The columns of values: the one asked for; those whose names are known; else all that are
    /// left.
    void choose_columns() {
        std::vector<std::size_t> asked, known, unknown;
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            const Role role = roles_[c].role;
            const bool free = role == Role::value || role == Role::other;
            // Columns of a known name must hold numbers: text is refused with its line.
            if (!free || (role == Role::other && !has_numbers(c))) continue;
            if (lower_case(sheet_.names[c]) == lower_case(options_.column)) asked.push_back(c);
            (role == Role::value ? known : unknown).push_back(c);
        }
        const std::vector<std::size_t>& chosen = !asked.empty()   ? asked
                                                 : !known.empty() ? known
                                                                  : unknown;
        if (chosen.empty()) {
            refuse(file_, sheet_.names_line,
                   fmt::format("no column of values; there are {}", fmt::join(sheet_.names, ", ")));
        }
        for (const std::size_t c : chosen) {
            columns_.push_back({c, sheet_.names[c], roles_[c].kind, roles_[c].times_mu_out});
            set_wavelength(columns_.back());
        }
        if (asked.empty() && !known.empty() && !unknown.empty()) {
            std::vector<std::string> names(unknown.size());
            std::transform(unknown.begin(), unknown.end(), names.begin(),
                           [&](std::size_t c) { return sheet_.names[c]; });
            list_.facts.emplace_back("columns not read", fmt::format("{}", fmt::join(names, ", ")));
        }
        const bool directions = find(Role::theta_out) || find(Role::mu_out);
        const bool says = !options_.quantity.empty() || find(Role::quantity);
        for (ValueColumn& column : columns_) {
            if (column.kind || says) continue;
            if (directions) {
                refuse(file_, sheet_.names_line,
                       fmt::format("what is '{}': brdf (1/sr) or reflectance_factor (white is 1)? "
                                   "Say so with the option quantity, or name the column so",
                                   column.name));
            }
            column.kind = MeasuredKind{};
        }
    }

    void find_sigmas() {
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            if (roles_[c].role != Role::sigma) continue;
            const std::string of = sigma_of(sheet_.names[c]).value_or("");
            for (ValueColumn& column : columns_) {
                const bool named = !of.empty() && bare_name(column.name) == of;
                const bool only = of.empty() && columns_.size() == 1;
                const bool next = of.empty() && c == column.index + 1;
                if (named || only || next) column.sigma = c;
            }
        }
    }

    /// Of several columns of wavelengths the nearest before a value is its own; such values have
    /// one name, and what they are of stands above.
    void set_wavelength(ValueColumn& column) const {
        column.wavelength = find(Role::wavelength);
        if (!column.wavelength) return;
        for (std::size_t c = *column.wavelength; c < column.index; ++c) {
            if (roles_[c].role == Role::wavelength) column.wavelength = c;
        }
        if (std::count(sheet_.names.begin(), sheet_.names.end(), column.name) < 2) return;
        for (const std::size_t c : {column.index, *column.wavelength}) {
            if (c >= sheet_.above.size() || sheet_.above[c].empty()) continue;
            column.name = sheet_.above[c];
            return;
        }
        column.name = fmt::format("{} #{}", column.name, column.index + 1);
    }

    void find_units() {
        units_.assign(roles_.size(), materials::Unit::nanometre);
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            if (roles_[c].role != Role::wavelength) continue;
            if (roles_[c].unit) {
                units_[c] = *roles_[c].unit;
                continue;
            }
            double largest = 0.0;
            for (const SheetRow& row : sheet_.rows)
                largest = std::max(largest, row.cells[c].number.value_or(0.0));
            units_[c] =
                largest >= kLeastNm ? materials::Unit::nanometre : materials::Unit::micrometre;
            list_.facts.emplace_back(sheet_.names[c],
                                     fmt::format("taken as {}: the largest is {:g}",
                                                 materials::name_of(units_[c]), largest));
        }
    }

    void drop_repeated_facts() {
        std::vector<std::pair<std::string, std::string>> kept;
        for (const auto& fact : list_.facts) {
            const auto same = [&](const auto& other) {
                return other.first == fact.first && fact.first == "unit";
            };
            if (std::none_of(kept.begin(), kept.end(), same)) kept.push_back(fact);
        }
        list_.facts = std::move(kept);
    }

    double angle(const SheetRow& row, Role role) const {
        const auto column = find(role);
        if (!column) return MeasuredValue::kNone;
        const auto& number = row.cells[*column].number;
        if (!number)
            refuse(file_, row.line, fmt::format("'{}' has no number", sheet_.names[*column]));
        return roles_[*column].radians ? *number * 180.0 / std::numbers::pi : *number;
    }
    double plain(const SheetRow& row, Role role) const {
        const auto column = find(role);
        return column ? row.cells[*column].number.value_or(MeasuredValue::kNone)
                      : MeasuredValue::kNone;
    }
    std::string text(const SheetRow& row, Role role) const {
        const auto column = find(role);
        return column ? row.cells[*column].text : std::string();
    }

    std::size_t sample_of(const SheetRow& row, const ValueColumn& column) {
        std::string name = text(row, Role::sample);
        if (name.empty() || columns_.size() > 1) name += (name.empty() ? "" : " ") + column.name;
        const auto [at, added] = samples_.try_emplace(name, list_.samples.size());
        if (added) list_.samples.push_back(name);
        return at->second;
    }

    MeasuredKind kind_of_row(const SheetRow& row, const ValueColumn& column) const {
        MeasuredKind kind = column.kind.value_or(MeasuredKind{});
        const std::string quantity = text(row, Role::quantity),
                          geometry = text(row, Role::geometry);
        if (!column.kind && !quantity.empty()) kind = quantity_of(row, quantity);
        if (!geometry.empty()) kind.geometry = geometry_of(row, geometry);
        return kind;
    }
    MeasuredKind quantity_of(const SheetRow& row, const std::string& word) const {
        for (const auto quantity :
             {MeasuredQuantity::lab_l, MeasuredQuantity::lab_a, MeasuredQuantity::lab_b}) {
            if (word_of(quantity) == word) return {quantity, MeasuredGeometry::unknown};
        }
        try {
            return measured_kind(word);
        } catch (const UsageError& error) {
            refuse(file_, row.line, error.what());
        }
    }
    MeasuredGeometry geometry_of(const SheetRow& row, const std::string& word) const {
        for (int g = 0; g <= static_cast<int>(MeasuredGeometry::directions); ++g) {
            const auto geometry = static_cast<MeasuredGeometry>(g);
            if (word_of(geometry) == lower_case(word)) return geometry;
        }
        const NamedGeometry named = geometry_in(word);
        if (named.geometry != MeasuredGeometry::unknown) return named.geometry;
        refuse(file_, row.line,
               fmt::format("geometry '{}'; allowed: directional, d8-sci, d8-sce, 45-0, "
                           "hemispherical, hdrf, directions",
                           word));
    }

    double wavelength_of(const SheetRow& row, std::size_t column) const {
        const SheetCell& cell = row.cells[column];
        if (!cell.number && cell.text.empty()) return MeasuredValue{}.wavelength_nm;
        if (!cell.number)
            refuse(file_, row.line, fmt::format("wavelength '{}' is not a number", cell.text));
        if (!(*cell.number > 0.0))
            refuse(file_, row.line, fmt::format("wavelength {}; allowed: above 0", *cell.number));
        return materials::to_nm(*cell.number, units_[column]);
    }

    void read_row(const SheetRow& row) {
        MeasuredValue value;
        value.line = row.line;
        RawDirection raw;
        raw.theta_in = angle(row, Role::theta_in);
        raw.theta_out = angle(row, Role::theta_out);
        raw.phi = angle(row, Role::phi);
        raw.phi_in = angle(row, Role::phi_in);
        raw.phi_out = angle(row, Role::phi_out);
        value.mu_in = plain(row, Role::mu_in);
        value.mu_out = plain(row, Role::mu_out);
        value.azimuth_deg = plain(row, Role::azimuth_deg);
        for (const ValueColumn& column : columns_) {
            const SheetCell& cell = row.cells[column.index];
            if (!cell.number) {
                if (!cell.is_missing) {
                    refuse(file_, row.line,
                           fmt::format("'{}' in '{}' is not a number", cell.text, column.name));
                }
                if (missing_++ == 0) first_missing_ = row.line;
                continue;
            }
            if (column.wavelength) value.wavelength_nm = wavelength_of(row, *column.wavelength);
            const MeasuredKind kind = kind_of_row(row, column);
            value.quantity = kind.quantity;
            value.geometry = kind.geometry;
            const double factor = !is_share(kind.quantity) || cell.is_percent ? 1.0 : column.factor;
            value.value = *cell.number * factor;
            value.sigma = MeasuredValue::kNone;
            if (column.sigma && row.cells[*column.sigma].number)
                value.sigma = *row.cells[*column.sigma].number * factor;
            value.sample = sample_of(row, column);
            list_.values.push_back(value);
            raw.times_mu_out = column.times_mu_out;
            if (raw.given()) {
                raw.value = list_.values.size() - 1;
                raw_.push_back(raw);
            }
        }
    }

    const MeasuredFile& file_;
    Sheet sheet_;
    const MeasuredOptions& options_;
    std::vector<ColumnRole> roles_;
    std::vector<ValueColumn> columns_;
    std::vector<materials::Unit> units_;  ///< of each column
    Measurements list_;
    std::map<std::string, std::size_t> samples_;
    std::vector<RawDirection> raw_;
    std::size_t missing_ = 0;
    int first_missing_ = 0;
};

/// Two or three columns of numbers without names: wavelength, value and perhaps sigma.
Measurements read_nameless(const MeasuredFile& file, Sheet sheet, const MeasuredOptions& options) {
    const std::size_t count = sheet.rows.front().cells.size();
    sheet.names = {"wavelength", "reflectance"};
    if (count == 3) sheet.names.emplace_back("sigma");
    Measurements list = LongTable(file, std::move(sheet), options).read();
    list.facts.emplace_back(
        "columns", "without names: wavelength, value" + std::string(count == 3 ? ", sigma" : ""));
    return list;
}

bool is_nameless(const Sheet& sheet) {
    if (!sheet.names.empty() || sheet.rows.size() < 3) return false;
    const std::size_t count = sheet.rows.front().cells.size();
    const auto is_number = [](const SheetCell& cell) { return cell.number.has_value(); };
    return (count == 2 || count == 3) &&
           std::all_of(sheet.rows.begin(), sheet.rows.end(), [&](const SheetRow& row) {
               return std::all_of(row.cells.begin(), row.cells.end(), is_number);
           });
}

bool looks_like_table(const MeasuredFile& file) {
    // JSON and XML are not tables, nor is anything binary.
    const std::size_t first = file.content.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos || file.content[first] == '{' ||
        file.content[first] == '<' || file.content.find('\0') != std::string_view::npos)
        return false;
    if (!sheet_names(file).empty()) return true;
    try {
        return is_nameless(read_sheet(file));
    } catch (const materials::ImportError&) {
        return false;
    }
}

Measurements read_table(const MeasuredFile& file, const MeasuredOptions& options) {
    Sheet sheet = read_sheet(file);
    if (sheet.rows.empty()) refuse(file, 0, "has no rows; the first line names the columns");
    if (sheet.names_are_wavelengths) {
        if (!has_directions(sheet)) return read_spectra_in_rows(file, sheet, options);
        sheet = one_value_a_line(sheet);
    }
    if (is_nameless(sheet)) return read_nameless(file, std::move(sheet), options);
    if (sheet.names.empty()) {
        refuse(file, 1,
               "no line of names with a wavelength or directions, as in wavelength_nm,reflectance "
               "or theta_in,theta_out,phi,brdf");
    }
    return LongTable(file, std::move(sheet), options).read();
}

}  // namespace

extern const Reader kCsv;
constinit const Reader kCsv{{"csv", "tables (CSV)"}, looks_like_table, read_table};

}  // namespace miebrdf::measured
