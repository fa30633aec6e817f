// The scenes of one chart: the one that options say, others beside it (--compare), or a family
// (--vary).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/scene/request.h"
#include "tools/miebrdf/plot_command.h"

namespace miebrdf::program {

struct ShownScene {
    Request request;
    std::string label = {};            ///< what tells it from the others; empty: it is alone
    std::optional<double> shade = {};  ///< of a family's member: 0 for the first, 1 for the last
};

/// Adds --compare and --vary.
void add_scene_choices(CLI::App& command, const ScenePlot& arguments);

/// @param first  what the options say
/// @throws UsageError, InputError
std::vector<ShownScene> shown_scenes(const ScenePlotArguments& arguments, const Request& first);

/// All of them in one line: "τ = 0.1 ... on TiO2", or "A and B".
std::string title_of(const std::vector<ShownScene>& scenes, const ScenePlotArguments& arguments);

/// `depth=0.1:1:4` of media: each value's medium in words, its label and shade.
struct ShownMedium {
    std::string text, label;
    std::optional<double> shade = {};
};
/// @param vary  of sizes or amounts; empty: each medium once
/// @throws UsageError  for anything else, and several media
std::vector<ShownMedium> shown_media(const std::vector<std::string>& media,
                                     const std::string& vary);

}  // namespace miebrdf::program
