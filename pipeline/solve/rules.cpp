#include "pipeline/solve/rules.h"

#include <algorithm>

#include "pipeline/scene/medium_kinds.h"
#include "pipeline/solve/coated.h"
#include "pipeline/solve/resolver.h"
#include "rte/grid/directions.h"

namespace miebrdf {
namespace {

bool all_one(const std::vector<double>& cosines) {
    return std::all_of(cosines.begin(), cosines.end(), [](double mu) { return mu == 1.0; });
}

}  // namespace

bool is_left_out(const Scene& scene, const Layer& layer) {
    return layer.depth.value == 0.0 && !scene.boundary && !has_mirror(scene);
}

bool wants_layers(const BrdfParts& parts) { return parts.subsurface || parts.total; }

bool wants_lobe(const ResolvedScene& scene, const BrdfParts& parts) {
    return scene.surface && (parts.surface || parts.total);
}

bool only_zenith(const Directions& directions) {
    return all_one(directions.mu_in) || all_one(directions.mu_out);
}

bool only_across(const Directions& directions) {
    return rte::fourier_order_vanishes(1, directions.azimuth_deg);
}

bool has_no_pairs(const Directions& directions) {
    return directions.mu_in.empty() || directions.mu_out.empty() || directions.azimuth_deg.empty();
}

bool is_symmetric(const Directions& directions) { return directions.mu_in == directions.mu_out; }

bool absorbs_nothing(const ResolvedMedium& medium, std::size_t w) {
    return medium.host_absorption[w] == 0.0 &&
           std::all_of(
               medium.species.begin(), medium.species.end(), [w](const ResolvedSpecies& species) {
                   if (!species.needs_mie())
                       return species.given->optics(species.wavelength_nm[w]).one_minus_albedo ==
                              0.0;
                   return all_layers(species.particles[w],
                                     [](std::complex<double> n) { return n.imag() == 0.0; });
               });
}

bool absorbs_nothing(const ResolvedScene& scene, std::size_t w) {
    if (scene.substrate && scene.ground_albedo[w] != 1.0) return false;
    return std::all_of(scene.media.begin() + static_cast<std::ptrdiff_t>(scene.first_medium()),
                       scene.media.end(),
                       [w](const ResolvedMedium& medium) { return absorbs_nothing(medium, w); });
}

bool scatters_nothing(const ResolvedMedium& medium) {
    const ResolvedSpecies& only = medium.species.front();
    if (only.needs_mie() || medium.species.size() > 1) return false;
    return std::all_of(only.wavelength_nm.begin(), only.wavelength_nm.end(), [&](double nm) {
        return only.given->optics(nm).single_scattering_albedo == 0.0;
    });
}

int most_fourier_orders(const ResolvedScene& scene) {
    int most = 0;
    for (const ResolvedMedium& medium : scene.present_media()) {
        const auto& given = medium.species.front().given;
        const int orders = given ? given->most_fourier_orders() : 0;
        if (orders == 0) return 0;
        most = std::max(most, orders);
    }
    return most;
}

}  // namespace miebrdf
