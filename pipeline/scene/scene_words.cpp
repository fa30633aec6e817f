#include "pipeline/scene/scene_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string_view>

#include <miebrdf/error.h>
#include "pipeline/scene/named_numbers.h"
#include "pipeline/scene/number_list.h"
#include "pipeline/scene/scene_parts.h"
#include "pipeline/scene/word_setters.h"

namespace miebrdf {

const WordValue& one_value(const SceneWord& word, WordValues values) {
    if (values.size() != 1)
        throw UsageError(fmt::format("{}: takes one value; given: {}", word.name, values.size()));
    return values.front();
}

std::string comma_separated(WordValues values) {
    std::string text;
    for (const WordValue& value : values) {
        if (!text.empty()) text += ',';
        text += text_of(value);
    }
    return text;
}

double finite_number(const WordValue& value, const std::string& what) {
    const auto* given = std::get_if<double>(&value);
    if (given == nullptr) return parse_number(text_of(value), what);
    if (std::isfinite(*given)) return *given;
    throw UsageError(fmt::format("{}: {} is not a finite number", what, *given));
}

int whole_number(const WordValue& value, const std::string& what) {
    const double found = finite_number(value, what);
    if (found != std::floor(found) || std::abs(found) > 1e9)
        throw UsageError(fmt::format("{}: {} is not a whole number", what, found));
    return int(found);
}

bool is_on(const SceneWord& word, const WordValue& value) {
    if (const auto* on = std::get_if<bool>(&value)) return *on;
    throw UsageError(fmt::format("{} is true or false", word.name));
}

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

std::vector<std::string> scene_word_names(std::string_view without) {
    std::vector<std::string> names;
    for (const SceneWord& word : scene_words()) {
        if (word.name != without) names.push_back(word.name);
    }
    return names;
}

void apply(const SceneWord& word, std::span<const WordValue> values, Request& request) {
    word.set(word, without_names(word, values, request.scene), request);
}

std::string with_files_in(const std::string& text, const std::string& folder) {
    static constexpr std::string_view kBefore[] = {
        "hg:", "moments:", "matrix:", "scattering:", "paste:", "lambert:", "sizes:", "sizes="};
    if (folder.empty()) return text;
    std::string found;
    std::size_t at = 0;
    while (at < text.size()) {
        const std::string_view rest = std::string_view(text).substr(at);
        const bool begins = at == 0 || !std::isalnum(static_cast<unsigned char>(text[at - 1]));
        const auto* before =
            std::find_if(std::begin(kBefore), std::end(kBefore),
                         [&](std::string_view words) { return begins && rest.starts_with(words); });
        if (before == std::end(kBefore)) {
            found += text[at++];
            continue;
        }
        found += *before;
        at += before->size();
        std::size_t end = text.find_first_of(",@", at);
        for (const char* after : {" + ", " in "}) end = std::min(end, text.find(after, at));
        const std::string name = trimmed_text(text.substr(at, end - at));
        const std::filesystem::path file = std::filesystem::path(folder) / name;
        std::error_code unreadable;
        const bool is_there = !name.empty() && std::filesystem::is_regular_file(file, unreadable);
        found += is_there ? file.string() : text.substr(at, end - at);
        at = std::min(end, text.size());
    }
    return found;
}

std::string text_of(const WordValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (const auto* given = std::get_if<double>(&value)) return fmt::format("{}", *given);
    return std::get<bool>(value) ? "true" : "false";
}

std::string toml_quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return out + '"';
}

std::string toml_of(const SceneWord& word, std::span<const WordValue> values) {
    std::vector<std::string> texts;
    texts.reserve(values.size());
    for (const WordValue& value : values)
        texts.push_back(word.kind == WordKind::flag ? text_of(value) : toml_quoted(text_of(value)));
    return texts.size() == 1 && word.kind != WordKind::repeated
               ? fmt::format("{} = {}", word.name, texts[0])
               : fmt::format("{} = [{}]", word.name, fmt::join(texts, ", "));
}

std::complex<double> parse_index(std::span<const WordValue> values, const std::string& what) {
    std::vector<double> parts;
    for (const WordValue& value : values) {
        if (std::holds_alternative<double>(value)) {
            parts.push_back(finite_number(value, what));
            continue;
        }
        for (const std::string& part : split_index(text_of(value)))
            parts.push_back(parse_number(part, what));
    }
    if (parts.empty() || parts.size() > 2) {
        throw UsageError(fmt::format(
            "{}: {} numbers; write N,K, e.g. 1.5,0, or 1.5+0.01i, or N alone", what, parts.size()));
    }
    const double n = parts[0], k = parts.size() == 2 ? parts[1] : 0.0;
    if (!(n > 0.0 && n <= kLargestIndex && k >= 0.0 && k <= kLargestIndex)) {
        throw UsageError(fmt::format(
            "{}: {} + {}i is out of range; allowed: n > 0, k >= 0, both up to 1e6", what, n, k));
    }
    return {n, k};
}

}  // namespace miebrdf
