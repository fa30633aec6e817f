// Coatings of particles: what they are made of at every wavelength, and their share of a particle.
#pragma once

#include <vector>

#include "pipeline/solve/named_index.h"
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf {

/// Puts the coatings of a species around its particles and sets outer_radius_um, volume_per_core
/// and, unless the species states its own, the density of the whole from those of its parts.
/// Coatings without thickness are left out.
/// @param coatings  n + ik and densities, in the order of the species
/// @throws UsageError  where the number of small cores has no limit
void add_coatings(ResolvedSpecies& species, const std::vector<ResolvedIndex>& coatings);

/// Every layer of a particle has an index for which `is` holds.
template <typename Is>
bool all_layers(const Particles& at, const Is& is) {
    bool all = is(at.index);
    for (const mie::ParticleCoating& coating : at.coatings)
        all = all && is(coating.refractive_index);
    return all;
}

/// The request of an average over the particles of a species, without wishes.
mie::EnsembleRequest particles_of(const ResolvedSpecies& species, std::size_t w);

}  // namespace miebrdf
