// Is a dataset sound, and is it plausible?
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <miebrdf/database.h>
#include "materials/index/series.h"
#include "materials/index/units.h"

namespace miebrdf::materials {
namespace {

using Severity = Finding::Severity;

// A single wrong value (a typing error, a lost digit): the distances of the rows around it from the
// line between their neighbours are in the ratio -1/2 : 1 : -1/2, and rows further away lie on it.
// Edges and peaks have other ratios. Reported when it is more than a twentieth of the value.
constexpr double kOutlierShare = 0.05;
constexpr double kOutlierContrast = 10.0;

// Kramers-Kronig residuals above this are remarked on; docs/materials.md has the distribution over
// the embedded tables.
constexpr double kSuspiciousResidual = 0.5;

// How far each inner row is from the line between its neighbours; 0 for the first and last.
std::vector<double> misses(const Series& series) {
    const std::vector<double> x = series.wavelengths_nm();
    std::vector<double> miss(x.size(), 0.0);
    for (std::size_t i = 1; i + 1 < x.size(); ++i) {
        const double t = (x[i] - x[i - 1]) / (x[i + 1] - x[i - 1]);
        miss[i] = series.y[i] - (1 - t) * series.y[i - 1] - t * series.y[i + 1];
    }
    return miss;
}

bool is_outlier(const std::vector<double>& miss, std::size_t i, double value) {
    const double size = std::abs(miss[i]);
    const auto echoes = [&](double neighbour) {
        const double ratio = -neighbour / miss[i];
        return ratio >= 0.3 && ratio <= 0.8;
    };
    return size > kOutlierShare * value && size > 0 && echoes(miss[i - 1]) && echoes(miss[i + 1]) &&
           size > kOutlierContrast * std::max(std::abs(miss[i - 2]), std::abs(miss[i + 2]));
}

std::string find_outliers(const Series& series, char quantity) {
    if (series.x.size() < 7) return "";
    const std::vector<double> miss = misses(series);
    std::string found;
    int count = 0;
    for (std::size_t i = 3; i + 3 < miss.size(); ++i) {
        if (!is_outlier(miss, i, series.y[i])) continue;
        const double wavelength_nm = to_nm(series.x[i], series.unit);
        if (++count <= 3) found += fmt::format("{}{:.6g} nm", count > 1 ? ", " : "", wavelength_nm);
    }
    if (count == 0) return "";
    return fmt::format("{} jumps away from all its neighbours at {}{}", quantity, found,
                       count > 3 ? fmt::format(" and {} more", count - 3) : "");
}

void verify_formula(const Series& series, const std::string& name, std::vector<Finding>& findings) {
    const std::string gap = formula_gap(series);
    if (!gap.empty()) findings.push_back({Severity::warning, name, gap});
}

void verify_series(const std::optional<Series>& series, char quantity, const std::string& name,
                   std::vector<Finding>& findings) {
    if (!series) return;
    try {
        check_series(*series, quantity);
    } catch (const InputError& error) {
        findings.push_back({Severity::error, name, error.what()});
        return;
    }
    if (!series->tabulated()) return verify_formula(*series, name, findings);
    if (const std::string jumps = find_outliers(*series, quantity); !jumps.empty()) {
        findings.push_back({Severity::warning, name, jumps});
    }
}

void note_k(const Dataset& d, const std::string& name, std::vector<Finding>& findings) {
    if (!d.k) {
        findings.push_back({Severity::note, name, "k is unknown"});
    } else if (std::all_of(d.k->y.begin(), d.k->y.end(), [](double k) { return k == 0; })) {
        findings.push_back(
            {Severity::note, name, "k is 0 throughout: more likely not measured than 0"});
    }
    const double residual = kramers_kronig_residual(d);
    if (residual > kSuspiciousResidual) {
        findings.push_back(
            {Severity::note, name,
             fmt::format("n does not follow from k (Kramers-Kronig residual {:.2g}); "
                         "absorption outside the table can be the reason",
                         residual)});
    }
}

void verify_stored(const Database& database, const std::string& name,
                   std::vector<Finding>& findings) {
    try {
        const std::vector<Finding> found = verify(database.dataset(name));
        findings.insert(findings.end(), found.begin(), found.end());
    } catch (const DatabaseError& error) {
        findings.push_back({Severity::error, name, error.what()});
    }
}

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

std::vector<Finding> verify(const Dataset& dataset) {
    const std::string name = dataset.material + "/" + dataset.label;
    std::vector<Finding> findings;
    if (!dataset.n) findings.push_back({Severity::note, name, "n is unknown: k only"});
    verify_series(dataset.n, 'n', name, findings);
    verify_series(dataset.k, 'k', name, findings);
    const bool sound = std::none_of(findings.begin(), findings.end(),
                                    [](const Finding& f) { return f.severity == Severity::error; });
    if (sound) note_k(dataset, name, findings);
    return findings;
}

std::vector<Finding> verify(const Database& database, const std::string& name) {
    std::vector<Finding> findings;
    if (!name.empty()) {
        const DatasetInfo info = database.dataset_info(name);
        verify_stored(database, info.material + "/" + info.label, findings);
        return findings;
    }
    for (const std::string& problem : database.integrity_problems()) {
        findings.push_back({Severity::error, "", problem});
    }
    for (const MaterialInfo& material : database.list()) {
        for (const DatasetInfo& d : database.datasets(material.name)) {
            verify_stored(database, d.material + "/" + d.label, findings);
        }
    }
    return findings;
}

}  // namespace miebrdf::materials
