#include "tests/rte/reference_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "tests/support/reference_table.h"

namespace miebrdf::support {
namespace {

rte::Optics henyey_greenstein(const ReferenceTable& table, std::size_t row, const char* albedo,
                              const char* asymmetry) {
    return rte::henyey_greenstein_optics(table.number(row, albedo), table.number(row, asymmetry));
}

rte::Stack scene(const std::string& file, const ReferenceTable& table, std::size_t row) {
    rte::Stack stack;
    if (file.find("isotropic") != std::string::npos) {
        stack.base = rte::isotropic_optics(table.number(row, "alpha"));
    } else if (file.find("rayleigh") != std::string::npos) {
        stack.base = rte::rayleigh_optics(table.number(row, "alpha"));
    } else if (file.find("halfspace_HG") != std::string::npos) {
        stack.base = henyey_greenstein(table, row, "alpha", "g");
    } else if (file.find("coated") != std::string::npos) {
        stack.base = rte::henyey_greenstein_optics(0.95, 0.7);  // in the table's header
        if (table.number(row, "tau") > 0) {
            stack.coats = {
                {henyey_greenstein(table, row, "coat_alpha", "coat_g"), table.number(row, "tau")}};
        }
    } else {
        stack.base = henyey_greenstein(table, row, "base_alpha", "base_g");
        // The table prints 0.999999999 with few digits; the case's name says what it is.
        if (table.text(row, "case") == "iso_1-1e-9") {
            stack.base.single_scattering_albedo = 1.0 - 1e-9;
            stack.base.one_minus_albedo = 1e-9;
        }
        if (table.number(row, "coat_tau") > 0) {
            stack.coats = {{henyey_greenstein(table, row, "coat_alpha", "coat_g"),
                            table.number(row, "coat_tau")}};
        }
    }
    return stack;
}

std::string scene_name(const ReferenceTable& table, std::size_t row) {
    std::string name;
    for (const char* column : {"case", "g", "alpha", "coat", "tau"}) {
        if (table.has_column(column))
            name += fmt::format(" {} {}", column, table.text(row, column));
    }
    return name;
}

template <typename Case>
Case& case_of(std::vector<Case>& cases, const std::string& file, const ReferenceTable& table,
              std::size_t row) {
    const std::string name = scene_name(table, row);
    if (cases.empty() || cases.back().name != name) {
        cases.push_back({name, scene(file, table, row), {}});
    }
    return cases.back();
}

std::size_t position(const std::vector<double>& sorted, double value) {
    return std::size_t(std::lower_bound(sorted.begin(), sorted.end(), value) - sorted.begin());
}

double largest_error(const ReflectionCase& reference, const rte::SolverOptions& options,
                     double mu_from, rte::SolverReport* report, bool scaled) {
    std::set<double> cosines;
    std::set<double> azimuths;
    std::map<double, double> scale;
    for (const auto& row : reference.rows) {
        cosines.insert({row.mu_in, row.mu_out});
        azimuths.insert(row.azimuth_deg);
        for (const double mu : {row.mu_in, row.mu_out}) {
            scale[mu] = std::max(scale[mu], std::abs(row.reflection));
        }
    }
    rte::Directions directions;
    directions.mu_in.assign(cosines.begin(), cosines.end());
    directions.mu_out = directions.mu_in;
    directions.azimuth_deg.assign(azimuths.begin(), azimuths.end());
    const auto table = rte::reflect(reference.stack, directions, options);
    if (report) *report = table.report;

    double largest = 0.0;
    for (const auto& row : reference.rows) {
        if (row.mu_in < mu_from || row.mu_out < mu_from) continue;
        const std::size_t pair = position(directions.mu_in, row.mu_in) * cosines.size() +
                                 position(directions.mu_out, row.mu_out);
        const double value = table.reflection[pair * azimuths.size() +
                                              position(directions.azimuth_deg, row.azimuth_deg)];
        const double error = std::abs(value - row.reflection) /
                             (scaled ? scale[row.mu_in] : std::abs(row.reflection));
        if (!(error <= largest)) largest = error;  // a NaN stays
    }
    return largest;
}

}  // namespace

std::vector<ReflectionCase> reflection_cases(const std::string& file) {
    const ReferenceTable table("rte/" + file);
    std::vector<ReflectionCase> cases;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.text(row, "mu_o") == "plane_albedo") continue;
        case_of(cases, file, table, row)
            .rows.push_back({table.number(row, "mu_o"), table.number(row, "mu_i"),
                             table.number(row, "phi_deg"), table.number(row, "R")});
    }
    return cases;
}

std::vector<AlbedoCase> albedo_cases(const std::string& file) {
    const ReferenceTable table("rte/" + file);
    const bool stress = table.has_column("case");
    std::vector<AlbedoCase> cases;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (stress && table.text(row, "mu_o") != "plane_albedo") continue;
        const bool spherical = !stress && table.text(row, "quantity") == "spherical_albedo";
        case_of(cases, file, table, row)
            .rows.push_back({spherical ? 0.0 : table.number(row, "mu_i"),
                             table.number(row, stress ? "R" : "value")});
    }
    return cases;
}

double largest_relative_error(const ReflectionCase& reference, const rte::SolverOptions& options,
                              double mu_from, rte::SolverReport* report) {
    return largest_error(reference, options, mu_from, report, false);
}

double largest_scaled_error(const ReflectionCase& reference, const rte::SolverOptions& options,
                            double mu_from, rte::SolverReport* report) {
    return largest_error(reference, options, mu_from, report, true);
}

}  // namespace miebrdf::support
