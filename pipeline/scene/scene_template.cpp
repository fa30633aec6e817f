#include "pipeline/scene/scene_template.h"

#include <fmt/format.h>

#include <miebrdf/error.h>

namespace miebrdf {
namespace {

std::string filled(const std::string& text, const TextOfName& text_of_name) {
    std::string out;
    std::size_t done = 0;
    for (const std::string& name : gaps_in(text)) {
        const std::size_t at = text.find("{" + name + "}", done);
        out.append(text, done, at - done).append(text_of_name(name));
        done = at + name.size() + 2;
    }
    return out.append(text, done);
}

}  // namespace

std::vector<std::string> gaps_in(const std::string& text) {
    std::vector<std::string> names;
    for (std::size_t at = text.find_first_of("{}"); at != std::string::npos;
         at = text.find_first_of("{}", at)) {
        const std::size_t end = text[at] == '{' ? text.find_first_of("{}", at + 1) : at;
        if (end == std::string::npos || text[at] == '}' || text[end] == '{' || end == at + 1)
            throw UsageError(fmt::format("'{}': braces hold a name, {{radius_um}}", text));
        // A number with a name stays as it is.
        const std::string name = text.substr(at + 1, end - at - 1);
        if (name.find('=') == std::string::npos) names.push_back(name);
        at = end + 1;
    }
    return names;
}

void apply(const TemplateWord& word, const TextOfName& text_of_name, Request& request,
           const std::string& folder) {
    const SceneWord& known = *find_scene_word(word.name);
    std::vector<WordValue> values;
    for (const WordValue& value : word.values) {
        const auto* text = std::get_if<std::string>(&value);
        if (text == nullptr) {
            values.push_back(value);
            continue;
        }
        const std::string whole = with_files_in(filled(*text, text_of_name), folder);
        if (known.kind == WordKind::flag && (whole == "true" || whole == "false")) {
            values.emplace_back(whole == "true");
        } else if (!whole.empty()) {
            values.emplace_back(whole);
        }
    }
    if (!values.empty()) apply(known, values, request);
}

}  // namespace miebrdf
