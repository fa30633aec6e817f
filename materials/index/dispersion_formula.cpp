#include "materials/index/dispersion_formula.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace miebrdf::materials {
namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

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

double root(double n_squared) { return n_squared > 0 ? std::sqrt(n_squared) : no_value; }

}  // namespace

double dispersion_formula(int formula, std::span<const double> coefficients, double wavelength_um) {
    const Coefficients c{coefficients};
    const double L = wavelength_um;
    double n = no_value;
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
            throw std::invalid_argument(
                fmt::format("dispersion formula {}; allowed: 1 to 9", formula));
    }
    return n > 0 && std::isfinite(n) ? n : no_value;
}

}  // namespace miebrdf::materials
