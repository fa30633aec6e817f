// Phase functions and scattering matrices from CSV files: Legendre moments, and coefficients in
// generalised spherical functions.
#pragma once

#include <miebrdf/optics.h>
#include <miebrdf/scene.h>

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
///         of order, chi_0 != 1 (beyond 1e-6: the file's digits), |chi_l| > 1, a phase function
///         that is negative
MomentsFile read_moments_file(const std::string& path);

/// Refuses moments of no phase function. @throws UsageError
void check_moments(const std::vector<double>& chi);

struct MatrixFile {
    std::vector<double> wavelength_nm;         ///< ascending; empty: the same at every wavelength
    std::vector<MatrixCoefficients> matrices;  ///< one for each, or one
};

/// Reads a header with the columns `l,a1,a2,a3,a4,b1,b2` in any order and rows with l = 0, 1, 2,
/// ... With a column `wavelength_nm` there are such rows for each wavelength. The albedo is a
/// column `single_scattering_albedo` or a comment line `# single_scattering_albedo: X`.
/// @throws InputError  with file and line: no such file, columns that are missing or unknown, rows
///         out of order, no albedo, and what no scattering matrix can be
MatrixFile read_matrix_file(const std::string& path);

/// 0 or 1 only if all are.
double mean_albedo(const std::vector<MatrixCoefficients>& matrices);

/// At a wavelength: linear between those of the table.
/// @throws InputError  for a wavelength that it does not cover
rte::Optics optics_of_matrices(const Species& species, double wavelength_nm);

rte::Optics optics_of(const MatrixCoefficients& matrix);

/// Adds all coefficients and the albedo, times the weight; shorter lists are zero beyond their end.
void add(MatrixCoefficients& sum, const MatrixCoefficients& one, double weight);

/// Refuses lists that do not fit and what no scattering matrix can be. @throws UsageError
void check_matrix(const MatrixCoefficients& matrix);
void check_matrices(const Species& species);

}  // namespace miebrdf
