#include "pipeline/solve/coated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>
#include <miebrdf/sizes.h>
#include "pipeline/solve/grain_shape.h"

namespace miebrdf {
namespace {

/// Means of powers of the core's radius, over that of the third.
struct RadiusPowers {
    double none = 0.0, first = 0.0, second = 0.0;
};

RadiusPowers powers_of(const ResolvedSpecies& species) {
    const bool has_thickness =
        std::any_of(species.species.coatings.begin(), species.species.coatings.end(),
                    [](const Coating& coating) { return coating.thickness_um > 0.0; });
    if (!has_thickness) return {};
    try {
        const double third = mie::mean_radius_power(species.sizes, 3);
        return {1.0 / third, mie::mean_radius_power(species.sizes, 1) / third,
                mie::mean_radius_power(species.sizes, 2) / third};
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("medium '{}': {}", describe(species.species), error.what()));
    }
}

}  // namespace

void add_coatings(ResolvedSpecies& species, const std::vector<ResolvedIndex>& coatings) {
    species.outer_radius_um = species.effective_radius_um;
    species.volume_per_core = 1.0;
    const RadiusPowers powers = powers_of(species);
    double share = 1.0, thickness_um = 0.0;  // the outer radius of a layer is share r + thickness
    double mass = species.density_g_cm3.value_or(0.0);
    bool has_mass = species.density_g_cm3.has_value();
    for (std::size_t i = 0; i < coatings.size(); ++i) {
        const Coating& coating = species.species.coatings[i];
        if (coating.thickness_um == 0.0 && coating.share_of_radius == 0.0) continue;
        for (std::size_t w = 0; w < species.particles.size(); ++w) {
            species.particles[w].coatings.push_back(
                {coatings[i].index[w], coating.thickness_um, coating.share_of_radius});
        }
        share += coating.share_of_radius;
        thickness_um += coating.thickness_um;
        const double t = thickness_um,
                     volume = share * share * share + 3.0 * share * share * t * powers.second +
                              3.0 * share * t * t * powers.first + t * t * t * powers.none;
        has_mass = has_mass && coatings[i].density_g_cm3;
        if (has_mass) mass += (volume - species.volume_per_core) * *coatings[i].density_g_cm3;
        species.volume_per_core = volume;
        species.outer_radius_um = share * species.effective_radius_um + thickness_um;
    }
    species.density_g_cm3.reset();
    if (has_mass) species.density_g_cm3 = mass / species.volume_per_core;
    if (species.species.density_g_cm3) species.density_g_cm3 = species.species.density_g_cm3;
}

mie::EnsembleRequest particles_of(const ResolvedSpecies& species, std::size_t w) {
    const Particles& at = species.particles[w];
    mie::EnsembleRequest request;
    request.sizes = species.sizes;
    request.refractive_index = at.index;
    request.coatings = at.coatings;
    const GrainShape& shape = species.species.shape;
    if (shape.by_t_matrix) request.aspect = shape.aspect.value_or(kSpheroidAspect);
    request.host_index = at.host_index;
    request.wavelength_nm = at.wavelength_nm;
    return request;
}

}  // namespace miebrdf
