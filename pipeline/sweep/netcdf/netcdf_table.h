// Tables of sweeps as NetCDF-4 files with the CF conventions 1.8, by the plug-in netcdf. Without it
// all of these throw a UsageError that names the package.
#pragma once

#include <memory>
#include <string>

#include "pipeline/sweep/lookup.h"
#include "pipeline/sweep/table_writer.h"

namespace miebrdf::sweep {

/// One variable for each output over the axes, compressed; error_estimate and converged of each
/// scene; remarks on those that failed or did not converge.
/// @param sweep, layout  must outlive the writer
/// @throws InputError  when the file cannot be made
std::unique_ptr<TableWriter> make_netcdf_writer(const Sweep& sweep, const Layout& layout,
                                                const std::string& file);

/// The layout of CRTM's snow (satellite.h).
std::unique_ptr<TableWriter> make_crtm_writer(const Sweep& sweep, const Layout& layout,
                                              const std::string& file);

/// The identity of the sweep that a table is of; empty if it is none.
std::string identity_of_netcdf(const std::string& file);

/// @throws InputError  for a file that is no NetCDF or has no variables over axes
std::unique_ptr<StoredTable> open_netcdf_table(const std::string& file);

}  // namespace miebrdf::sweep
