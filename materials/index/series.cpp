#include "materials/index/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <miebrdf/error.h>
#include "materials/index/units.h"

namespace miebrdf::materials {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

// c(1) is the first coefficient, as in the formulas.
struct Coefficients {
    std::span<const double> values;
    double operator()(std::size_t i) const { return i <= values.size() ? values[i - 1] : 0.0; }
    std::size_t count() const { return values.size(); }
};

// Terms whose numerator is 0 are left out: some pages write 0 / (L^2 - 0^0) for "no such term".
double sellmeier(const Coefficients& c, double L, bool squared) {
    double sum = c(1);
    for (std::size_t i = 2; i <= c.count(); i += 2) {
        if (c(i) == 0) continue;
        const double pole = squared ? c(i + 1) * c(i + 1) : c(i + 1);
        sum += c(i) * L * L / (L * L - pole);
    }
    return 1 + sum;
}

double powers(const Coefficients& c, double L, std::size_t first) {
    double sum = 0;
    for (std::size_t i = first; i <= c.count(); i += 2) {
        if (c(i) != 0) sum += c(i) * std::pow(L, c(i + 1));
    }
    return sum;
}

double mixed(const Coefficients& c, double L) {
    double sum = c(1) + powers(c, L, 10);
    for (const std::size_t i : {2, 6}) {
        if (c(i) != 0) sum += c(i) * std::pow(L, c(i + 1)) / (L * L - std::pow(c(i + 2), c(i + 3)));
    }
    return sum;
}

double gas(const Coefficients& c, double L) {
    double sum = 1 + c(1);
    for (std::size_t i = 2; i <= c.count(); i += 2) {
        if (c(i) != 0) sum += c(i) / (c(i + 1) - 1 / (L * L));
    }
    return sum;
}

double herzberger(const Coefficients& c, double L) {
    const double square = L * L;
    const double pole = 1 / (square - 0.028);
    return c(1) + c(2) * pole + c(3) * pole * pole +
           square * (c(4) + square * (c(5) + square * c(6)));
}

double retro(const Coefficients& c, double L) {
    const double resonance = c(2) == 0 ? 0 : c(2) * L * L / (L * L - c(3));
    const double lorentz_lorenz = c(1) + resonance + c(4) * L * L;
    return (1 + 2 * lorentz_lorenz) / (1 - lorentz_lorenz);
}

double exotic(const Coefficients& c, double L) {
    const double shift = L - c(5);
    const double first = c(2) == 0 ? 0 : c(2) / (L * L - c(3));
    const double second = c(4) == 0 ? 0 : c(4) * shift / (shift * shift + c(6));
    return c(1) + first + second;
}

double root(double n_squared) { return n_squared > 0 ? std::sqrt(n_squared) : kNoValue; }

}  // namespace

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
        throw InputError(fmt::format("{}: {}", quantity, reason));
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
        const std::string mismatch = formula_mismatch(series.formula, series.y);
        if (!mismatch.empty()) refuse(mismatch);
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
        if (quantity == 'n' && !(series.y[i] > 0 && series.y[i] <= kLargestIndex)) {
            refuse(fmt::format("row {} ({} nm) is {}; must be > 0 and <= 1e6", i + 1, wavelength_nm,
                               series.y[i]));
        }
        if (quantity == 'k' && !(series.y[i] >= 0 && series.y[i] <= kLargestIndex)) {
            refuse(fmt::format("row {} ({} nm) is {}; must be >= 0 and <= 1e6", i + 1,
                               wavelength_nm, series.y[i]));
        }
        previous_nm = wavelength_nm;
        previous_ev = energy_ev;
    }
}

std::string formula_mismatch(int formula, std::span<const double> coefficients) {
    const std::size_t count = coefficients.size();
    const auto reason = [&](std::string_view allowed) {
        return fmt::format("formula {} with {} coefficients; allowed: {}", formula, count, allowed);
    };
    switch (formula) {
        case 4: {  // a constant, two terms of four coefficients, then pairs
            const bool whole = count == 1 || count == 5 || (count >= 9 && count % 2 == 1);
            return whole ? "" : reason("1, 5, 9 or an odd number above");
        }
        case 7:
            return count == 5 || count == 6 ? "" : reason("5 or 6");
        case 8:
            return count == 4 ? "" : reason("4");
        case 9:
            return count == 6 ? "" : reason("6");
        default:  // a constant, then pairs
            return count % 2 == 1 ? "" : reason("an odd number, a constant and pairs");
    }
}

std::string formula_gap(const Series& series) {
    constexpr int kIntervals = 1000;
    int bad = 0;
    double first_nm = 0;
    for (int i = 0; i <= kIntervals; ++i) {
        const double t = static_cast<double>(i) / kIntervals;
        const double wavelength_nm = 1 / ((1 - t) / series.shortest_nm + t / series.longest_nm);
        if (dispersion_formula(series.formula, series.y, wavelength_nm / 1000) > 0) continue;
        if (bad++ == 0) first_nm = wavelength_nm;
    }
    if (bad == 0) return "";
    return fmt::format(
        "formula {} has no real value at {} of {} wavelengths of its range, first at {:.6g} nm",
        series.formula, bad, kIntervals + 1, first_nm);
}

double dispersion_formula(int formula, std::span<const double> coefficients, double wavelength_um) {
    const Coefficients c{coefficients};
    const double L = wavelength_um;
    double n = kNoValue;
    switch (formula) {
        case 1:
            n = root(sellmeier(c, L, true));
            break;
        case 2:
            n = root(sellmeier(c, L, false));
            break;
        case 3:
            n = root(c(1) + powers(c, L, 2));
            break;
        case 4:
            n = root(mixed(c, L));
            break;
        case 5:
            n = c(1) + powers(c, L, 2);
            break;
        case 6:
            n = gas(c, L);
            break;
        case 7:
            n = herzberger(c, L);
            break;
        case 8:
            n = root(retro(c, L));
            break;
        case 9:
            n = root(exotic(c, L));
            break;
        default:
            throw UsageError("formula", formula, "1 to 9");
    }
    return n > 0 && std::isfinite(n) ? n : kNoValue;
}

}  // namespace miebrdf::materials
