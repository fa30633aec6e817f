#include "pipeline/scene/scene_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"

namespace miebrdf {
namespace {

using Values = std::span<const WordValue>;

/// The only value of a word.
const WordValue& one_value(const SceneWord& word, Values values) {
    if (values.size() != 1)
        throw UsageError(fmt::format("{}: takes one value; given: {}", word.name, values.size()));
    return values.front();
}

double number(const WordValue& value, const std::string& what) {
    const auto* given = std::get_if<double>(&value);
    if (given == nullptr) return parse_number(text_of(value), what);
    if (std::isfinite(*given)) return *given;
    throw UsageError(fmt::format("{}: {} is not a finite number", what, *given));
}

int whole_number(const WordValue& value, const std::string& what) {
    const double found = number(value, what);
    if (found != std::floor(found) || std::abs(found) > 1e9)
        throw UsageError(fmt::format("{}: {} is not a whole number", what, found));
    return int(found);
}

bool is_on(const SceneWord& word, const WordValue& value) {
    if (const auto* on = std::get_if<bool>(&value)) return *on;
    throw UsageError(fmt::format("{} is true or false", word.name));
}

/// Names of the values of an enumeration, in the order in which help texts list them.
template <typename Value>
using Names = std::vector<std::pair<const char*, Value>>;

const Names<rte::SurfaceCoupling> kCouplings = {{"paper", rte::SurfaceCoupling::paper},
                                                {"reciprocal", rte::SurfaceCoupling::reciprocal}};
const Names<Packing> kPackings = {{"independent", Packing::independent},
                                  {"percus-yevick", Packing::percus_yevick}};
const Names<rte::GridKind> kGrids = {{"auto", rte::GridKind::automatic},
                                     {"gauss", rte::GridKind::gauss},
                                     {"mapped-gauss", rte::GridKind::mapped_gauss},
                                     {"paper", rte::GridKind::paper}};
const Names<rte::HalfSpaceMethod> kHalfSpaceMethods = {
    {"auto", rte::HalfSpaceMethod::automatic},
    {"fixed-point", rte::HalfSpaceMethod::fixed_point},
    {"doubling", rte::HalfSpaceMethod::doubling}};
const Names<rte::CoatMethod> kCoatMethods = {
    {"auto", rte::CoatMethod::automatic},
    {"first-order", rte::CoatMethod::first_order},
    {"first-order-patched", rte::CoatMethod::first_order_patched},
    {"exponential", rte::CoatMethod::exponential}};

const Names<materials::Interpolation> kInterpolations = {
    {"pchip", materials::Interpolation::pchip},
    {"linear", materials::Interpolation::linear_in_wavelength},
    {"linear-energy", materials::Interpolation::linear_in_energy}};
const Names<materials::Extrapolation> kExtrapolations = {
    {"refuse", materials::Extrapolation::refuse}, {"clamp", materials::Extrapolation::clamp}};

template <typename Value>
std::string list_of(const Names<Value>& names) {
    std::string text;
    for (const auto& [name, value] : names) text += (text.empty() ? "" : ", ") + std::string(name);
    return text;
}

/// The value of this name; a message lists them all.
template <typename Value>
Value one_of(const Names<Value>& names, const SceneWord& word, Values values) {
    const std::string asked = text_of(one_value(word, values));
    for (const auto& [name, value] : names) {
        if (asked == name) return value;
    }
    throw UsageError(fmt::format("unknown {} '{}'; allowed: {}", word.name, asked, list_of(names)));
}

void set_roughness(const SceneWord& word, Values values, Request& request) {
    const double alpha = number(one_value(word, values), word.name);
    if (!(alpha >= 0.0 && alpha <= 2.0)) throw UsageError(word.field, alpha, "0 (no lobe) to 2");
    request.scene.surface.reset();
    if (alpha > 0.0) request.scene.surface = rte::SurfaceOptions{.beckmann_alpha = alpha};
}

void set_wavelengths(const SceneWord& word, Values values, Request& request) {
    std::vector<double>& list = request.wavelength_nm;
    list.clear();
    for (const WordValue& value : values) {
        if (std::holds_alternative<double>(value)) {
            list.push_back(number(value, word.name));
            if (!(list.back() > 0.0)) throw UsageError(word.field, list.back(), "> 0");
        } else {
            const std::vector<double> some = parse_wavelengths_nm(text_of(value));
            list.insert(list.end(), some.begin(), some.end());
        }
    }
}

/// A word for one number that is stored as it is.
template <typename Number>
void set_number(const SceneWord& word, Values values, Number& number_of_request) {
    if constexpr (std::is_same_v<Number, int>) {
        number_of_request = whole_number(one_value(word, values), word.name);
    } else {
        number_of_request = number(one_value(word, values), word.name);
    }
}

std::vector<SceneWord> layer_words() {
    return {
        {.name = "base",
         .placeholder = "MEDIUM",
         .help = "what lies at the bottom, infinitely deep: " + forms_of_media(),
         .field = "base",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.scene.base = medium(text_of(one_value(word, values)));
             }},
        {.name = "substrate",
         .placeholder = "GROUND",
         .help = "in place of the base: black, none (a free film), lambert:ALBEDO (a ground that "
                 "reflects alike in all directions; isotropic:ALBEDO is a medium of scatterers) or "
                 "lambert:FILE.csv (wavelength_nm,albedo)",
         .field = "substrate",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.scene.substrate = substrate(text_of(one_value(word, values)));
             }},
        {.name = "coat",
         .placeholder = "MEDIUM@DEPTH",
         .help = "a layer on top of the base and of the coats before it; repeat it for more. DEPTH "
                 "is an optical depth at 550 nm that follows the extinction (0.1), at another "
                 "wavelength (0.1[450nm]) or the same at all (0.1[grey]), a thickness (40um, 2mm: "
                 "needs amounts), a mass (2kg/m2: needs densities) or inf, which hides everything "
                 "below",
         .kind = WordKind::repeated,
         .field = "layers",
         .set =
             [](const SceneWord&, Values values, Request& request) {
                 request.scene.layers.clear();
                 for (const WordValue& value : values)
                     request.scene.layers.push_back(layer(text_of(value)));
             }},
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
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.scene.database = text_of(one_value(word, values));
             }},
        {.name = "interpolation",
         .placeholder = "NAME",
         .help = "of n and k between their rows: pchip (monotone in photon energy), linear (in "
                 "wavelength, as other tools) or linear-energy",
         .default_text = kInterpolations.front().first,
         .field = "interpolation",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.scene.index.interpolation = one_of(kInterpolations, word, values);
             }},
        {.name = "extrapolate",
         .placeholder = "NAME",
         .help =
             "where a material has no data: refuse, or clamp to the nearer end (outputs say so)",
         .default_text = kExtrapolations.front().first,
         .field = "extrapolation",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.scene.index.extrapolation = one_of(kExtrapolations, word, values);
             }},
        {.name = "missing-k-zero",
         .help = "k = 0 where a material's n is known and k is not, instead of an error",
         .kind = WordKind::flag,
         .field = "missing_k_is_zero",
         .set = [](const SceneWord& word, Values values, Request& request) {
             request.scene.index.missing_k_is_zero = is_on(word, one_value(word, values));
         }}};
}

std::vector<SceneWord> surface_words() {
    const std::string group = "Surface";
    return {
        {.name = "roughness",
         .placeholder = "ALPHA",
         .help = "rough surface on top, with this Beckmann slope parameter; 0: no surface",
         .group = group,
         .default_text = "0",
         .field = "roughness",
         .set = set_roughness},
        {.name = "coupling",
         .placeholder = "NAME",
         .help = "how the surface weakens the light that goes into the layers and comes out: paper "
                 "(eq. 5: on the way in alone) or reciprocal (both ways)",
         .group = group,
         .default_text = kCouplings.front().first,
         .field = "coupling",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.scene.coupling = one_of(kCouplings, word, values);
             }},
        {.name = "surface-index",
         .placeholder = "N,K",
         .help = "refractive index of the surface; default: that of the top medium",
         .group = group,
         .field = "surface_index",
         .set = [](const SceneWord&, Values values, Request& request) {
             request.scene.surface_index = parse_index(values, "surface-index");
         }}};
}

std::string list_of_laws() {
    std::string text;
    for (const auto& form : mie::size_distribution_forms())
        text += (text.empty() ? "" : ", ") + form.name;
    return text;
}

std::vector<SceneWord> particle_words() {
    const std::string group = "Particles (of media that go through Mie theory)";
    const ParticleOptions defaults;
    return {{.name = "effective-radius",
             .placeholder = "UM",
             .help = "effective radius <r^3>/<r^2> in um, of media that do not say their own",
             .group = group,
             .default_text = fmt::format("{}", defaults.sizes.effective_radius_um),
             .field = "effective_radius_um",
             .unit = "um",
             .set =
                 [](const SceneWord& word, Values values, Request& request) {
                     set_number(word, values, request.scene.particles.sizes.effective_radius_um);
                 }},
            {.name = "effective-variance",
             .placeholder = "V",
             .help = "effective variance of the radii, of media that do not say their own",
             .group = group,
             .default_text = fmt::format("{}", defaults.sizes.effective_variance),
             .field = "effective_variance",
             .set =
                 [](const SceneWord& word, Values values, Request& request) {
                     set_number(word, values, request.scene.particles.sizes.effective_variance);
                 }},
            {.name = "size-distribution",
             .placeholder = "NAME",
             .help = "law of the radii, of media that do not say their own: " + list_of_laws(),
             .group = group,
             .default_text = name_of(defaults.sizes.kind),
             .field = "size_distribution",
             .set =
                 [](const SceneWord& word, Values values, Request& request) {
                     request.scene.particles.sizes.kind =
                         mie::parse_size_distribution(text_of(one_value(word, values)));
                 }},
            {.name = "host-index",
             .placeholder = "HOST",
             .help = "what lies between the particles, of media that do not say it (TiO2 in PMMA): "
                     "N, N,K or a material's name",
             .group = group,
             .default_text = "1",
             .field = "host_index",
             .set =
                 [](const SceneWord& word, Values values, Request& request) {
                     std::string text;
                     for (const WordValue& value : values) {
                         if (!text.empty()) text += ',';
                         text += text_of(value);
                     }
                     if (text.empty()) one_value(word, values);
                     request.scene.particles.host = host(text);
                 }},
            {.name = "layer-density",
             .placeholder = "KG_M3",
             .help = "bulk density of the layers in kg/m3, where mass fractions and a thickness "
                     "meet; snow has 50 to 550",
             .group = group,
             .field = "layer_density_kg_m3",
             .unit = "kg/m3",
             .set =
                 [](const SceneWord& word, Values values, Request& request) {
                     double density = 0.0;
                     set_number(word, values, density);
                     request.scene.particles.layer_density_kg_m3 = density;
                 }},
            {.name = "packing",
             .placeholder = "NAME",
             .help = "how crowded particles scatter: " + list_of(kPackings) +
                     " (hard spheres that see their own kind; needs amounts)",
             .group = group,
             .default_text = kPackings.front().first,
             .field = "packing",
             .set =
                 [](const SceneWord& word, Values values, Request& request) {
                     request.scene.particles.packing = one_of(kPackings, word, values);
                 }},
            {.name = "k-floor",
             .placeholder = "K",
             .help = "smallest absorption index k: smaller ones of a material are raised to this",
             .group = group,
             .default_text = fmt::format("{}", defaults.k_floor),
             .field = "k_floor",
             .set =
                 [](const SceneWord& word, Values values, Request& request) {
                     set_number(word, values, request.scene.particles.k_floor);
                 }},
            {.name = "mie-tolerance",
             .placeholder = "ERROR",
             .help = "relative error of averages over sizes; 0: a share of the tolerance",
             .group = group,
             .default_text = fmt::format("{}", defaults.tolerance),
             .field = "mie_tolerance",
             .set = [](const SceneWord& word, Values values, Request& request) {
                 set_number(word, values, request.scene.particles.tolerance);
             }}};
}

std::vector<SceneWord> method_words() {
    const std::string group = "Method";
    const rte::SolverOptions defaults;
    return {
        {.name = "tolerance",
         .placeholder = "ERROR",
         .help = "largest error, relative to the largest BRDF value at the same incidence",
         .group = group,
         .default_text = fmt::format("{}", defaults.tolerance),
         .field = "tolerance",
         .set = [](const SceneWord& word, Values values,
                   Request& request) { set_number(word, values, request.solver.tolerance); }},
        {.name = "streams",
         .placeholder = "N",
         .help =
             fmt::format("directions (zenith nodes) of each hemisphere, {} to {}; 0: as many as "
                         "the tolerance needs",
                         rte::kFewestNodes, rte::kMostNodes),
         .group = group,
         .default_text = fmt::format("{}", defaults.streams),
         .field = "streams",
         .set = [](const SceneWord& word, Values values,
                   Request& request) { set_number(word, values, request.solver.streams); }},
        {.name = "grid",
         .placeholder = "NAME",
         .help = "where these directions lie: " + list_of(kGrids),
         .group = group,
         .default_text = kGrids.front().first,
         .field = "grid",
         .set = [](const SceneWord& word, Values values,
                   Request& request) { request.solver.grid = one_of(kGrids, word, values); }},
        {.name = "half-space-method",
         .placeholder = "NAME",
         .help = "how the base is solved: " + list_of(kHalfSpaceMethods),
         .group = group,
         .default_text = kHalfSpaceMethods.front().first,
         .field = "half_space_method",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.solver.half_space_method = one_of(kHalfSpaceMethods, word, values);
             }},
        {.name = "coat-method",
         .placeholder = "NAME",
         .help = "how coats are solved: " + list_of(kCoatMethods),
         .group = group,
         .default_text = kCoatMethods.front().first,
         .field = "coat_method",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.solver.coat_method = one_of(kCoatMethods, word, values);
             }},
        {.name = "coat-substeps",
         .placeholder = "N",
         .help = "steps for each coat, of a coat method that goes in steps",
         .group = group,
         .default_text = fmt::format("{}", defaults.coat_substeps),
         .field = "coat_substeps",
         .set = [](const SceneWord& word, Values values,
                   Request& request) { set_number(word, values, request.solver.coat_substeps); }},
        {.name = "no-delta-m",
         .help = "do not truncate the forward peak of the phase function",
         .group = group,
         .kind = WordKind::flag,
         .field = "delta_m",
         .set =
             [](const SceneWord& word, Values values, Request& request) {
                 request.solver.delta_m = !is_on(word, one_value(word, values));
             }},
        {.name = "no-single-scattering-correction",
         .help = "do not replace light that is scattered once by its exact value",
         .group = group,
         .kind = WordKind::flag,
         .field = "single_scattering_correction",
         .set = [](const SceneWord& word, Values values, Request& request) {
             request.solver.single_scattering_correction = !is_on(word, one_value(word, values));
         }}};
}

}  // namespace

std::string forms_of_media() {
    std::string text;
    for (const MediumForm& form : medium_forms()) text += (text.empty() ? "" : ", ") + form.form;
    return text +
           "; particles may have sizes of their own: "
           "TiO2,radius=0.2,variance=0.1,distribution=gamma; mixtures and hosts: "
           "\"TiO2,radius=0.13,volume=15% + carbon,radius=0.04,mass=1% in PMMA\"";
}

const std::vector<SceneWord>& scene_words() {
    static const std::vector<SceneWord> words = [] {
        std::vector<SceneWord> all;
        for (auto& some : {layer_words(), surface_words(), particle_words(), method_words()})
            all.insert(all.end(), some.begin(), some.end());
        return all;
    }();
    return words;
}

const SceneWord* find_scene_word(std::string_view name) {
    for (const SceneWord& word : scene_words()) {
        if (word.name == name) return &word;
    }
    return nullptr;
}

void apply(const SceneWord& word, std::span<const WordValue> values, Request& request) {
    word.set(word, values, request);
}

std::string text_of(const WordValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (const auto* given = std::get_if<double>(&value)) return fmt::format("{}", *given);
    return std::get<bool>(value) ? "true" : "false";
}

std::complex<double> parse_index(std::span<const WordValue> values, const std::string& what) {
    std::vector<double> parts;
    for (const WordValue& value : values) {
        if (std::holds_alternative<double>(value)) {
            parts.push_back(number(value, what));
            continue;
        }
        for (const std::string& part : split_list(text_of(value)))
            parts.push_back(parse_number(part, what));
    }
    if (parts.empty() || parts.size() > 2) {
        throw UsageError(
            fmt::format("{}: {} numbers; write N,K, e.g. 1.5,0, or N alone", what, parts.size()));
    }
    const double n = parts[0], k = parts.size() == 2 ? parts[1] : 0.0;
    if (!(n > 0.0 && k >= 0.0)) {
        throw UsageError(
            fmt::format("{}: {} + {}i is out of range; allowed: n > 0, k >= 0", what, n, k));
    }
    return {n, k};
}

}  // namespace miebrdf
