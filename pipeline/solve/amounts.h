// How much of each species a layer holds, and how deep it is: volume fractions from volumes,
// masses and numbers, columns from thicknesses and masses.
#pragma once

#include <optional>

#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// Whether every amount is given as 0: there is the host alone.
bool has_no_particles(const Medium& medium);

/// Bulk density of a layer: its own (layer-density= of one of its species), else the scene's.
/// @throws UsageError  for species of one layer that say different ones
std::optional<double> layer_density_kg_m3(const Scene& scene, const Medium& medium);

/// Sets volume_fraction of every species, and has_amounts. Species of amount 0 beside others are
/// left out.
/// @param host_density_g_cm3  of what lies between the particles; empty: not known
/// @throws UsageError  for densities that are missing, and sums that cannot be
void set_amounts(ResolvedMedium& medium, std::optional<double> layer_density_kg_m3,
                 std::optional<double> host_density_g_cm3);

/// A depth that is not an optical depth, as micrometres of the volume fractions.
/// @throws UsageError  for amounts and densities that are missing
double column_um(const Depth& depth, const ResolvedMedium& medium);

/// The particles' share of the volume. @pre has_amounts
double filled_volume(const ResolvedMedium& medium);

}  // namespace miebrdf
