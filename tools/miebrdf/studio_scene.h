// The scene of the studio's page: words of the command line in JSON, and as a scene file, a command
// line and Python.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {

/// {"base": ["TiO2,radius=0.2"], "coat": [...], "missing-k-zero": [true]} as words. Words that name
/// a file are refused: nothing of the disk is read for a page.
/// @throws UsageError  for words that no scene has, values that are no texts, more than a page
/// needs
SaidWords words_from_page(const nlohmann::json& page);
nlohmann::json words_for_page(const SaidWords& said);

/// The request of a page's words, within what a page may ask for.
/// @throws UsageError, InputError  as request_of()
Request request_of_page(const SaidWords& said);

/// `--base TiO2,radius=0.2 ...`, one word each.
std::vector<std::string> arguments_of(const SaidWords& said);
/// A scene file with one report; `page` (one line of JSON, may be empty) is kept in a comment.
std::string scene_file_of(const SaidWords& said, const std::string& page);
/// What scene_file_of() kept; empty: nothing.
std::string page_of_scene_file(const std::string& text);
/// A script that makes the same scene.
std::string python_of(const SaidWords& said);

}  // namespace miebrdf::program
