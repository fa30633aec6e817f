// Single scattering from files: averages and tables of sizes as databases give them.
#pragma once

#include <miebrdf/optics.h>
#include <miebrdf/scene.h>

#include <string>

namespace miebrdf {

/// Reads, by what the file contains, into scattering (and matrices) of the species:
/// - OPAC's component files: spectra of cross-sections and phase functions (Hess et al. 1998);
/// - output of Mishchenko's T-matrix programs for random orientation: coefficients of the
///   scattering matrix, one wavelength or several one after the other;
/// - isca.dat of the databases of Yang et al. (2013, J. Atmos. Sci. 70, 330) and TAMUdust2020
///   (Saito et al. 2021, J. Atmos. Sci. 78, 2089) with P11.dat beside it: tables of sizes; with
///   P12.dat, P22.dat, P33.dat, P43.dat and P44.dat, too, they polarise; isca.txt with PMat.txt:
///   one particle;
/// - NetCDF: scattering_netcdf.h;
/// - CSV with the columns angle_deg and p11, for spectra wavelength_nm, single_scattering_albedo
///   (or a comment line) and extinction_um2, for polarisation p12, p22, p33, p34 and p44 in the
///   unit of p11.
/// @throws InputError  with the file, the line where there is one, angle and value
void read_scattering_file(const std::string& path, Species& species);

/// Whether the file says how large its particles are.
bool has_sizes(const FileScattering& table);

/// The sizes that words say, of files that have sizes: of those that have averages, one radius.
/// @throws InputError  where words say none, or what the file cannot give
mie::SizeDistribution sizes_of_file(const Species& species);

/// At a wavelength: between those of the file linear in scattering and extinction.
/// @throws InputError  for a wavelength or sizes that the file does not cover
rte::Optics optics_of_file(const Species& species, double wavelength_nm);

/// Mean extinction cross-section in um2 of a particle; of files without cross-sections in a unit of
/// their own. Of sizes: Q_ext.
double extinction_of_file(const Species& species, double wavelength_nm);

/// The effective radius of sizes, 3 <V> / (4 <A>).
double effective_radius_of_file(const Species& species, double wavelength_nm);

/// The mean projected area of a particle of sizes. @throws UsageError  of averages
double mean_area_of_file_um2(const Species& species, double wavelength_nm);

/// Refuses lists that do not fit and phase functions that are negative. @throws UsageError
void check_scattering(const Species& species);

}  // namespace miebrdf
