// The words for particles: sizes, what lies between them, how crowded they are.
#include <fmt/format.h>

#include <vector>

#include "pipeline/scene/number_list.h"
#include "pipeline/scene/species_keys.h"
#include "pipeline/scene/word_setters.h"

namespace miebrdf {
namespace {

constexpr NamedValue<Packing> kPackings[] = {
    {"independent", Packing::independent},
    {"percus-yevick", Packing::percus_yevick},
    {"effective-host", Packing::effective_host},
    {"percus-yevick,effective-host", Packing::percus_yevick_effective_host}};

std::string list_of_laws() {
    std::string text;
    for (const auto& form : mie::size_distribution_forms())
        text += (text.empty() ? "" : ", ") + form.name;
    return text;
}

void set_host(const SceneWord& word, WordValues values, Request& request) {
    const std::string text = comma_separated(values);
    if (text.empty()) one_value(word, values);  // which refuses none
    request.scene.particles.host = host(text);
}

void set_effective_radius(const SceneWord& word, WordValues values, Request& request) {
    const WordValue& value = one_value(word, values);
    double& radius_um = request.scene.particles.sizes.effective_radius_um;
    if (const auto* text = std::get_if<std::string>(&value)) {
        radius_um = parse_length_um(*text, word.name);
    } else {
        radius_um = finite_number(value, word.name);
    }
}

void set_packing(const SceneWord& word, WordValues values, Request& request) {
    std::string text = comma_separated(values);
    if (text == "effective-host,percus-yevick") text = kPackings[3].name;
    const WordValue value = text;
    set_name<kPackings, &Request::scene, &Scene::particles, &ParticleOptions::packing>(
        word, {&value, 1}, request);
}

void set_layer_density(const SceneWord& word, WordValues values, Request& request) {
    const WordValue& value = one_value(word, values);
    const auto* text = std::get_if<std::string>(&value);
    request.scene.particles.layer_density_kg_m3 =
        text != nullptr ? parse_layer_density(*text, word.name) : finite_number(value, word.name);
}

template <auto member>
constexpr auto set_particle_number = set_number<&Request::scene, &Scene::particles, member>;

template <auto member>
constexpr auto set_size_number =
    set_number<&Request::scene, &Scene::particles, &ParticleOptions::sizes, member>;

}  // namespace

std::vector<SceneWord> particle_words() {
    const std::string group = "Particles (of media that go through Mie theory)";
    const ParticleOptions defaults;
    return {
        {.name = "effective-radius",
         .placeholder = "UM",
         .help = "effective radius <r^3>/<r^2> in um (or with a unit: 100nm) of media that give no "
                 "radius=",
         .group = group,
         .default_text = fmt::format("{}", defaults.sizes.effective_radius_um),
         .field = "effective_radius_um",
         .unit = "um",
         .set = set_effective_radius},
        {.name = "effective-variance",
         .placeholder = "V",
         .help = "effective variance of the radii of media that give no variance=",
         .group = group,
         .default_text = fmt::format("{}", defaults.sizes.effective_variance),
         .field = "effective_variance",
         .set = set_size_number<&mie::SizeDistribution::effective_variance>},
        {.name = "size-distribution",
         .placeholder = "NAME",
         .help = "size distribution of media that give no distribution=: " + list_of_laws(),
         .group = group,
         .default_text = name_of(defaults.sizes.kind),
         .field = "size_distribution",
         .set = set_text<mie::parse_size_distribution, &Request::scene, &Scene::particles,
                         &ParticleOptions::sizes, &mie::SizeDistribution::kind>},
        {.name = "host-index",
         .placeholder = "HOST",
         .help = "material between the particles of media that name no host (\"TiO2 in PMMA\" "
                 "names one): N, N,K or a material's name",
         .group = group,
         .default_text = "1",
         .field = "host_index",
         .set = set_host},
        {.name = "layer-density",
         .placeholder = "KG_M3",
         .help = "bulk density of the layers in kg/m3; needed for a thickness together with mass "
                 "fractions. Snow has 50 to 550",
         .group = group,
         .field = "layer_density_kg_m3",
         .unit = "kg/m3",
         .set = set_layer_density},
        {.name = "packing",
         .placeholder = "NAME",
         .help = "how particles that are close together scatter: independent, percus-yevick (as "
                 "hard spheres) or effective-host (each in a host into which the others are "
                 "mixed), or the last two with a comma between. All but independent need amounts",
         .group = group,
         .default_text = kPackings[0].name,
         .field = "packing",
         .set = set_packing},
        {.name = "k-floor",
         .placeholder = "K",
         .help = "smallest k of materials; smaller values are raised to it. At 550 nm H2O and "
                 "H2O_ice have 2e-9, soda_lime_glass 2e-7",
         .group = group,
         .default_text = fmt::format("{}", defaults.k_floor),
         .field = "k_floor",
         .set = set_particle_number<&ParticleOptions::k_floor>},
        {.name = "mie-tolerance",
         .placeholder = "ERROR",
         .help = "relative error of averages over particle sizes; 0: a fifth of the tolerance",
         .group = group,
         .default_text = fmt::format("{}", defaults.tolerance),
         .field = "mie_tolerance",
         .set = set_particle_number<&ParticleOptions::tolerance>}};
}

}  // namespace miebrdf
