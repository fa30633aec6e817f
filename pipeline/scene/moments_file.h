// Legendre moments of a phase function from a CSV file.
#pragma once

#include <string>
#include <vector>

namespace miebrdf {

struct MomentsFile {
    double single_scattering_albedo = 0.0;
    std::vector<double> chi;  ///< chi_0 = 1, chi_1 = g, ...
};

/// Reads a header line `l,chi`, rows with l = 0, 1, 2, ... in order, and the albedo from a comment
/// line `# single_scattering_albedo: X`.
/// @throws InputError  with file and line: no such file, no albedo, albedo outside [0, 1], rows out
///         of order, chi_0 != 1 (beyond 1e-6: the file's digits), |chi_l| > 1
MomentsFile read_moments_file(const std::string& path);

}  // namespace miebrdf
