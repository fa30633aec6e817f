// Rough run times, for `plan`: right to a factor of about three on the machine they were fitted on
// (docs/performance.md), and good for comparing one request with another.
#pragma once

#include <cstddef>

#include <miebrdf/solver.h>
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// Mie theory for one medium at one wavelength; by the largest sphere's size parameter.
/// @param whole_phase  the phase function at every angle and all its moments
double mie_seconds(const mie::SizeDistribution& sizes, double host_index, double wavelength_nm,
                   bool whole_phase);

/// Nodes that will probably be used: those asked for, or what `auto` begins with.
int expected_streams(const ResolvedScene& scene, const rte::SolverOptions& solver);

/// One Fourier order of a half-space and its coats, on two numbers of nodes.
double order_seconds(int streams, std::size_t layers, std::size_t cosines);

/// Exact first order and sum over orders, for one pair of directions and azimuth.
double value_seconds(int orders);

/// Surface lobe at one pair of directions and azimuth, and rho at one cosine.
double lobe_seconds();
double rho_seconds();

}  // namespace miebrdf
