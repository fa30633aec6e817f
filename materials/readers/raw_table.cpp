#include "materials/readers/raw_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <miebrdf/database.h>
#include "materials/index/series.h"
#include "materials/index/units.h"
#include "materials/readers/text.h"
#include "materials/readers/text_table.h"

namespace miebrdf::materials {
namespace {

// The smallest n of measured tables is near 0.01 (silver, alkali metals); a table of k has less.
constexpr double kSmallestTabulatedIndex = 1e-4;
// Above 124 eV all electrons are nearly free: Henke, Gullikson & Davis (1993) have |n - 1| < 0.1.
constexpr double kLongestXray = 10.0;
constexpr double kMostXrayRefraction = 0.2;

void check_row(const RawTable& table, const RawRow& row, const std::string& file,
               double negative_k_tolerance) {
    const double wavelength_nm = to_nm(row.x, table.unit);
    if (!(row.x > 0 && std::isfinite(row.x) && std::isfinite(wavelength_nm) && wavelength_nm > 0)) {
        throw ImportError(file, row.line,
                          fmt::format("{} {} is no wavelength", row.x, name_of(table.unit)));
    }
    if (table.has_n && !(row.n >= kSmallestTabulatedIndex && row.n <= kLargestIndex)) {
        throw ImportError(
            file, row.line,
            fmt::format("n = {}; allowed: {} to 1e6{}", row.n, kSmallestTabulatedIndex,
                        row.n > 0 && row.n < 1 ? ". Are these figures k?" : ""));
    }
    if (table.has_n && wavelength_nm < kLongestXray &&
        std::abs(row.n - 1.0) > kMostXrayRefraction) {
        throw ImportError(
            file, row.line,
            fmt::format("n = {} at {} nm; allowed below {} nm: 1 within {}, as of all "
                        "X-rays. Are the wavelengths in another unit than {}?",
                        row.n, wavelength_nm, kLongestXray, kMostXrayRefraction,
                        name_of(table.unit)));
    }
    if (table.has_k && !(row.k >= -negative_k_tolerance && row.k <= kLargestIndex)) {
        throw ImportError(file, row.line,
                          fmt::format("k = {}; must be >= 0 and <= 1e6 (noise down to -{} is set "
                                      "to 0: negative_k_tolerance)",
                                      row.k, negative_k_tolerance));
    }
}

void check_rows(Dataset& dataset, RawTable& table, const std::string& file,
                const ReadOptions& options) {
    if (table.rows.empty()) throw ImportError(file, 0, "no data");
    if (table.rows.size() > kMostRows) throw ImportError(file, 0, "more than a million rows");
    BadRows bad;
    std::vector<RawRow> good;
    for (const RawRow& row : table.rows) {
        bad.try_row(options, [&] {
            check_row(table, row, file, options.negative_k_tolerance);
            good.push_back(row);
        });
    }
    bad.record(dataset, good.size());
    table.rows = std::move(good);
}

// Half of the literature writes n - ik: its k is negative wherever it is not 0.
void turn_sign_of_k(RawTable& table, double tolerance, std::vector<std::string>& corrections) {
    std::size_t negative = 0;
    double lowest = 0;
    for (const RawRow& row : table.rows) {
        if (!(row.k <= 0)) return;
        negative += row.k < 0 ? 1 : 0;
        lowest = std::min(lowest, row.k);
    }
    // A few negative values among zeros are noise, and so is a single row.
    const bool is_noise = 2 * negative <= table.rows.size() && lowest >= -tolerance;
    if (negative < 2 || is_noise) return;
    for (RawRow& row : table.rows) row.k = row.k < 0 ? -row.k : 0.0;
    corrections.push_back(fmt::format(
        "no k is positive (lowest {}): read as n - ik, the sign of all k turned", lowest));
}

void clamp_k(RawTable& table, std::vector<std::string>& corrections) {
    std::size_t count = 0;
    double lowest = 0;
    for (RawRow& row : table.rows) {
        if (!(row.k < 0)) continue;
        ++count;
        lowest = std::min(lowest, row.k);
        row.k = 0;
    }
    if (count > 0) {
        corrections.push_back(fmt::format("{} negative k set to 0 (lowest {})", count, lowest));
    }
}

void sort_rows(RawTable& table, std::vector<std::string>& corrections) {
    const bool reciprocal = is_reciprocal(table.unit);
    const auto shorter = [&](const RawRow& a, const RawRow& b) {
        return reciprocal ? a.x > b.x : a.x < b.x;
    };
    if (std::is_sorted(table.rows.begin(), table.rows.end(), shorter)) return;
    // A file in descending order is as good; any other order is recorded as a correction.
    const bool reversed = std::is_sorted(table.rows.rbegin(), table.rows.rend(), shorter);
    if (!reversed) corrections.push_back("rows sorted by wavelength");
    std::stable_sort(table.rows.begin(), table.rows.end(), shorter);
}

void drop_repeated(RawTable& table, std::vector<std::string>& corrections) {
    std::size_t dropped = 0;
    double largest = 0;
    std::vector<RawRow> kept;
    for (const RawRow& row : table.rows) {
        // Wavelengths that differ in the last bits only cannot be told apart in photon energy.
        const bool repeated =
            !kept.empty() && !(from_nm(to_nm(row.x, table.unit), Unit::electronvolt) <
                                   from_nm(to_nm(kept.back().x, table.unit), Unit::electronvolt) &&
                               to_nm(row.x, table.unit) > to_nm(kept.back().x, table.unit));
        if (!repeated) {
            kept.push_back(row);
            continue;
        }
        ++dropped;
        if (table.has_n) largest = std::max(largest, std::abs(row.n - kept.back().n));
        if (table.has_k) largest = std::max(largest, std::abs(row.k - kept.back().k));
    }
    if (dropped == 0) return;
    corrections.push_back(fmt::format(
        "{} rows with a repeated wavelength dropped, the first kept (largest difference {})",
        dropped, largest));
    table.rows = std::move(kept);
}

Series column(const RawTable& table, double RawRow::*member) {
    std::vector<double> x, y;
    x.reserve(table.rows.size());
    y.reserve(table.rows.size());
    for (const RawRow& row : table.rows) {
        x.push_back(row.x);
        y.push_back(row.*member);
    }
    return make_table(table.unit, std::move(x), std::move(y));
}

using Field = std::pair<const char*, std::string Dataset::*>;
constexpr Field kFields[] = {
    {"material", &Dataset::material},
    {"title", &Dataset::title},
    {"formula", &Dataset::formula},
    {"label", &Dataset::label},
    {"source", &Dataset::source},
    {"key", &Dataset::key},
    {"reference", &Dataset::reference},
    {"doi", &Dataset::doi},
    {"licence", &Dataset::licence},
    {"ray", &Dataset::ray},
    {"composition", &Dataset::composition},
    {"note", &Dataset::note},
    {"density_source", &Dataset::density_source},
};

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    std::replace(text.begin(), text.end(), '\r', ' ');
    return text;
}

}  // namespace

void add_table(Dataset& dataset, RawTable table, const std::string& file,
               const ReadOptions& options) {
    if (table.has_k) turn_sign_of_k(table, options.negative_k_tolerance, dataset.corrections);
    check_rows(dataset, table, file, options);
    if (table.has_k) clamp_k(table, dataset.corrections);
    sort_rows(table, dataset.corrections);
    drop_repeated(table, dataset.corrections);
    if (table.has_n) dataset.n = column(table, &RawRow::n);
    if (table.has_k) dataset.k = column(table, &RawRow::k);
}

void BadRows::add(const ImportError& error) { refusals_.push_back(error); }

void BadRows::record(Dataset& dataset, std::size_t good_rows) {
    if (refusals_.empty()) return;
    if (10 * refusals_.size() > good_rows + refusals_.size()) throw refusals_.front();
    constexpr std::size_t kShown = 5;
    for (std::size_t i = 0; i < std::min(kShown, refusals_.size()); ++i) {
        dataset.corrections.push_back(
            fmt::format("row of line {} left out: {}", refusals_[i].line(), refusals_[i].reason()));
    }
    if (refusals_.size() > kShown) {
        dataset.corrections.push_back(
            fmt::format("{} more rows left out", refusals_.size() - kShown));
    }
    refusals_.clear();
}

namespace {

std::optional<Unit> unit_in_remarks(const std::vector<std::string>& remarks) {
    for (const std::string& remark : remarks) {
        const std::string text = lower_case(remark);
        for (const std::string_view quantity : {"wavelength", "lambda", "energy", "wavenumber"}) {
            if (!text.starts_with(quantity)) continue;
            const auto name = spectral_name(text);
            if (name && name->unit) return name->unit;
        }
    }
    return std::nullopt;
}

}  // namespace

Unit settle_unit(Dataset& dataset, const std::optional<Unit>& named, const ReadOptions& options,
                 Unit by_default) {
    if (named && options.unit && *named != *options.unit) {
        dataset.corrections.push_back(fmt::format("the file names its unit, {}: {} not used",
                                                  name_of(*named), name_of(*options.unit)));
    }
    return named ? *named : options.unit.value_or(by_default);
}

void read_bare_columns(Dataset& dataset, std::string_view text, const BareColumns& columns,
                       const std::string& file, const ReadOptions& options) {
    const std::size_t count = columns.has_n && columns.has_k ? 3 : 2;
    TextTable lines(text, file, columns.comment);
    RawTable table{.has_n = columns.has_n, .has_k = columns.has_k, .rows = {}};
    BadRows bad;
    while (lines.next()) {
        bad.try_row(options, [&] {
            const std::vector<std::string>& fields = lines.fields();
            if (fields.size() != count)
                lines.refuse(fmt::format("{} columns, expected {}", fields.size(), count));
            RawRow row{lines.number(fields[0]), 0.0, 0.0, lines.line()};
            if (columns.has_n) row.n = lines.number(fields[1]);
            if (columns.has_k) row.k = lines.number(fields.back());
            table.rows.push_back(row);
        });
    }
    bad.record(dataset, table.rows.size());
    table.unit = settle_unit(dataset, unit_in_remarks(lines.comments()), options, columns.unit);
    std::vector<std::string> remarks = lines.comments();
    std::erase(remarks, columns.usual_remark);
    if (columns.takes_remarks) take_remarks(dataset, remarks);
    add_table(dataset, std::move(table), file, options);
}

void take_remarks(Dataset& dataset, const std::vector<std::string>& remarks) {
    std::string note;
    for (const std::string& remark : remarks) {
        if (read_provenance_line(dataset, remark) || note.size() >= 2000) continue;
        note += (note.empty() ? "" : " ") + remark;
    }
    if (dataset.note.empty()) dataset.note = note;
}

bool first_row_has(std::string_view text, char comment, std::size_t count) {
    TextTable lines(text, "", comment);
    return lines.next() && lines.fields().size() == count &&
           std::all_of(lines.fields().begin(), lines.fields().end(),
                       [](const std::string& field) { return table_number(field).has_value(); });
}

std::vector<std::string> provenance_lines(const Dataset& dataset) {
    std::vector<std::string> lines;
    for (const auto& [name, member] : kFields) {
        const std::string& value = dataset.*member;
        if (!value.empty()) lines.push_back(fmt::format("{}: {}", name, one_line(value)));
    }
    if (dataset.temperature_k)
        lines.push_back(fmt::format("temperature_k: {}", *dataset.temperature_k));
    if (dataset.density_g_cm3)
        lines.push_back(fmt::format("density_g_cm3: {}", *dataset.density_g_cm3));
    for (const std::string& correction : dataset.corrections) {
        lines.push_back("correction: " + one_line(correction));
    }
    return lines;
}

bool read_provenance_line(Dataset& dataset, std::string_view line) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string_view::npos) return false;
    const std::string_view name = without_blanks(line.substr(0, colon));
    const std::string value(without_blanks(line.substr(colon + 2)));
    bool known_name = false;
    for (const auto& [known, member] : kFields) {
        if (name != known) continue;
        known_name = true;
        if ((dataset.*member).empty()) dataset.*member = value;
    }
    if (name == "temperature_k") {
        const auto kelvin = parse_number(value);
        if (kelvin && *kelvin > 0 && *kelvin < 1e6) dataset.temperature_k = kelvin;
        known_name = true;
    }
    if (name == "density_g_cm3") {
        const auto density = parse_number(value);
        if (density && *density > 0 && *density < 100) dataset.density_g_cm3 = density;
        known_name = true;
    }
    if (name == "correction") {
        dataset.corrections.push_back(value);
        known_name = true;
    }
    if (dataset.ray != "o" && dataset.ray != "e") dataset.ray.clear();
    return known_name;
}

}  // namespace miebrdf::materials
