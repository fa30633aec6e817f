#include "pipeline/fit/varied_spheres.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "pipeline/scene/species_keys.h"
#include "pipeline/solve/grain_shape.h"

namespace miebrdf::fitting {
namespace {

/// The medium without its amounts, where spheres are in it.
std::vector<Species> spheres_of(const Medium& medium) {
    std::vector<Species> spheres;
    for (Species species : medium.species) {
        species.amount = {};
        if (needs_mie(species)) spheres.push_back(std::move(species));
    }
    return spheres;
}

std::vector<const Medium*> media_of(const Scene& scene) {
    std::vector<const Medium*> media;
    if (!scene.substrate) media.push_back(&scene.base);
    for (const Layer& layer : scene.layers) media.push_back(&layer.medium);
    return media;
}

SphereChange change_of(Species a, Species b, const Scene& scene, const Scene& other) {
    const mie::SizeDistribution sizes = sizes_of(a, scene.particles),
                                others = sizes_of(b, other.particles);
    const bool is_alike = a.sizes == b.sizes &&
                          sizes.effective_radius_um == others.effective_radius_um &&
                          sizes.effective_variance == others.effective_variance;
    const bool has_width = mie::has_variance(sizes.kind);
    a.sizes = b.sizes = {};
    // Shapes are given to averages, which stay the same.
    if (averaged_words(std::move(a)) != averaged_words(std::move(b))) return SphereChange::other;
    if (is_alike) return SphereChange::none;
    return has_width ? SphereChange::sizes : SphereChange::other;
}

}  // namespace

SphereChange sphere_change(const Scene& a, const Scene& b) {
    SphereChange largest = SphereChange::none;
    const auto one = media_of(a), other = media_of(b);
    for (std::size_t m = 0; m < one.size(); ++m) {
        const auto spheres = spheres_of(*one[m]), others = spheres_of(*other[m]);
        if (spheres.size() != others.size()) return SphereChange::other;
        if (!spheres.empty() && host_of(a, *one[m]) != host_of(b, *other[m]))
            return SphereChange::other;
        for (std::size_t s = 0; s < spheres.size(); ++s)
            largest = std::max(largest, change_of(spheres[s], others[s], a, b));
    }
    return largest;
}

void VariedSizes::add(const Scene& scene) {
    const bool is_first = sizes_.empty();
    std::size_t next = 0;
    for (const Medium* const medium : media_of(scene)) {
        for (const Species& species : spheres_of(*medium)) {
            const mie::SizeDistribution sizes = sizes_of(species, scene.particles);
            if (!mie::has_variance(sizes.kind)) continue;
            const auto surface = species.sizes.specific_surface_m2_per_kg;
            if (is_first) {
                sizes_.push_back({sizes, surface});
                continue;
            }
            Sizes& known = sizes_[next++];
            const bool other_variance = known.sizes.effective_variance != sizes.effective_variance;
            if (!other_variance && known.sizes.effective_radius_um == sizes.effective_radius_um &&
                known.specific_surface_m2_per_kg == surface)
                continue;
            known.is_fixed = false;
            vary_ = true;
            variances_vary_ = variances_vary_ || other_variance;
        }
    }
}

std::vector<mie::SizeDistribution> VariedSizes::fixed() const {
    std::vector<mie::SizeDistribution> fixed;
    for (const Sizes& known : sizes_) {
        if (known.is_fixed) fixed.push_back(known.sizes);
    }
    return fixed;
}

}  // namespace miebrdf::fitting
