#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "materials/database/verify.h"
#include "materials/index/refractive_index.h"

namespace miebrdf::materials {
namespace {

using Values = std::vector<double>;

double dot(const Values& a, const Values& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

double root_mean_square(const Values& v) {
    return std::sqrt(dot(v, v) / static_cast<double>(v.size()));
}

// Removes from v its least-squares part along each basis function; modified Gram-Schmidt.
void remove_components(Values& v, std::vector<Values> basis) {
    for (std::size_t i = 0; i < basis.size(); ++i) {
        const double norm = std::sqrt(dot(basis[i], basis[i]));
        if (!(norm > 0)) continue;
        for (double& value : basis[i]) value /= norm;
        for (std::size_t j = i + 1; j < basis.size(); ++j) {
            const double along = dot(basis[j], basis[i]);
            for (std::size_t p = 0; p < v.size(); ++p) basis[j][p] -= along * basis[i][p];
        }
        const double along = dot(v, basis[i]);
        for (std::size_t p = 0; p < v.size(); ++p) v[p] -= along * basis[i][p];
    }
}

// (2/pi) P integral of E' k / (E'^2 - E^2), k piecewise linear between the nodes; E is no node.
// E'/(E'^2 - E^2) = (1/(E' - E) + 1/(E' + E)) / 2, and each part has a primitive with a logarithm.
double dispersion_integral(const Values& energy, const Values& k, double E) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < energy.size(); ++i) {
        const double lower = energy[i], upper = energy[i + 1];
        const double slope = (k[i + 1] - k[i]) / (upper - lower);
        const double at_zero = k[i] - slope * lower;
        sum += slope * (upper - lower) +
               0.5 * (at_zero + slope * E) * std::log(std::abs((upper - E) / (lower - E))) +
               0.5 * (at_zero - slope * E) * std::log((upper + E) / (lower + E));
    }
    return 2 / std::numbers::pi * sum;
}

}  // namespace

double kramers_kronig_residual(const Dataset& dataset) {
    const double no_value = std::numeric_limits<double>::quiet_NaN();
    if (!dataset.n || !dataset.k || !dataset.n->tabulated() || !dataset.k->tabulated())
        return no_value;
    Values energy = dataset.k->wavelengths_nm();
    for (double& value : energy) value = from_nm(value, Unit::electronvolt);
    Values k = dataset.k->y;
    std::reverse(energy.begin(), energy.end());
    std::reverse(k.begin(), k.end());
    if (energy.size() < 10 || *std::max_element(k.begin(), k.end()) == 0) return no_value;

    const RefractiveIndex index("", dataset.n, std::nullopt);
    const double span = energy.back() - energy.front();
    const std::size_t stride = 1 + energy.size() / 400;
    Values n, residual;
    std::vector<Values> basis(3);
    for (std::size_t i = 0; i + 1 < energy.size(); i += stride) {
        const double E = 0.5 * (energy[i] + energy[i + 1]);
        const double wavelength_nm = to_nm(E, Unit::electronvolt);
        const bool inner = E > energy.front() + 0.1 * span && E < energy.back() - 0.1 * span;
        if (!inner || !index.covers(wavelength_nm)) continue;
        n.push_back(index.at(wavelength_nm).real());
        residual.push_back(n.back() - dispersion_integral(energy, k, E));
        basis[0].push_back(1);
        basis[1].push_back(E * E);
        basis[2].push_back(1 / (E * E));
    }
    if (n.size() < 8) return no_value;
    remove_components(n, {basis[0]});
    remove_components(residual, basis);
    const double variation = root_mean_square(n);
    return variation > 1e-3 ? root_mean_square(residual) / variation : no_value;
}

}  // namespace miebrdf::materials
