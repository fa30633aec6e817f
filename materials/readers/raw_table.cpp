#include "materials/readers/raw_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace miebrdf::materials {
namespace {

void check_rows(const RawTable& table, const std::string& file, double negative_k_tolerance) {
    if (table.rows.empty()) throw ImportError(file, 0, "no data");
    if (table.rows.size() > most_rows) throw ImportError(file, 0, "more than a million rows");
    for (const RawRow& row : table.rows) {
        const double wavelength_nm = to_nm(row.x, table.unit);
        if (!(row.x > 0 && std::isfinite(row.x) && std::isfinite(wavelength_nm) &&
              wavelength_nm > 0)) {
            throw ImportError(file, row.line,
                              fmt::format("{} {} is no wavelength", row.x, name_of(table.unit)));
        }
        if (table.has_n && !(row.n > 0 && std::isfinite(row.n))) {
            throw ImportError(file, row.line, fmt::format("n = {}; must be > 0", row.n));
        }
        if (table.has_k && !(row.k >= -negative_k_tolerance && std::isfinite(row.k))) {
            throw ImportError(file, row.line,
                              fmt::format("k = {}; must be >= 0 (noise down to -{} is set to 0, "
                                          "further with --negative-k-tolerance)",
                                          row.k, negative_k_tolerance));
        }
    }
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
    // The whole file the other way round is an order too; anything else is worth a remark.
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

}  // namespace

void add_table(Dataset& dataset, RawTable table, const std::string& file,
               const ReadOptions& options) {
    check_rows(table, file, options.negative_k_tolerance);
    if (table.has_k) clamp_k(table, dataset.corrections);
    sort_rows(table, dataset.corrections);
    drop_repeated(table, dataset.corrections);
    if (table.has_n) dataset.n = column(table, &RawRow::n);
    if (table.has_k) dataset.k = column(table, &RawRow::k);
}

double require_number(std::string_view text, const std::string& file, int line) {
    const std::optional<double> value = parse_number(text);
    if (!value || !std::isfinite(*value)) {
        throw ImportError(file, line, fmt::format("'{}' is not a number", text.substr(0, 40)));
    }
    return *value;
}

std::vector<std::string_view> split_words(std::string_view line, std::string_view separators) {
    std::vector<std::string_view> words;
    std::size_t start = line.find_first_not_of(separators);
    while (start != std::string_view::npos) {
        const std::size_t end = std::min(line.find_first_of(separators, start), line.size());
        words.push_back(line.substr(start, end - start));
        start = line.find_first_not_of(separators, end);
    }
    return words;
}

}  // namespace miebrdf::materials
