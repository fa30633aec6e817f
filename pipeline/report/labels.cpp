// Scenes in words for people: no option syntax.
#include <fmt/format.h>

#include <algorithm>

#include "pipeline/report/report_data.h"

namespace miebrdf::report {
namespace {

/// A species without its keys.
Species bare(Species species) {
    species.sizes = {};
    species.density_g_cm3.reset();
    species.layer_density_kg_m3.reset();
    species.amount.reset();
    return species;
}

}  // namespace

std::string label_of(Scene scene) {
    const auto strip = [](Medium& medium) {
        for (Species& species : medium.species) species = bare(species);
    };
    strip(scene.base);
    for (Layer& layer : scene.layers) strip(layer.medium);
    return describe(scene);
}

}  // namespace miebrdf::report
