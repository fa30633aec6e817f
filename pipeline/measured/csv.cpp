// Tables: spectra in columns or in rows, one value a line, goniometers' lists of directions, and
// what this program writes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "materials/readers/text.h"
#include "pipeline/measured/azimuth.h"
#include "pipeline/measured/columns.h"
#include "pipeline/measured/sheet.h"
#include "pipeline/measured/spectra_in_rows.h"

namespace miebrdf::measured {
namespace {

using materials::lower_case;

struct ValueColumn {
    std::size_t index = 0;
    std::string name;
    std::optional<MeasuredKind> kind;  ///< nothing: the rows say it, or the options
    bool times_mu_out = false;
    Conversion conversion = Conversion::none;
    double factor = 1.0;
    std::optional<std::size_t> sigma = {}, wavelength = {};
};

/// A table whose lines have one wavelength or direction each.
class LongTable {
  public:
    /// @param rows_of_spectra  where the last column of the sheet stands for all its wavelengths
    LongTable(const MeasuredFile& file, Sheet sheet, const MeasuredOptions& options,
              const Sheet* rows_of_spectra = nullptr)
        : file_(file),
          sheet_(std::move(sheet)),
          options_(options),
          rows_of_spectra_(rows_of_spectra) {
        for (const std::string& name : sheet_.names) {
            roles_.push_back(column_role(name));
            ++named_so_[name];
        }
        first_.fill(kNone);
        std::size_t nearest = kNone;
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            if (roles_[c].role == Role::wavelength) nearest = c;
            nearest_.push_back(nearest);
        }
        for (std::size_t c = roles_.size(); c-- > 0;) first_[std::size_t(roles_[c].role)] = c;
        // `phi` beside the azimuth of reflection is that of incidence.
        if (find(Role::phi_out) && !find(Role::phi_in)) {
            for (ColumnRole& column : roles_) {
                if (column.role == Role::phi) column.role = Role::phi_in;
            }
            std::swap(first_[std::size_t(Role::phi)], first_[std::size_t(Role::phi_in)]);
        }
        name_single_letters();
    }

    Measurements read() {
        choose_columns();
        find_sigmas();
        find_units();
        find_angles_in_radians();
        for (ValueColumn& column : columns_) {
            const bool says = says_percent(sheet_.names[column.index]) ||
                              (sheet_.says_percent() && is_large(column));
            if (column.conversion == Conversion::none)
                column.factor = share_factor(list_, options_, says, column.name);
        }
        drop_repeated_facts();
        if (rows_of_spectra_ == nullptr) {
            for (const SheetRow& row : sheet_.rows) read_row(row);
        } else {
            read_rows_of_spectra();
        }
        if (!raw_.empty()) set_directions(list_, raw_, options_, file_);
        if (sheet_.lines_below > 0) {
            list_.facts.emplace_back(
                "lines below the values, not read",
                fmt::format("{}, from line {}", sheet_.lines_below, sheet_.first_below));
        }
        return std::move(list_);
    }

  private:
    static constexpr std::size_t kNone = ~std::size_t{0};

    std::optional<std::size_t> find(Role role) const {
        const std::size_t c = first_[std::size_t(role)];
        return c == kNone ? std::optional<std::size_t>() : c;
    }
    /// "L", "a", "b" are CIELab. "A" beside "R" or "T" is absorptance or absorbance: it is not
    /// read.
    void name_single_letters() {
        std::map<std::string, std::size_t> at;
        for (std::size_t c = 0; c < roles_.size(); ++c) at.emplace(bare_name(sheet_.names[c]), c);
        const auto a = at.find("a");
        if (a == at.end() || roles_[a->second].role != Role::value) return;
        const auto l = at.find("l"), b = at.find("b");
        if (l != at.end() && b != at.end()) {
            using enum MeasuredQuantity;
            for (const auto& [c, quantity] : {std::pair(l, lab_l), {a, lab_a}, {b, lab_b}}) {
                roles_[c->second] = {Role::value, {}, MeasuredKind{quantity, {}}};
            }
        } else if (b != at.end()) {
            roles_[a->second] = {.role = Role::other};  // samples a, b, ...
        } else if (at.count("r") + at.count("t") + at.count("reflectance") +
                       at.count("transmittance") >
                   0) {
            roles_[a->second] = {.role = Role::refused,
                                 .refused = "absorptance or absorbance, which is not said"};
        }
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
        std::vector<std::size_t> asked, known, unknown, refused;
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            const Role role = roles_[c].role;
            const bool free = role == Role::value || role == Role::other || role == Role::refused;
            // Columns of a known name must hold numbers: text is refused with its line.
            if (!free || (role != Role::value && !has_numbers(c))) continue;
            if (lower_case(sheet_.names[c]) == lower_case(options_.column)) asked.push_back(c);
            (role == Role::value ? known : role == Role::other ? unknown : refused).push_back(c);
        }
        std::vector<std::size_t> chosen = !asked.empty() ? asked : !known.empty() ? known : unknown;
        // What the values are may be said in place of their name.
        if (chosen.empty()) chosen = refused;
        if (chosen.empty()) {
            refuse(file_, sheet_.names_line,
                   fmt::format("no column of values; there are {}", fmt::join(sheet_.names, ", ")));
        }
        const ValueMeaning otherwise = sheet_.meaning();
        for (const std::size_t c : chosen) {
            ColumnRole& role = roles_[c];
            if (role.role == Role::other) {
                role.conversion = otherwise.conversion;
                role.refused = otherwise.refused;
                if (otherwise.conversion != Conversion::none ||
                    otherwise.kind.quantity != MeasuredQuantity::reflectance)
                    role.kind = otherwise.kind;
            }
            if (!role.refused.empty() && options_.quantity.empty())
                refuse(file_, sheet_.names_line, refusal_of(sheet_.names[c], role.refused));
            columns_.push_back({c, sheet_.names[c], role.kind, role.times_mu_out, role.conversion});
            set_wavelength(columns_.back());
            if (role.conversion == Conversion::none) continue;
            list_.facts.emplace_back(
                columns_.back().name,
                words_of(role.conversion, options_.quantity.empty()
                                              ? role.kind->quantity
                                              : measured_kind(options_.quantity).quantity));
        }
        std::vector<std::string> unread;
        for (const auto* left : {&unknown, &refused}) {
            for (const std::size_t c : *left) {
                if (chosen != *left && asked.empty()) unread.push_back(sheet_.names[c]);
            }
        }
        say_unread(unread);
        const bool directions = find(Role::theta_out) || find(Role::mu_out);
        const bool says = !options_.quantity.empty() || find(Role::quantity);
        for (ValueColumn& column : columns_) {
            // "Reflection" of spectrometers is no reflectance factor of directions.
            if (column.kind == measured_kind("reflection") && !directions)
                column.kind = MeasuredKind{};
            if (column.kind || says) continue;
            if (directions) {
                refuse(file_, sheet_.names_line,
                       fmt::format("what is '{}': brdf (1/sr) or reflectance_factor (white is 1)? "
                                   "Say so with the option quantity, or name the column so",
                                   column.name));
            }
            column.kind = MeasuredKind{};
            if (!roles_[column.index].kind && !said_unknown_++)
                list_.facts.emplace_back(
                    "columns",
                    "'" + column.name + "' names no quantity: taken as reflectance of a sample");
        }
    }

    void say_unread(const std::vector<std::string>& names) {
        if (!names.empty())
            list_.facts.emplace_back("columns not read", fmt::format("{}", fmt::join(names, ", ")));
    }

    /// Standard errors belong to the column that they name, else to the only one of the quantity
    /// that they name ("R_std" beside "reflectance"), else to the one before them, else to the only
    /// column. Others are not read, which is said.
    void find_sigmas() {
        std::vector<std::string> unread;
        std::map<std::string, std::vector<std::size_t>> by_name;
        std::map<MeasuredQuantity, std::vector<std::size_t>> by_quantity;
        std::map<std::size_t, std::size_t> by_place;
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            by_name[without_mean(bare_name(columns_[i].name))].push_back(i);
            if (columns_[i].kind) by_quantity[columns_[i].kind->quantity].push_back(i);
            by_place[columns_[i].index] = i;
        }
        const auto sigmas =
            std::count_if(roles_.begin(), roles_.end(),
                          [](const ColumnRole& column) { return column.role == Role::sigma; });
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            if (roles_[c].role != Role::sigma) continue;
            const std::string of = without_mean(sigma_of(sheet_.names[c]).value_or(""));
            const auto meaning = of.empty() ? std::nullopt : value_meaning(of);
            std::vector<std::size_t> candidates;
            if (!of.empty()) candidates = by_name[of];
            if (candidates.empty() && meaning && meaning->refused.empty())
                candidates = by_quantity[meaning->kind.quantity];
            if (candidates.size() != 1) {
                const auto before = by_place.find(c - 1);
                const bool fits = of.empty() || !candidates.empty();
                candidates.clear();
                if (before != by_place.end() && fits) candidates = {before->second};
                if (candidates.empty() && columns_.size() == 1 && sigmas == 1 && !meaning)
                    candidates = {0};
            }
            if (candidates.size() == 1 && !columns_[candidates[0]].sigma)
                columns_[candidates[0]].sigma = c;
            else if (has_numbers(c))
                unread.push_back(sheet_.names[c]);
        }
        if (unread.empty()) return;
        say_unread(unread);
        list_.doubts.push_back(fmt::format(
            "{}:{}: standard errors of no column that is read: {}. Name them after theirs, as in "
            "reflectance,reflectance_sigma",
            file_.path, sheet_.names_line, fmt::join(unread, ", ")));
    }

    /// "r_mean", "mean_r" -> "r".
    static std::string without_mean(std::string name) {
        for (const std::string word : {"mean", "average", "avg"}) {
            if (name.ends_with("_" + word)) name.erase(name.size() - word.size() - 1);
            if (name.starts_with(word + "_")) name.erase(0, word.size() + 1);
        }
        return name;
    }

    /// Angles of which a remark says so, or none of which can be degrees.
    void find_angles_in_radians() {
        double largest = 0.0;
        bool said = false;
        const bool remark =
            std::any_of(sheet_.remarks.begin(), sheet_.remarks.end(), [](const std::string& text) {
                return lower_case(text).find("radian") != std::string::npos &&
                       lower_case(text).find("angle") != std::string::npos;
            });
        for (std::size_t c = 0; c < roles_.size(); ++c) {
            ColumnRole& column = roles_[c];
            if (column.role != Role::theta_in && column.role != Role::theta_out) continue;
            said = said || column.radians ||
                   lower_case(sheet_.names[c]).find("deg") != std::string::npos;
            for (const SheetRow& row : sheet_.rows)
                largest = std::max(largest, std::abs(row.cells[c].number.value_or(0.0)));
        }
        if (remark && !said) {
            for (ColumnRole& column : roles_)
                column.radians = column.radians ||
                                 (column.role >= Role::theta_in && column.role <= Role::phi_out &&
                                  column.role != Role::mu_in && column.role != Role::mu_out);
            list_.facts.emplace_back("angles", "in radians, as a remark says");
        } else if (!said && largest > 0.0 && largest <= std::numbers::pi / 2) {
            list_.doubts.push_back(fmt::format(
                "{}: angles up to {:.4g}, taken as degrees; radians are named so: 'theta_i (rad)'",
                file_.path, largest));
        }
    }

    /// Of several columns of wavelengths the nearest before a value is its own; such values have
    /// one name, and what they are of stands above.
    void set_wavelength(ValueColumn& column) const {
        column.wavelength = find(Role::wavelength);
        if (!column.wavelength) return;
        if (nearest_[column.index] != kNone) column.wavelength = nearest_[column.index];
        if (named_so_.at(column.name) < 2) return;
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
        bool said = false;
        std::erase_if(list_.facts, [&](const auto& fact) {
            return fact.first == "unit" && std::exchange(said, true);
        });
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
        // As this program writes a reflectance factor of which nobody said the directions.
        const bool is_open = find(Role::geometry) && geometry.empty() && find(Role::mu_out) &&
                             std::isnan(plain(row, Role::mu_out));
        if (is_open && kind == measured_kind("reflectance_factor"))
            kind.geometry = MeasuredGeometry::unknown;
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

    /// The sheet has a row's columns before its spectrum, one wavelength and its value.
    void read_rows_of_spectra() {
        const Sheet& all = *rows_of_spectra_;
        const std::size_t count = sheet_.names.size(), before = count - 2;
        for (std::size_t c = before; c < all.names.size(); ++c) {
            const SheetCell at{all.names[c], wavelength_in_name(all.names[c])};
            for (std::size_t r = 0; r < all.rows.size(); ++r) {
                sheet_.rows[r].cells[before] = at;
                sheet_.rows[r].cells[before + 1] = all.rows[r].cells[c];
                read_row(sheet_.rows[r]);
            }
        }
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
            if (!cell.number && !cell.is_missing) {
                refuse(file_, row.line,
                       fmt::format("'{}' in '{}' is not a number", cell.text, column.name));
            }
            if (column.wavelength) value.wavelength_nm = wavelength_of(row, *column.wavelength);
            const MeasuredKind kind = kind_of_row(row, column);
            value.quantity = kind.quantity;
            value.geometry = kind.geometry;
            const double factor = !is_share(kind.quantity) || cell.is_percent ? 1.0 : column.factor,
                         number = cell.number.value_or(MeasuredValue::kNone);
            value.value = converted(number, column.conversion) * factor;
            value.sigma = MeasuredValue::kNone;
            if (column.sigma) {
                const SheetCell& sigma = row.cells[*column.sigma];
                if (!sigma.number && !sigma.is_missing) {
                    refuse(file_, row.line,
                           fmt::format("'{}' in '{}' is not a number", sigma.text,
                                       sheet_.names[*column.sigma]));
                }
                value.sigma = sigma.number.value_or(MeasuredValue::kNone) * factor *
                              std::abs(conversion_slope(number, column.conversion));
            }
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
    const Sheet* rows_of_spectra_;
    std::vector<ColumnRole> roles_;
    std::array<std::size_t, std::size_t(Role::refused) + 1> first_;  ///< column of each role
    std::vector<std::size_t> nearest_;     ///< column of wavelengths at or before each
    std::map<std::string, int> named_so_;  ///< columns of each name
    std::vector<ValueColumn> columns_;
    std::vector<materials::Unit> units_;  ///< of each column
    int said_unknown_ = 0;                ///< columns whose names say no quantity
    Measurements list_;
    std::map<std::string, std::size_t> samples_;
    std::vector<RawDirection> raw_;
};

/// Two or three columns of numbers without names: wavelength, value and perhaps sigma.
Measurements read_nameless(const MeasuredFile& file, Sheet sheet, const MeasuredOptions& options) {
    const std::size_t count = sheet.rows.front().cells.size();
    // OPUS (Bruker) writes wavenumbers without names.
    const bool opus = lower_case(std::filesystem::path(file.path).extension().string()) == ".dpt";
    sheet.names = {opus ? "wavenumber_cm-1" : "wavelength", "reflectance"};
    if (count == 3) sheet.names.emplace_back("sigma");
    Measurements list = LongTable(file, std::move(sheet), options).read();
    list.facts.emplace_back("columns", fmt::format("without names: {}, value{}",
                                                   opus ? "wavenumber in 1/cm" : "wavelength",
                                                   count == 3 ? ", sigma" : ""));
    return list;
}

bool is_nameless(const Sheet& sheet) {
    if (!sheet.names.empty() || sheet.rows.size() < 3) return false;
    const std::size_t count = sheet.rows.front().cells.size();
    const auto is_number_or_missing = [](const SheetCell& cell) {
        return cell.number || cell.is_missing;
    };
    return (count == 2 || count == 3) &&
           std::all_of(sheet.rows.begin(), sheet.rows.end(), [&](const SheetRow& row) {
               return row.cells.front().number &&
                      std::all_of(row.cells.begin() + 1, row.cells.end(), is_number_or_missing);
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
        const Sheet sheet = read_sheet(file);
        return !sheet.names.empty() || is_nameless(sheet);
    } catch (const materials::ImportError&) {
        return false;
    }
}

Measurements read_table(const MeasuredFile& file, const MeasuredOptions& options) {
    Sheet sheet = read_sheet(file);
    if (sheet.rows.empty()) refuse(file, 0, "has no rows; the first line names the columns");
    if (sheet.names_are_wavelengths) {
        if (!has_directions(sheet)) return read_spectra_in_rows(file, sheet, options);
        return LongTable(file, first_value_of_rows(sheet), options, &sheet).read();
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
