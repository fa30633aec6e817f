#include "tools/miebrdf/plot_scenes.h"

#include <fmt/format.h>

#include <algorithm>

#include <miebrdf/error.h>
#include "pipeline/scene/labels.h"
#include "pipeline/scene/number_list.h"
#include "tools/miebrdf/run_command.h"
#include "tools/miebrdf/scene_family.h"

namespace miebrdf::program {
namespace {

/// `roughness=0.1; coat=A@1`, by name; nothing for what is not of this form (`TiO2,radius=0.1`).
std::optional<SaidWords> said_in(const std::string& text) {
    SaidWords said;
    for (const std::string& part : split_list(text, ';')) {
        const std::size_t equals = part.find('=');
        const std::string name = trimmed_text(part.substr(0, equals));
        const bool is_word = name == "depth" || find_scene_word(name) != nullptr;
        if (equals == std::string::npos || !is_word) return std::nullopt;
        const std::string value = trimmed_text(part.substr(equals + 1));
        std::vector<WordValue>& values = said[name];
        if (value != "none") values.emplace_back(value);
    }
    if (said.empty()) return std::nullopt;
    return said;
}

/// The request with some of its words said anew.
Request changed(Request request, const SaidWords& said) {
    for (const auto& [name, values] : said) {
        if (name == "depth") {
            if (request.scene.layers.empty())
                throw UsageError("--compare depth=...: the scene has no layer; add one by --coat");
            request.scene.layers.back().depth =
                depth(values.empty() ? "0" : text_of(values.front()));
            continue;
        }
        const SceneWord& word = *find_scene_word(name);
        if (name == "roughness" && values.empty()) {
            request.scene.surface.reset();
        } else if (name == "boundary" && values.empty()) {
            request.scene.boundary.reset();
        } else {
            if (name == "base") request.scene.substrate.reset();
            apply(word, values, request);
        }
    }
    return request;
}

/// Reads --compare: a scene at the wavelengths and by the methods of the first one.
Request compared(const std::string& text, const Request& first,
                 const ScenePlotArguments& arguments) {
    Request request = first;
    if (const auto said = said_in(text)) return changed(std::move(request), *said);
    if (text.ends_with(".toml")) {
        const std::vector<SceneFileResult> results = read_scene_results(text);
        request.scene = arguments.scene.complete(results.front().request).scene;
        return request;
    }
    request.scene.substrate.reset();
    request.scene.base = medium(text);
    return request;
}

/// "effective radius 0.1 um" as charts have it.
std::string on_charts(std::string label) {
    const std::pair<std::string, std::string> replaced[] = {
        {"effective radius", "radius"}, {" um", " \u00b5m"}, {"optical depth", "\u03c4 ="}};
    for (const auto& [from, to] : replaced) {
        const std::size_t at = label.find(from);
        if (at != std::string::npos) label.replace(at, from.size(), to);
    }
    return label;
}

std::vector<ShownScene> family_of(const std::string& vary, const Request& first) {
    const Family family = parse_family(vary);
    std::vector<ShownScene> members;
    for (const double value : family.values) {
        ShownScene member{first};
        member.label = on_charts(family.apply(value, member.request));
        member.shade =
            static_cast<double>(members.size()) / static_cast<double>(family.values.size() - 1);
        members.push_back(std::move(member));
    }
    return members;
}

void label_all(std::vector<ShownScene>& scenes, const std::vector<std::string>& compare) {
    std::vector<Scene> plain;
    for (const ShownScene& shown : scenes) plain.push_back(shown.request.scene);
    const std::vector<std::string> labels = labels_of(plain);
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const bool is_known = std::count(labels.begin(), labels.end(), labels[i]) > 1;
        // The difference has no words of its own, so those of the option tell it.
        scenes[i].label = is_known && i > 0 ? compare[i - 1] : labels[i];
    }
}

}  // namespace

void add_scene_choices(CLI::App& command, const ScenePlot& arguments) {
    option(command, "--compare", arguments->compare, "SCENE",
           "also show another scene: another base (MEDIUM), a scene file (FILE.toml), or this "
           "scene with some options changed: 'coat=AlGaAs7@0.5', 'depth=0.5' (of the top coat), "
           "'roughness=0.1', several with ; between; roughness=none takes the roughness away. "
           "Repeat it for more scenes")
        ->allow_extra_args(false);
    option(command, "--vary", arguments->vary, "FAMILY",
           "a family of curves: NAME=FROM:TO:COUNT or NAME=A,B,C of depth, roughness, radius, "
           "concentration or an option of one number");
}

std::vector<ShownScene> shown_scenes(const ScenePlotArguments& arguments, const Request& first) {
    if (!arguments.vary.empty()) {
        if (!arguments.compare.empty())
            throw UsageError("--vary and --compare: a chart shows a family or single scenes");
        return family_of(arguments.vary, first);
    }
    std::vector<ShownScene> scenes{{first}};
    for (const std::string& text : arguments.compare)
        scenes.push_back({compared(text, first, arguments)});
    label_all(scenes, arguments.compare);
    return scenes;
}

std::string title_of(const std::vector<ShownScene>& scenes, const ScenePlotArguments& arguments) {
    const Request& first = scenes.front().request;
    if (!arguments.vary.empty()) {
        const Family family = parse_family(arguments.vary);
        return fmt::format("{}: {} from {:.4g} to {:.4g}", media_of(first.scene),
                           family.label(first), family.values.front(), family.values.back());
    }
    if (scenes.size() == 1) return label_of(first.scene);
    const std::string last = label_of(scenes.back().request.scene);
    return scenes.size() == 2
               ? fmt::format("{} and {}", label_of(first.scene), last)
               : fmt::format("{} and {} others", label_of(first.scene), scenes.size() - 1);
}

std::vector<ShownMedium> shown_media(const std::vector<std::string>& media,
                                     const std::string& vary) {
    std::vector<ShownMedium> shown;
    if (vary.empty()) {
        for (const std::string& text : media) shown.push_back({text, label_of(medium(text))});
        return shown;
    }
    const Family family = parse_family(vary);
    if (family.name != "radius" && family.name != "concentration") {
        throw UsageError(
            fmt::format("--vary {}: media alone have a radius and, in a mixture, a concentration",
                        family.name));
    }
    if (media.size() != 1) throw UsageError("--vary shows a family of one medium");
    for (const double value : family.values) {
        Request request;
        request.scene.base = medium(media.front());
        const std::string label = on_charts(family.apply(value, request));
        shown.push_back(
            {describe(request.scene.base), label,
             static_cast<double>(shown.size()) / static_cast<double>(family.values.size() - 1)});
    }
    return shown;
}

}  // namespace miebrdf::program
