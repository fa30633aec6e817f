#include "tools/miebrdf/render_options.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/program.h"

namespace miebrdf::program {
namespace {

void add_material_options(CLI::App& command, RenderArguments& a) {
    auto* group = command.add_option_group("Materials and regions");
    option(*group, "--material", a.materials, "'base=MEDIUM coat=MEDIUM@DEPTH roughness=A ...'",
           "one material in place of --base: its scene options in one string, without their "
           "dashes. Repeat it for several regions. Numbers of hg:, isotropic:, rayleigh: and "
           "index: may be lists a/b/c with one value for each wavelength")
        ->allow_extra_args(false);
    option(*group, "--split", a.split, "SHARE",
           "the first material on the left, the second on the right of a border at this fraction "
           "of the width");
    option(*group, "--mask", a.mask, "FILE.png",
           "picture whose grey levels choose the materials: black the first, white the last");
    option(*group, "--mask-projection", a.mask_projection, "",
           "how the mask is projected on the object: front or uv (texture coordinates)");
    option(*group, "--component", a.component, "", "total, subsurface or surface");
    option(*group, "--table", a.table, "N,N",
           "size of the table of light scattered more than once: number of cosines, largest number "
           "of azimuthal orders; 0: as many as needed");
    group->add_flag("--measure-interpolation", a.measure_interpolation,
                    "print the table's error between its nodes, against the solver");
}

void add_picture_options(CLI::App& command, RenderArguments& a) {
    auto* group = command.add_option_group("Picture");
    option(*group, "--object", a.object, "", "sphere, knot, plaque or FILE.obj");
    option(*group, "--light", a.lights, "LIGHT",
           "directional:ELEVATION,AZIMUTH[,IRRADIANCE], area:ELEVATION,AZIMUTH,SIZE[,IRRADIANCE], "
           "uniform:RADIANCE, sky:ELEVATION,AZIMUTH[,SCALE] or map:FILE[,SCALE] (.exr, .hdr); "
           "degrees, azimuth from the front to the right; repeat for more")
        ->allow_extra_args(false);
    option(
        *group, "--light-spectrum", a.light_spectrum, "",
        "spectrum of directional, area and uniform light: white (D65), equal or blackbody:KELVIN");
    option(*group, "--camera", a.camera, "ELEVATION,AZIMUTH",
           "elevation and azimuth of the camera in degrees");
    option(*group, "--field-of-view", a.field_of_view_deg, "", "degrees; 0: parallel rays");
    option(*group, "--zoom", a.zoom, "", "1: the object's bounding sphere touches the edges");
    option(*group, "--size", a.size, "WIDTH[,HEIGHT]",
           "size of the picture in pixels; one number: a square");
    option(*group, "--samples", a.options.samples, "", "paths for each pixel");
    option(*group, "--bounces", a.options.bounces, "",
           "largest number of reflections of a path; 1: direct light only");
    option(*group, "--clamp", a.options.clamp, "",
           "largest radiance (mean over the wavelengths) that one path may add by light reflected "
           "more than once; 0: no limit. It removes bright specks of rare paths; the share of "
           "light that it removes is printed");
    option(*group, "--seed", a.options.seed, "", "seed of the random samples");
    option(*group, "--exposure", a.exposure, "",
           "exposure of the PNG in stops: each doubles the brightness");
    option(*group, "--background", a.background, "",
           "background of the PNG: linear R,G,B in [0, 1], transparent or environment");
    option(*group, "--exr", a.exr, "FILE", "write linear RGB and every wavelength to FILE");
}

/// A word of a scene as it was written; switches have no value.
struct Word {
    std::string key;
    std::string value;
};

/// Words in which a slash separates the values of different wavelengths; elsewhere it may belong to
/// the name of a file.
bool may_have_lists(const Word& word) {
    if (word.key == "surface-index") return true;
    if (word.key != "base" && word.key != "coat") return false;
    const auto begins = [&](const char* kind) { return word.value.rfind(kind, 0) == 0; };
    return begins("hg:") || begins("isotropic:") || begins("rayleigh:") || begins("index:");
}

/// Replaces every list a/b/c between separators by its k-th value.
std::string value_at(const std::string& word, std::size_t k, std::size_t count) {
    constexpr char kSeparators[] = ":,@=";
    std::string result;
    for (std::size_t start = 0; start <= word.size();) {
        const std::size_t end = std::min(word.find_first_of(kSeparators, start), word.size());
        const auto parts = split_list(word.substr(start, end - start), '/');
        if (parts.size() != 1 && parts.size() != count) {
            throw UsageError(fmt::format("'{}': {} values for {} wavelengths",
                                         word.substr(start, end - start), parts.size(), count));
        }
        result += parts.size() == 1 ? parts[0] : parts[k];
        if (end < word.size()) result += word[end];
        start = end + 1;
    }
    return result;
}

/// Mixtures and hosts ("A + B in PMMA") have spaces of their own.
std::vector<Word> words_of(const std::string& text) {
    std::vector<std::string> parts;
    bool is_open = false;  // what follows "+" or "in" belongs to the medium before it
    for (const std::string& part : CLI::detail::split_up(text)) {
        if (part.empty()) continue;
        const bool joins = part == "+" || part == "in";
        if ((joins || is_open) && !parts.empty()) {
            parts.back() += ' ' + part;
        } else {
            parts.push_back(part);
        }
        is_open = joins;
    }
    std::vector<Word> words;
    for (const std::string& part : parts) {
        const std::size_t equals = part.find('=');
        if (equals == std::string::npos) {
            words.push_back({part, ""});
        } else {
            words.push_back({part.substr(0, equals), part.substr(equals + 1)});
        }
    }
    return words;
}

Request parse_words(const std::vector<Word>& words, const std::string& text) {
    const auto refuse = [&](const std::string& reason) {
        throw UsageError(fmt::format(
            "material '{}': {}; wanted: base=MEDIUM [coat=MEDIUM@DEPTH] [roughness=A] ...", text,
            reason));
    };
    SaidWords said;
    for (const Word& word : words) {
        const SceneWord* known = find_scene_word(word.key);
        if (word.key == "wavelengths") {
            throw UsageError(
                fmt::format("material '{}': wavelengths belong to the whole picture", text));
        }
        if (known == nullptr) {
            refuse(fmt::format("unknown word '{}'{}", word.key,
                               did_you_mean(word.key, scene_word_names("wavelengths"))));
        }
        const bool is_flag = known->kind == WordKind::flag;
        if (is_flag != word.value.empty()) {
            refuse(fmt::format("'{}' {}", word.key, is_flag ? "has no value" : "needs a value"));
        }
        if (known->kind != WordKind::repeated && said.count(word.key) > 0)
            refuse(fmt::format("'{}' is given twice", word.key));
        said[word.key].push_back(is_flag ? WordValue(true) : WordValue(word.value));
    }
    if (said.count("base") == 0) refuse("there is no base");
    return request_of(said);
}

}  // namespace

void add_render_options(CLI::App& command, RenderArguments& a) {
    add_material_options(command, a);
    add_picture_options(command, a);
}

std::vector<Request> parse_material(const std::string& text,
                                    const std::vector<double>& wavelength_nm) {
    const std::vector<Word> words = words_of(text);
    std::vector<Request> requests;
    bool has_lists = false;
    for (std::size_t k = 0; k < wavelength_nm.size(); ++k) {
        std::vector<Word> now = words;
        for (std::size_t i = 0; i < now.size(); ++i) {
            if (!may_have_lists(words[i])) continue;
            now[i].value = value_at(words[i].value, k, wavelength_nm.size());
            has_lists = has_lists || now[i].value != words[i].value;
        }
        requests.push_back(parse_words(now, text));
        requests.back().wavelength_nm = {wavelength_nm[k]};
        if (!has_lists) {
            requests.back().wavelength_nm = wavelength_nm;
            break;
        }
    }
    return requests;
}

}  // namespace miebrdf::program
