#include "pipeline/solve/rules.h"

#include <algorithm>

#include "pipeline/scene/medium_kinds.h"
#include "rte/grid/directions.h"

namespace miebrdf {
namespace {

bool all_one(const std::vector<double>& cosines) {
    return std::all_of(cosines.begin(), cosines.end(), [](double mu) { return mu == 1.0; });
}

}  // namespace

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

bool is_symmetric(const Directions& directions) { return directions.mu_in == directions.mu_out; }

bool absorbs_nothing(const ResolvedMedium& medium, std::size_t w) {
    return medium.needs_mie() ? medium.index[w].imag() == 0.0 : medium.medium.parameters[0] == 1.0;
}

bool absorbs_nothing(const ResolvedScene& scene, std::size_t w) {
    return std::all_of(scene.media.begin(), scene.media.end(),
                       [w](const ResolvedMedium& medium) { return absorbs_nothing(medium, w); });
}

bool scatters_nothing(const Medium& medium) {
    return !needs_mie(medium) && medium.parameters[0] == 0.0;
}

int most_fourier_orders(const ResolvedScene& scene) {
    int most = 0;
    for (const ResolvedMedium& medium : scene.media) {
        const int orders = kind_of(medium.medium).most_fourier_orders(medium.medium);
        if (orders == 0) return 0;
        most = std::max(most, orders);
    }
    return most;
}

}  // namespace miebrdf
