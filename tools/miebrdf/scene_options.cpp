#include "tools/miebrdf/scene_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include <miebrdf/error.h>
#include "materials/database/user_file.h"
#include "pipeline/scene/species_keys.h"

namespace miebrdf::program {
namespace {

/// "power-law, effective radius 50 um, effective variance 0.2"
std::string sizes_text(const Species& species, const ParticleOptions& of_scene) {
    const mie::SizeDistribution sizes = sizes_of(species, of_scene);
    std::string text = name_of(sizes.kind) + ", ";
    if (const auto surface = species.sizes.specific_surface_m2_per_kg) {
        text += fmt::format("specific surface {} m2/kg", *surface);
    } else {
        text += fmt::format("effective radius {} um", mie::effective_radius_of(sizes));
    }
    if (mie::has_variance(sizes.kind))
        text += fmt::format(", effective variance {}", sizes.effective_variance);
    return text;
}

/// "TiO2" of "TiO2,radius=0.1".
std::string without_sizes(Species species) {
    species.sizes = {};
    return describe(species);
}

/// "a host of index 1.5", "PMMA"
std::string host_text(const Host& host) {
    if (!host.name.empty()) return host.name;
    const double n = host.index.real(), k = host.index.imag();
    return k == 0.0 ? fmt::format("a host of index {}", n)
                    : fmt::format("a host of index {} + {}i", n, k);
}

/// A roughness of 0 that was said is a choice, with the rest of the surface ready for another.
void require_surface_of_index(bool has_index, bool has_roughness) {
    if (!has_index || has_roughness) return;
    throw UsageError("--surface-index belongs to a rough surface; give --roughness too, e.g. 0.3");
}

}  // namespace

TableOptions as_evaluated(const Brdf& brdf, BrdfPart part, const Shell& shell) {
    return {.part = part,
            .command_line = shell.command_line(),
            .coupling = brdf.scene().coupling.value_or(rte::SurfaceCoupling::paper)};
}

Brdf solved(const Request& request, const Control& control) {
    return solve(request.scene, request.wavelength_nm, request.solver, control);
}

Request request_of(const SaidWords& said) {
    Request request;
    for (const auto& [name, values] : said) apply(*find_scene_word(name), values, request);
    require_surface_of_index(said.count("surface-index") > 0, said.count("roughness") > 0);
    return request;
}

std::vector<std::string> words_of_media() {
    return {"wavelengths",       "database",    "effective-radius", "effective-variance",
            "size-distribution", "host-index",  "k-floor",          "mie-tolerance",
            "interpolation",     "extrapolate", "missing-k-zero"};
}

void SceneArguments::add_to(CLI::App& command, Shell& shell, Base base,
                            const std::string& default_wavelengths) {
    needs_base_ = base == Base::required;
    default_wavelengths_ = default_wavelengths;
    add(command, shell, scene_word_names());
}

void SceneArguments::add_to(CLI::App& command, Shell& shell, const std::vector<std::string>& words,
                            const std::string& default_wavelengths) {
    default_wavelengths_ = default_wavelengths;
    add(command, shell, words);
}

void SceneArguments::add(CLI::App& command, Shell& shell, const std::vector<std::string>& words) {
    result_ = shell.scene_file_result();
    shell_ = &shell;
    std::map<std::string, CLI::App*> groups = {{"", &command}};
    for (const std::string& name : words) {
        const SceneWord& word = *find_scene_word(name);
        shell.add_scene_word(name);
        CLI::App*& group = groups[word.group];
        if (group == nullptr) group = command.add_option_group(word.group);
        if (word.kind == WordKind::flag) {
            group->add_flag("--" + name, flags_[name], word.help);
            continue;
        }
        auto* option =
            group->add_option("--" + name, values_[name], word.help)->type_name(word.placeholder);
        if (word.kind != WordKind::repeated) option->expected(1);
        option->allow_extra_args(false);
        const std::string& by_default =
            name == "wavelengths" ? default_wavelengths_ : word.default_text;
        if (!by_default.empty()) option->default_str(by_default);
    }
}

SaidWords SceneArguments::typed() const {
    SaidWords said;
    for (const auto& [name, texts] : values_) {
        if (!texts.empty()) said[name] = {texts.begin(), texts.end()};
    }
    for (const auto& [name, on] : flags_) {
        if (on) said[name] = {true};
    }
    return said;
}

bool SceneArguments::given(std::string_view word) const {
    const std::string name(word);
    if (result_ != nullptr)
        return std::find(result_->words.begin(), result_->words.end(), name) !=
               result_->words.end();
    const auto values = values_.find(name);
    if (values != values_.end()) return !values->second.empty();
    const auto flag = flags_.find(name);
    return flag != flags_.end() && flag->second;
}

Request SceneArguments::parse() const {
    if (needs_base_ && !given("base") && !given("substrate"))
        throw UsageError("--base or --substrate is required");
    if (given("base") && given("substrate")) {
        throw UsageError(
            "--base and --substrate: a scene has one of them; a substrate lies in place of a base");
    }
    Request request = result_ != nullptr ? result_->request : request_of(typed());
    require_surface_of_index(given("surface-index"), given("roughness"));
    note_default_sizes(request.scene);
    return complete(std::move(request));
}

void SceneArguments::note_default_sizes(const Scene& scene) const {
    // Scene files say what they have in the header of every result.
    if (result_ != nullptr || given("effective-radius")) return;
    const auto find = [](const Medium& medium) -> const Species* {
        for (const Species& species : medium.species) {
            if (needs_mie(species) && !states_radius(species)) return &species;
        }
        return nullptr;
    };
    const Species* found = scene.substrate ? nullptr : find(scene.base);
    for (const Layer& layer : scene.layers) {
        if (found == nullptr) found = find(layer.medium);
    }
    if (found == nullptr) return;
    shell_->note_at_end(fmt::format(
        "no radius is given for {}: its spheres have the sizes of the paper ({}); a radius is "
        "written {},radius=0.1 (um) or ,radius=100nm",
        describe(*found), sizes_text(*found, scene.particles), describe(*found)));
}

Request SceneArguments::complete(Request request) const {
    if (request.wavelength_nm.empty())
        apply(*find_scene_word("wavelengths"), std::vector<WordValue>{default_wavelengths_},
              request);
    if (request.scene.database.empty())
        request.scene.database = materials::from_environment("MIEBRDF_DATABASE");
    return request;
}

std::string describe_particles(const Medium& medium, const ParticleOptions& particles) {
    if (!needs_mie(medium)) return "";
    const std::string host = host_text(medium.host.value_or(particles.host));
    if (medium.species.size() == 1)
        return fmt::format("{}, in {}", sizes_text(medium.species.front(), particles), host);
    std::string text;
    for (const Species& species : medium.species) {
        text += fmt::format("{}: {}; ", without_sizes(species), sizes_text(species, particles));
    }
    return text + "in " + host;
}

std::string describe_particles(const Scene& scene) {
    struct Part {
        std::string name, sizes, host;
    };
    std::vector<Part> parts;
    const auto add = [&](const std::string& place, const Medium& medium) {
        for (const Species& species : medium.species) {
            if (!needs_mie(species)) continue;
            parts.push_back({place + " " + without_sizes(species),
                             sizes_text(species, scene.particles),
                             host_text(medium.host.value_or(scene.particles.host))});
        }
    };
    if (!scene.substrate) add("base", scene.base);
    for (std::size_t c = 0; c < scene.layers.size(); ++c)
        add(fmt::format("coat {}", c + 1), scene.layers[c].medium);
    if (parts.empty()) return "";
    const Part& first = parts.front();
    const auto agree = [&](std::string Part::*what) {
        return std::all_of(parts.begin(), parts.end(),
                           [&](const Part& part) { return part.*what == first.*what; });
    };
    const bool one_size = agree(&Part::sizes), one_host = agree(&Part::host);
    if (one_size && one_host) return fmt::format("{}, in {}", first.sizes, first.host);
    std::string text;
    for (const Part& part : parts) {
        text +=
            fmt::format("{}: {}{}; ", part.name, part.sizes, one_host ? "" : ", in " + part.host);
    }
    return one_host ? text + "in " + first.host : text.substr(0, text.size() - 2);
}

void MediaArguments::add_to(CLI::App& command, Shell& shell,
                            const std::string& default_wavelengths) {
    scene_.add_to(command, shell, words_of_media(), default_wavelengths);
}

MediaSpectra MediaArguments::look_up(const std::vector<std::string>& media,
                                     OpticsDemand demand) const {
    Request request = scene_.parse();
    Scene& scene = request.scene;
    scene.base = medium(media.front());
    // They lie side by side, not in layers; a depth only says that they are there.
    for (std::size_t m = 1; m < media.size(); ++m)
        scene.layers.push_back({medium(media[m]), grey(1.0)});
    validate(scene);
    scene_.note_default_sizes(scene);
    if (scene.particles.tolerance > 0.0) demand.tolerance = scene.particles.tolerance;
    return {resolve(scene, request.wavelength_nm), std::move(demand),
            describe_particles(scene.base, scene.particles)};
}

void MediaSpectra::compute(const Control& control) {
    const auto all = [](std::size_t count) {
        std::vector<std::size_t> indices(count);
        std::iota(indices.begin(), indices.end(), std::size_t{0});
        return indices;
    };
    optics =
        optics_of(scene, all(scene.media.size()), all(scene.wavelength_nm.size()), demand, control);
}

bool MediaSpectra::converged() const {
    return std::all_of(optics.begin(), optics.end(), [](const auto& media) {
        return std::all_of(media.begin(), media.end(),
                           [](const MediumOptics& o) { return o.converged; });
    });
}

}  // namespace miebrdf::program
