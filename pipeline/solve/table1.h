// Averaged diffuse reflectance factors: Table 1 of the paper, and the same for any material.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <miebrdf/table1.h>
#include "pipeline/solve/resolved_medium.h"
#include "pipeline/solve/run_control.h"

namespace miebrdf {

struct Table1Entry {
    std::string convention;
    std::string material;
    std::string channel;  ///< R, G, B; empty when the wavelengths were chosen
    double wavelength_nm = 0.0;
    double factor = 0.0;          ///< mean of 1 - rho_dt, uniform in solid angle
    std::optional<double> paper;  ///< as printed, where the paper has it
};

struct Table1Request {
    std::vector<std::string> materials;  ///< empty: the paper's four
    std::vector<rte::Table1Convention> conventions;
    std::vector<double> wavelength_nm;     ///< empty: each convention's R, G, B
    std::optional<double> beckmann_alpha;  ///< instead of the convention's
    std::string database;
};

struct Table1Result {
    std::vector<Table1Entry> entries;
    std::vector<std::string> sources;
};

/// @throws InputError  for unknown materials and wavelengths outside their tables
Table1Result compute_table1(const Table1Request& request, const RunControl& control = {});

}  // namespace miebrdf
