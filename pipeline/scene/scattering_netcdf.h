// Single scattering from NetCDF files of databases and other programs.
#pragma once

#include <miebrdf/scene.h>

#include <string>

namespace miebrdf {

/// Whether the file begins as a NetCDF file does (classic, or within HDF5).
bool is_netcdf(const std::string& path);

/// Reads, by the variables that the file has:
/// - `wavelen`, `ext`, `ssa` and `theta` with `phase`, or `pmom`: what libRadtran reads and writes
///   and MOPSMAP writes for it (Emde et al. 2016, Geosci. Model Dev. 9, 1647; Gasteiger & Wiegner
///   2018, Geosci. Model Dev. 11, 2739), of one or several effective radii `reff`;
/// - `sizepara`, `lmax`, `qext`, `qsca`, `rat`, `a1` ... `b2`: MOPSMAP's data set, particles of one
///   shape and refractive index at size parameters;
/// - `wavelengths`, `effective_diameter`, `phase_angles`, `p11_phase_function` ...: bulk scattering
///   by ice habits of Yang et al. (Baum et al. 2014, J. Quant. Spectrosc. Radiat. Transfer 146,
///   123);
/// - `ang`, `p11` ..., `qext`, `ssa`, `rEff`: aerosol tables of GEOSmie.
/// @throws InputError  for other files, and for dimensions beyond these that are longer than 1
/// @throws UsageError  where the plug-in netcdf is missing
void read_scattering_netcdf(const std::string& path, Species& species);

}  // namespace miebrdf
