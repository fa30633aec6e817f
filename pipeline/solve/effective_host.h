// Crowded particles: what lies between them is the host and other particles.
#pragma once

#include <cstddef>

#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// The real refractive index around a sphere of a medium whose others are dissolved in the host
/// (Maxwell Garnett 1904): with beta = (e - h) / (e + 2 h), e the permittivity of a species, h of
/// the host, and f the volume fractions,
///     e_eff = h (1 + 2 sum f beta) / (1 - sum f beta).
/// Coated spheres count with the permittivity of a sphere of one material and the same dipole.
/// Absorption by the particles is that of Mie theory, not of this host.
/// @param medium  of spheres with amounts
double effective_host_index(const ResolvedMedium& medium, std::size_t w);

}  // namespace miebrdf
