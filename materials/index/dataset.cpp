#include "materials/index/dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "materials/database/sha256.h"

namespace miebrdf::materials {

std::vector<double> Series::wavelengths_nm() const {
    std::vector<double> wavelengths;
    wavelengths.reserve(x.size());
    for (const double value : x) wavelengths.push_back(to_nm(value, unit));
    return wavelengths;
}

Series make_table(Unit unit, std::vector<double> x, std::vector<double> y) {
    Series series;
    series.unit = unit;
    series.x = std::move(x);
    series.y = std::move(y);
    if (!series.x.empty()) {
        series.shortest_nm = to_nm(series.x.front(), unit);
        series.longest_nm = to_nm(series.x.back(), unit);
    }
    return series;
}

void check_series(const Series& series, char quantity) {
    const auto refuse = [&](const std::string& reason) {
        throw std::invalid_argument(fmt::format("{}: {}", quantity, reason));
    };
    if (!(series.shortest_nm > 0 && series.shortest_nm <= series.longest_nm &&
          std::isfinite(series.longest_nm))) {
        refuse(fmt::format("range {} to {} nm; both must be positive and ascending",
                           series.shortest_nm, series.longest_nm));
    }
    if (series.y.empty()) refuse("no values");
    if (!std::all_of(series.y.begin(), series.y.end(), [](double v) { return std::isfinite(v); })) {
        refuse("values must be finite");
    }
    if (!series.tabulated()) {
        if (series.formula < 1 || series.formula > 9) refuse("formulas are numbered 1 to 9");
        return;
    }
    if (series.x.size() != series.y.size()) {
        refuse(fmt::format("{} wavelengths for {} values", series.x.size(), series.y.size()));
    }
    double previous_nm = 0;
    double previous_ev = 0;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        const double wavelength_nm = to_nm(series.x[i], series.unit);
        const double energy_ev = from_nm(wavelength_nm, Unit::electronvolt);
        if (!(wavelength_nm > 0 && std::isfinite(wavelength_nm) && energy_ev > 0)) {
            refuse(fmt::format("row {}: wavelength {} nm", i + 1, wavelength_nm));
        }
        if (i > 0 && !(wavelength_nm > previous_nm && energy_ev < previous_ev)) {
            refuse(fmt::format("row {}: wavelength {} nm does not follow {} nm", i + 1,
                               wavelength_nm, previous_nm));
        }
        if (quantity == 'n' && !(series.y[i] > 0)) {
            refuse(fmt::format("row {} ({} nm) is {}; must be > 0", i + 1, wavelength_nm,
                               series.y[i]));
        }
        if (quantity == 'k' && !(series.y[i] >= 0)) {
            refuse(fmt::format("row {} ({} nm) is {}; must be >= 0", i + 1, wavelength_nm,
                               series.y[i]));
        }
        previous_nm = wavelength_nm;
        previous_ev = energy_ev;
    }
}

std::string to_bytes(const std::vector<double>& values) {
    std::string bytes;
    bytes.reserve(values.size() * 8);
    for (const double value : values) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        for (int shift = 0; shift < 64; shift += 8)
            bytes += static_cast<char>(bits >> shift & 0xff);
    }
    return bytes;
}

std::vector<double> from_bytes(const void* bytes, std::size_t size) {
    const auto* byte = static_cast<const unsigned char*>(bytes);
    std::vector<double> values(size / 8);
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::uint64_t bits = 0;
        for (int j = 7; j >= 0; --j) bits = bits << 8 | byte[8 * i + static_cast<std::size_t>(j)];
        values[i] = std::bit_cast<double>(bits);
    }
    return values;
}

std::string content_sha256(const Dataset& dataset) {
    std::string bytes;
    for (const auto* series : {&dataset.n, &dataset.k}) {
        if (!*series) {
            bytes += "unknown;";
            continue;
        }
        const Series& s = **series;
        bytes +=
            fmt::format("formula {} {} {} {};", s.formula, name_of(s.unit), s.x.size(), s.y.size());
        bytes += to_bytes({s.shortest_nm, s.longest_nm});
        bytes += to_bytes(s.x);
        bytes += to_bytes(s.y);
    }
    return sha256_hex(bytes);
}

}  // namespace miebrdf::materials
