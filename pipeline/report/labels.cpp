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
    species.amount.reset();
    return species;
}

std::string amount_text(const Amount& amount) {
    switch (amount.kind) {
        case Amount::Kind::volume_fraction:
            return fmt::format("{:.4g} % of the volume", 100.0 * amount.value);
        case Amount::Kind::mass_fraction:
            if (amount.value < 1e-4)
                return fmt::format("{:.4g} ppb of the mass", 1e9 * amount.value);
            return fmt::format("{:.4g} % of the mass", 100.0 * amount.value);
        case Amount::Kind::number_per_cm3:
            return fmt::format("{:.4g} per cm\u00b3", amount.value);
    }
    return "";
}

std::string label_of_species(const Species& species) {
    std::string text = describe(bare(species));
    if (const auto radius = species.sizes.effective_radius_um)
        text += fmt::format(", radius {} \u00b5m", *radius);
    if (species.amount) text += ", " + amount_text(*species.amount);
    return text;
}

}  // namespace

std::string label_of(const Medium& medium) {
    std::string text;
    for (const Species& species : medium.species)
        text += (text.empty() ? "" : "; ") + label_of_species(species);
    if (medium.host) text += " in " + describe(*medium.host);
    return text;
}

std::string label_of(Scene scene) {
    const auto strip = [](Medium& medium) {
        for (Species& species : medium.species) species = bare(species);
    };
    strip(scene.base);
    for (Layer& layer : scene.layers) strip(layer.medium);
    return describe(scene);
}

}  // namespace miebrdf::report
