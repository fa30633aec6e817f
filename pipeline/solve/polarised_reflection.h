// The part of polarised light's solution that unpolarised light shows, for any number of
// directions.
#pragma once

#include <vector>

#include <miebrdf/solver.h>
#include "rte/stokes/stokes_reflection.h"

namespace miebrdf {

/// Element 11 of rte::MuellerTable, and what else is asked of it.
struct UnpolarisedReflection {
    std::vector<double> reflection;  ///< [(in * outs + out) * azimuths + azimuth]
    std::vector<double> plane_albedo;
    std::vector<double> polarised_plane_albedo;
    std::vector<double> mirror_reflectance;  ///< empty where there is none
    rte::SolverReport report;                ///< of the worst block; shares are means over all
};

/// Solves block by block of at most `most_directions` directions: with its estimates a solution
/// takes 500 bytes for each of them. Streams are chosen for each block; values are relative to the
/// largest of their incidence within the block.
/// @throws UsageError  as rte::reflect_polarised
UnpolarisedReflection reflect_unpolarised(const rte::Stack& stack,
                                          const rte::Directions& directions, int components,
                                          const rte::SolverOptions& options,
                                          std::size_t most_directions = 250'000);

/// Element 11 of Mueller matrices, one after the other.
std::vector<double> unpolarised_part(const std::vector<double>& matrices, std::size_t elements);

}  // namespace miebrdf
