// A sweep: one scene with gaps, the values that fill them, and what is wanted of every scene.
//
// Scenes are numbered in the order of the table: the first dimension advances slowest.
#pragma once

#include <miebrdf/brdf.h>
#include <miebrdf/colour.h>

#include <miebrdf/error.h>

#include <cstddef>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "pipeline/scene/scene_template.h"
#include "pipeline/solve/resolved_scene.h"

namespace miebrdf::sweep {

/// A name and its values.
struct Axis {
    std::string name = {};
    std::vector<std::string> words = {};  ///< as somebody would type them
    std::vector<double> numbers = {};     ///< the same; empty: texts, such as names of materials
    std::string unit = {};                ///< "um"; empty: none
    bool is_logarithmic = false;          ///< even steps of the logarithm

    std::size_t size() const { return words.size(); }
    bool is_text() const { return numbers.empty(); }
};

inline auto fields(const Axis& value) {
    const auto& [name, words, numbers, unit, is_logarithmic] = value;
    return std::tie(name, words, numbers, unit, is_logarithmic);
}

/// Axes that advance together: one of its own, or the columns of a file.
struct Dimension {
    std::string name = {};
    std::vector<Axis> axes = {};  ///< of the same length, at least one

    std::size_t size() const { return axes.front().size(); }
    /// Whether its values are coordinates: a single axis of the dimension's name.
    bool is_coordinate() const { return axes.size() == 1 && axes.front().name == name; }
};

inline auto fields(const Dimension& value) {
    const auto& [name, axes] = value;
    return std::tie(name, axes);
}

enum class Output {
    brdf,
    plane_albedo,
    spherical_albedo,
    plane_transmittance,
    spherical_transmittance,
    colour,
    contrast_ratio,  ///< of a film: Y over black by Y over a white of 0.8
    mueller,         ///< m11, m12, ...: 3 x 3, with `stokes = 4` of the first scene 4 x 4
    hdrf,            ///< under sun and sky: Sweep::diffuse_fraction
    emissivity,      ///< towards each mu_in, 1 - plane albedo (Kirchhoff)
};

/// How the values of a table are laid out: CF's conventions, eradiate.h, satellite.h.
enum class TableLayout { cf, eradiate, isofit, isofit_surface, crtm_snow };

struct Sweep {
    std::string title = {};
    std::vector<TemplateWord> words = {};
    std::vector<Dimension> dimensions = {};  ///< of scenes, the slowest first
    /// The number of dimensions, the first ones, that change single scattering (order_for_sharing).
    std::size_t optical_dimensions = 0;
    /// The points that one solution is asked at; axes without values are not wanted. Angles of
    /// incidence and reflection are cosines or, by their names, degrees.
    Axis wavelength, incidence, reflection, azimuth;
    std::vector<Output> outputs = {};
    /// Parameters that the outputs have derivatives by: axes of scenes, numbers that have names in
    /// words, n(NAME), k(NAME).
    std::vector<std::string> derivatives = {};
    Viewing viewing = {};
    double diffuse_fraction = 0.0;  ///< of the light of hdrf, in [0, 1]
    Sky sky = {};                   ///< that this share comes from
    TableLayout table_layout = TableLayout::cf;
    std::size_t scenes_per_chunk = 0;  ///< as the file says; 0: chosen
    std::string text = {};             ///< the file, for the provenance of tables
    std::string folder = {};           ///< of the file: files in its words are looked for there

    std::size_t scenes() const;
    /// Scenes with the same place along the optical dimensions: they share Mie theory.
    std::size_t scenes_per_group() const;
    bool wants(Output output) const;
    bool for_eradiate() const { return table_layout == TableLayout::eradiate; }
    /// Anything with directions of reflection.
    bool wants_matrices_or_brdf() const {
        return wants(Output::brdf) || wants(Output::mueller) || wants(Output::hdrf);
    }
    /// Anything that takes all wavelengths together.
    bool wants_spectra() const { return wants(Output::colour) || wants(Output::contrast_ratio); }
    /// Anything that Fourier order 0 has.
    bool wants_albedos() const;
    /// Null if there is none of this name.
    const Axis* find_axis(const std::string& name) const;
    Directions directions() const;
};

const char* name_of(Output output);

/// Index along every dimension.
std::vector<std::size_t> place_of(const Sweep& sweep, std::size_t scene);

/// The scene of this number.
/// @throws UsageError, InputError  for values that no scene can have
Request request_of(const Sweep& sweep, std::size_t scene);

/// Wavelengths of a scene that cannot be computed, and why.
struct Refusal {
    std::vector<std::size_t> wavelengths = {};  ///< places along the axis
    std::string reason = {};
};

/// A scene with its names looked up, as far as it can be computed.
struct SceneLookUp {
    Request request = {};
    std::vector<ResolvedScene> parts = {};  ///< its wavelengths together, or those that it covers
    std::vector<std::size_t> wavelengths = {};  ///< places along the axis that can be computed
    std::vector<Refusal> refusals = {};         ///< the others
};

/// Looks a scene up and asks every wavelength whether it can be computed, computing nothing: what
/// only computing can tell is left out (require_computable of pipeline/solve/scene_optics.h).
/// Mistakes of the scene are a result, not an exception.
/// @param memo  of names; null: none
SceneLookUp look_up(const Sweep& sweep, std::size_t scene, NamedIndexMemo* memo = nullptr);

/// Calls `use` for places along the axis of wavelengths: all together, where it throws an Error
/// each half for itself; `refuse` for the single ones where it throws.
void use_wavelengths(const std::vector<std::size_t>& places,
                     const std::function<void(const std::vector<std::size_t>&)>& use,
                     const std::function<void(std::size_t place, const Error&)>& refuse);

/// The wavelengths at these places.
std::vector<double> wavelengths_at(const Sweep& sweep, const std::vector<std::size_t>& places);

/// "400, 500 nm"; the first of many.
std::string describe_wavelengths(const Sweep& sweep, const std::vector<std::size_t>& places);

/// Moves the dimensions that change single scattering to the front, so that scenes that share it
/// follow each other. Which these are is found by looking up the first scene and its neighbours
/// along each dimension.
void order_for_sharing(Sweep& sweep);

/// Looks up what can be looked up before anything runs: the first scene, each value of an axis of
/// texts.
/// @throws UsageError, InputError  the first scene's, if no neighbour of it can be solved either;
///         the one of a text
void check_names(const Sweep& sweep);

}  // namespace miebrdf::sweep
