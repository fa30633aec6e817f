// Spectral tables for people and programs of their own: CSV, JSON and NumPy's .npz.
// docs/formats/table.md
#pragma once

#include <filesystem>
#include <iosfwd>

#include "pipeline/formats/table_grid.h"

namespace miebrdf::exports {

/// `wavelength_nm,mu_in,mu_out,azimuth_deg,brdf`, one row for each value, metadata in '#' lines.
/// @throws UsageError  as tabulate; Cancelled
void write_table_csv(const BrdfSource& source, const TableGrid& grid, std::ostream& out,
                     const RunControl& control = {});

/// One object: metadata, the four axes, and "brdf" nested in their order.
void write_table_json(const BrdfSource& source, const TableGrid& grid, std::ostream& out,
                      const RunControl& control = {});

/// Arrays wavelength_nm, mu_in, mu_out, azimuth_deg, brdf[wavelength, mu_in, mu_out, azimuth] and
/// meta (JSON as bytes). @throws InputError  when `path` cannot be written
void write_table_npz(const BrdfSource& source, const TableGrid& grid,
                     const std::filesystem::path& path, const RunControl& control = {});

}  // namespace miebrdf::exports
