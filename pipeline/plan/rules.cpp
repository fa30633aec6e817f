#include "pipeline/plan/rules.h"

#include <algorithm>

#include "rte/stack/fourier_sum.h"

namespace miebrdf {
namespace {

/// The albedo of a medium that brings its own; empty for Mie media.
std::optional<double> given_albedo(const Medium& medium) {
    return std::visit(
        [](const auto& m) -> std::optional<double> {
            if constexpr (requires { m.single_scattering_albedo; }) {
                return m.single_scattering_albedo;
            } else {
                return std::nullopt;
            }
        },
        medium);
}

bool all_one(const std::vector<double>& cosines) {
    return std::all_of(cosines.begin(), cosines.end(), [](double mu) { return mu == 1.0; });
}

}  // namespace

bool has_no_depth(const CoatMedium& coat) { return coat.optical_depth == 0.0; }

Scene without_empty_coats(Scene scene) {
    std::erase_if(scene.coats, has_no_depth);
    return scene;
}

bool wants_layers(const BrdfParts& parts) { return parts.subsurface || parts.total; }

bool wants_lobe(const Scene& scene, const BrdfParts& parts) {
    return scene.surface && (parts.surface || parts.total);
}

bool only_zenith(const rte::Directions& directions) {
    return all_one(directions.mu_in) || all_one(directions.mu_out);
}

bool only_across(const rte::Directions& directions) {
    return rte::fourier_order_vanishes(1, directions.azimuth_deg);
}

bool is_symmetric(const rte::Directions& directions) {
    return directions.mu_in == directions.mu_out;
}

bool absorbs_nothing(const ResolvedMedium& medium, double wavelength_nm, double k_floor) {
    if (const auto index = medium.index_at(wavelength_nm, k_floor)) return index->imag() == 0.0;
    return given_albedo(medium.medium) == 1.0;
}

bool scatters_nothing(const Medium& medium) { return given_albedo(medium) == 0.0; }

int most_orders(const Medium& medium) {
    if (std::holds_alternative<IsotropicMedium>(medium)) return 1;
    if (std::holds_alternative<RayleighMedium>(medium)) return 3;
    if (const auto* file = std::get_if<MomentsMedium>(&medium)) {
        return static_cast<int>(file->chi.size());
    }
    return 0;
}

int most_orders(const Scene& scene) {
    int most = most_orders(scene.base);
    bool known = most > 0;
    for (const CoatMedium& coat : scene.coats) {
        const int orders = most_orders(coat.medium);
        known = known && orders > 0;
        most = std::max(most, orders);
    }
    return known ? most : 0;
}

}  // namespace miebrdf
