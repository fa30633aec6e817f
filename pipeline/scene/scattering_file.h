// Single scattering from files: averages and tables of sizes as databases give them.
#pragma once

#include <miebrdf/optics.h>
#include <miebrdf/scene.h>

#include <memory>
#include <string>

#include "pipeline/scene/given_medium.h"

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

/// What a layer has of the file: averages over sizes; between wavelengths linear in scattering and
/// extinction. Its extinction is the mean cross-section of a particle in um2 (of files without
/// cross-sections in a unit of their own), of sizes Q_ext; its radius that of sizes,
/// 3 <V> / (4 <A>).
std::shared_ptr<const GivenMedium> medium_of_file(const Species& species);

/// Refuses lists that do not fit and phase functions that are negative. @throws UsageError
void check_scattering(const Species& species);

}  // namespace miebrdf
