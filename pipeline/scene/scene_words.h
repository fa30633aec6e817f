// The words of a scene, in one list: options of the command line, keys of scene files and words of
// a material of a picture are these.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pipeline/scene/request.h"

namespace miebrdf {

/// One value as it was found: text where somebody typed it, a number or a switch where a file has
/// such a thing.
using WordValue = std::variant<std::string, double, bool>;

enum class WordKind {
    single,    ///< one value; a list of values is one, too
    repeated,  ///< any number of values, none among them
    flag,      ///< on or off
};

/// A new word is one of these and nothing else.
struct SceneWord {
    std::string name;              ///< "effective-radius"
    std::string placeholder = {};  ///< of its value in a help text: "UM"; empty for flags
    std::string help;              ///< what it sets, for somebody who asks for help
    std::string group = {};        ///< heading that it stands under there; empty: the first one
    WordKind kind = WordKind::single;
    std::string default_text = {};  ///< what holds when it is not said; empty: that depends
    std::string field;              ///< what exceptions call it (Error::field)
    std::string unit = {};          ///< of its value, "um"; empty: none, or the value says its own
    /// Use apply().
    void (*set)(const SceneWord& word, std::span<const WordValue> values,
                Request& request) = nullptr;
};

const std::vector<SceneWord>& scene_words();

/// Null if there is none of this name.
const SceneWord* find_scene_word(std::string_view name);

/// The names of all words but one.
std::vector<std::string> scene_word_names(std::string_view without = "");

/// Sets what a word says. Values of a list may come one by one or as one text with commas.
/// @throws UsageError  for values of the wrong kind or number, and for those that no scene can have
/// @throws InputError  for a file that a medium names
void apply(const SceneWord& word, std::span<const WordValue> values, Request& request);

/// A word's text with the files that it names (`hg:FILE`, `lambert:FILE`, `sizes=FILE`, ...) looked
/// for in this folder: where the folder has such a file its path is put in place, else the text
/// stays. For the words of a file, whose paths are relative to it. @param folder  empty: no change
std::string with_files_in(const std::string& text, const std::string& folder);

/// The value as somebody would type it; numbers in the shortest form that reads back to the same.
std::string text_of(const WordValue& value);

/// A text between double quotes, for TOML.
std::string toml_quoted(const std::string& text);
/// What a scene file says with this word: `name = "value"`, `name = ["a", "b"]`, `name = true`.
std::string toml_of(const SceneWord& word, std::span<const WordValue> values);

/// How a MEDIUM is written, for help texts: "NAME, index:N,K, ..., hg:ALBEDO,G; particles may ...".
std::string forms_of_media();

/// Reads `N,K` or `N`, or the same as one or two numbers; k >= 0. @throws UsageError
std::complex<double> parse_index(std::span<const WordValue> values, const std::string& what);

}  // namespace miebrdf
