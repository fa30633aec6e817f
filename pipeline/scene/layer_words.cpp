// The words for what lies on what, and for what is above the layers.
#include <vector>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_parts.h"
#include "pipeline/scene/word_setters.h"

namespace miebrdf {
namespace {

constexpr NamedValue<materials::Interpolation> kInterpolations[] = {
    {"pchip", materials::Interpolation::pchip},
    {"linear", materials::Interpolation::linear_in_wavelength},
    {"linear-energy", materials::Interpolation::linear_in_energy}};
constexpr NamedValue<materials::Extrapolation> kExtrapolations[] = {
    {"refuse", materials::Extrapolation::refuse}, {"clamp", materials::Extrapolation::clamp}};
constexpr NamedValue<rte::SurfaceCoupling> kCouplings[] = {
    {"paper", rte::SurfaceCoupling::paper}, {"reciprocal", rte::SurfaceCoupling::reciprocal}};

void set_layers(const SceneWord&, WordValues values, Request& request) {
    request.scene.layers.clear();
    for (const WordValue& value : values) request.scene.layers.push_back(layer(text_of(value)));
}

void set_wavelengths(const SceneWord& word, WordValues values, Request& request) {
    std::vector<double>& list = request.wavelength_nm;
    list.clear();
    for (const WordValue& value : values) {
        if (std::holds_alternative<double>(value)) {
            list.push_back(finite_number(value, word.name));
            if (!(list.back() > 0.0)) throw UsageError(word.field, list.back(), "> 0");
        } else {
            const std::vector<double> some = parse_wavelengths_nm(text_of(value));
            list.insert(list.end(), some.begin(), some.end());
        }
    }
}

std::string file_name(std::string text) { return text; }

void set_boundary(const SceneWord&, WordValues values, Request& request) {
    request.scene.boundary = boundary(comma_separated(values));
}

void set_roughness(const SceneWord& word, WordValues values, Request& request) {
    const std::string text = comma_separated(values);
    if (text.empty()) one_value(word, values);  // which refuses none
    request.scene.surface = rough_surface(text);
}

void set_surface_index(const SceneWord& word, WordValues values, Request& request) {
    request.scene.surface_index = parse_index(values, word.name);
}

}  // namespace

std::vector<SceneWord> layer_words() {
    return {
        {.name = "base",
         .placeholder = "MEDIUM",
         .help = "medium at the bottom, infinitely deep: " + forms_of_media(),
         .field = "base",
         .set = set_text<medium, &Request::scene, &Scene::base>},
        {.name = "substrate",
         .placeholder = "GROUND",
         .help = "in place of the base: black, none (a free film), lambert:ALBEDO (a ground that "
                 "reflects alike in all directions; isotropic:ALBEDO is a medium of scatterers), "
                 "lambert:FILE.csv (wavelength_nm,albedo), mirror:MATERIAL, mirror:index:N,K, or a "
                 "natural ground in air: " +
                 forms_of_grounds() + " (degrees)",
         .field = "substrate",
         .set = set_text<substrate, &Request::scene, &Scene::substrate>},
        {.name = "coat",
         .placeholder = "MEDIUM@DEPTH",
         .help = "a layer on top of the base and of the coats before it; repeat it for more. DEPTH "
                 "is an optical depth at 550 nm that follows the extinction (0.1), at another "
                 "wavelength (0.1[450nm]) or the same at every wavelength (0.1[grey]), a thickness "
                 "(40um, 2mm: "
                 "needs amounts), a mass (2kg/m2: needs densities) or inf, which hides everything "
                 "below",
         .kind = WordKind::repeated,
         .field = "layers",
         .set = set_layers},
        {.name = "wavelengths",
         .placeholder = "LIST",
         .help =
             "numbers, or ranges first:last:step, in nm unless they have a unit: 450,550,650 or "
             "400:700:10 or 0.55um or 2.25eV; rgb is 620,535,480",
         .default_text = "rgb",
         .field = "wavelength_nm",
         .unit = "nm",
         .set = set_wavelengths},
        {.name = "database",
         .placeholder = "FILE",
         .help = "database of your own materials, beside those that are built in; default: "
                 "$MIEBRDF_DATABASE, else $XDG_DATA_HOME/miebrdf/materials.sqlite",
         .field = "database",
         .set = set_text<file_name, &Request::scene, &Scene::database>},
        {.name = "interpolation",
         .placeholder = "NAME",
         .help = "how n and k are interpolated between their rows: pchip (monotone, in photon "
                 "energy), linear (in wavelength, as in other tools) or linear-energy",
         .default_text = kInterpolations[0].name,
         .field = "interpolation",
         .set = set_name<kInterpolations, &Request::scene, &Scene::index,
                         &materials::IndexOptions::interpolation>},
        {.name = "extrapolate",
         .placeholder = "NAME",
         .help = "at wavelengths beyond a material's data: refuse, or clamp (take the value of the "
                 "nearer end; outputs say so)",
         .default_text = kExtrapolations[0].name,
         .field = "extrapolation",
         .set = set_name<kExtrapolations, &Request::scene, &Scene::index,
                         &materials::IndexOptions::extrapolation>},
        {.name = "missing-k-zero",
         .help = "take k = 0 where only n of a material is known, instead of an error (the "
                 "output's source line says at how many wavelengths)",
         .kind = WordKind::flag,
         .field = "missing_k_is_zero",
         .set = set_switch<true, &Request::scene, &Scene::index,
                           &materials::IndexOptions::missing_k_is_zero>}};
}

std::vector<SceneWord> surface_words() {
    const std::string group = "Surface";
    return {
        {.name = "boundary",
         .placeholder = "NAME",
         .help =
             "refracting boundary between air and the host of the top layer (paint, varnish, ice): "
             "smooth, or rough:ALPHA[,beckmann or ggx] with ALPHA from 0.02 to 1 (0 is smooth)",
         .group = group,
         .field = "boundary",
         .set = set_boundary},
        {.name = "roughness",
         .placeholder = "ALPHA",
         .help = "opaque rough surface on top (the paper's): slope parameter of Beckmann's "
                 "distribution, or ALPHA,ggx; 0: no surface",
         .group = group,
         .default_text = "0",
         .field = "roughness",
         .set = set_roughness},
        {.name = "coupling",
         .placeholder = "NAME",
         .help = "where the rough surface weakens the light of the layers: paper (eq. 5: only on "
                 "the way in) or reciprocal (on the way in and out)",
         .group = group,
         .default_text = kCouplings[0].name,
         .field = "coupling",
         .set = set_name<kCouplings, &Request::scene, &Scene::coupling>},
        {.name = "surface-index",
         .placeholder = "N,K",
         .help = "refractive index of the surface; default: that of the top layer's host if it has "
                 "one, else of its particles",
         .group = group,
         .field = "surface_index",
         .set = set_surface_index}};
}

}  // namespace miebrdf
