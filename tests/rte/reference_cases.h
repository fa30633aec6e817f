// The outside tables of tests/reference/rte as scenes and expected values.
#pragma once

#include <string>
#include <vector>

#include "rte/stack/layered_reflection.h"

namespace miebrdf::support {

/// One direction of a table of reflection functions.
struct ExpectedReflection {
    double mu_out;
    double mu_in;
    double azimuth_deg;
    double reflection;
};

/// All rows of a table that belong to one scene.
struct ReflectionCase {
    std::string name;
    rte::Stack stack;
    std::vector<ExpectedReflection> rows;
};

/// @param file  in tests/reference/rte, one of R_halfspace_*.csv, R_coated_halfspace.csv,
///              R_stress_grazing_thin_conservative.csv
std::vector<ReflectionCase> reflection_cases(const std::string& file);

struct ExpectedAlbedo {
    double mu_in;  ///< 0: the spherical albedo
    double value;
};

struct AlbedoCase {
    std::string name;
    rte::Stack stack;
    std::vector<ExpectedAlbedo> rows;
};

/// @param file  albedo_*.csv, or the stress table (its plane albedos)
std::vector<AlbedoCase> albedo_cases(const std::string& file);

/// Largest deviation from a case: |R / expected - 1| over rows with both cosines >= mu_from.
double largest_relative_error(const ReflectionCase& reference, const rte::SolverOptions& options,
                              double mu_from = 0.0, rte::SolverReport* report = nullptr);

/// As above, with the difference relative to the largest expected value at that incidence: what
/// SolverReport::error_estimate estimates.
double largest_scaled_error(const ReflectionCase& reference, const rte::SolverOptions& options,
                            double mu_from = 0.0, rte::SolverReport* report = nullptr);

}  // namespace miebrdf::support
