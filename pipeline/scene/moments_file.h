// Phase functions and scattering matrices from CSV files: Legendre moments, and coefficients in
// generalised spherical functions.
#pragma once

#include <miebrdf/optics.h>
#include <miebrdf/scene.h>

#include <string>
#include <vector>

namespace miebrdf {

struct MatrixFile {
    std::vector<double> wavelength_nm;         ///< ascending; empty: the same at every wavelength
    std::vector<MatrixCoefficients> matrices;  ///< one for each, or one
};

struct MomentsFile {
    double single_scattering_albedo = 0.0;  ///< the mean over the wavelengths
    std::vector<double> chi;                ///< chi_0 = 1, chi_1 = g, ...; empty: by_wavelength
    MatrixFile by_wavelength;               ///< of files with a column `wavelength_nm`: a1 alone
};

/// Reads a header line `l,chi` and rows with l = 0, 1, 2, ... in order; wavelengths and albedo as
/// read_matrix_file().
/// @throws InputError  with file and line: no such file, no albedo, albedo outside [0, 1], rows out
///         of order, chi_0 != 1 (beyond 1e-6: the file's digits), |chi_l| > 1, a phase function
///         that is negative
MomentsFile read_moments_file(const std::string& path);

/// Refuses moments of no phase function. @throws UsageError
void check_moments(const std::vector<double>& chi);

/// Reads a header with the columns `l,a1,a2,a3,a4,b1,b2` in any order and rows with l = 0, 1, 2,
/// ... With a column `wavelength_nm` there are such rows for each wavelength. The albedo is a
/// column `single_scattering_albedo` or a comment line `# single_scattering_albedo: X`.
/// @throws InputError  with file and line: no such file, columns that are missing or unknown, rows
///         out of order, no albedo, and what no scattering matrix can be
MatrixFile read_matrix_file(const std::string& path);

/// Reads Henyey-Greenstein functions into name, parameters (the means over the wavelengths) and,
/// of several wavelengths, matrices: rows with the columns `g` (or `asymmetry`), `wavelength_nm`
/// and `single_scattering_albedo` (or `albedo`, or the comment line); without wavelengths one row.
/// @throws InputError  with file and line, as the others
void read_asymmetry_file(const std::string& path, Species& species);

/// 0 or 1 only if all are.
double mean_albedo(const std::vector<MatrixCoefficients>& matrices);

/// Coefficients over wavelengths.
class CoefficientTable {
  public:
    explicit CoefficientTable(const Species& species);

    /// Linear between the wavelengths of the table.
    /// @throws InputError  for a wavelength that it does not cover
    MatrixCoefficients at(double wavelength_nm) const;
    int most_degrees() const;

  private:
    std::string name_;  ///< for messages
    MatrixFile file_;
};

/// Without polarisation where there is a1 alone.
rte::Optics optics_of(const MatrixCoefficients& matrix);

/// Adds all coefficients and the albedo, times the weight; shorter lists are zero beyond their end.
void add(MatrixCoefficients& sum, const MatrixCoefficients& one, double weight);

/// Refuses lists that do not fit and what no scattering matrix can be. @throws UsageError
void check_matrix(const MatrixCoefficients& matrix);
/// The same of each wavelength, in the form of the kind: a1 alone of moments, {1, 3 g} of
/// Henyey-Greenstein functions.
void check_matrices(const Species& species);

}  // namespace miebrdf
