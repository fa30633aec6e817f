#include "materials/database/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "materials/index/dispersion_formula.h"

namespace miebrdf::materials {
namespace {

using Severity = Finding::Severity;

// A single wrong value (a typing error, a lost digit) shows in the misses of each row from the line
// between its neighbours as -1/2, 1, -1/2 around it, and in no row further away: edges and peaks
// look different. Reported when it is more than a twentieth of the value.
constexpr double outlier_share = 0.05;
constexpr double outlier_contrast = 10.0;

// Kramers-Kronig residuals above this are remarked on; docs/materials.md has the distribution over
// the embedded tables.
constexpr double suspicious_residual = 0.5;

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
    return size > outlier_share * value && size > 0 && echoes(miss[i - 1]) && echoes(miss[i + 1]) &&
           size > outlier_contrast * std::max(std::abs(miss[i - 2]), std::abs(miss[i + 2]));
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
    for (int i = 0; i <= 1000; ++i) {
        const double wavelength_nm =
            series.shortest_nm + (series.longest_nm - series.shortest_nm) * i / 1000.0;
        if (dispersion_formula(series.formula, series.y, wavelength_nm / 1000) > 0) continue;
        findings.push_back(
            {Severity::warning, name,
             fmt::format("formula {} has no real value at {:.6g} nm, inside its range",
                         series.formula, wavelength_nm)});
        return;
    }
}

void verify_series(const std::optional<Series>& series, char quantity, const std::string& name,
                   std::vector<Finding>& findings) {
    if (!series) return;
    try {
        check_series(*series, quantity);
    } catch (const std::invalid_argument& error) {
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
    if (residual > suspicious_residual) {
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

}  // namespace

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
