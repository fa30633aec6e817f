// How the words of a scene read their values and store them: the templates of which the lists of
// words are made (layer_words.cpp, particle_words.cpp, method_words.cpp).
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <miebrdf/error.h>
#include "pipeline/scene/scene_words.h"

namespace miebrdf {

std::vector<SceneWord> layer_words();     ///< the first group: what lies on what
std::vector<SceneWord> surface_words();   ///< what is above the layers
std::vector<SceneWord> particle_words();  ///< of media that go through Mie theory
std::vector<SceneWord> method_words();    ///< how it is solved

using WordValues = std::span<const WordValue>;

/// The only value of a word. @throws UsageError  for none or several
const WordValue& one_value(const SceneWord& word, WordValues values);

/// Values that belong together as one text, with commas.
std::string comma_separated(WordValues values);

/// @param what  names the number in messages
/// @throws UsageError  for what is not a finite (whole) number
double finite_number(const WordValue& value, const std::string& what);
int whole_number(const WordValue& value, const std::string& what);

/// @throws UsageError  for anything but true and false
bool is_on(const SceneWord& word, const WordValue& value);

/// The member that is reached by going down these members, from the request.
template <auto... path>
auto& member_at(Request& request) {
    return (request.*....*path);
}

/// A word for one number that is stored as it is.
template <auto... path>
void set_number(const SceneWord& word, WordValues values, Request& request) {
    auto& number = member_at<path...>(request);
    if constexpr (std::is_same_v<decltype(number), int&>) {
        number = whole_number(one_value(word, values), word.name);
    } else {
        number = finite_number(one_value(word, values), word.name);
    }
}

/// A word for one text, read by a function (`medium`, `substrate`, ...).
template <auto read, auto... path>
void set_text(const SceneWord& word, WordValues values, Request& request) {
    member_at<path...>(request) = read(text_of(one_value(word, values)));
}

/// A word for a switch that `wanted` is stored of when it is on.
template <bool wanted, auto... path>
void set_switch(const SceneWord& word, WordValues values, Request& request) {
    member_at<path...>(request) = is_on(word, one_value(word, values)) == wanted;
}

/// The name of a value of an enumeration. An array of them is in the order in which help texts list
/// the names, the default first.
template <typename Value>
struct NamedValue {
    const char* name;
    Value value;
};

template <typename Value, std::size_t count>
std::string list_of(const NamedValue<Value> (&names)[count]) {
    std::string text;
    for (const auto& [name, value] : names) text += (text.empty() ? "" : ", ") + std::string(name);
    return text;
}

/// A word for one name of a list; a message lists them all.
template <const auto& names, auto... path>
void set_name(const SceneWord& word, WordValues values, Request& request) {
    const std::string asked = text_of(one_value(word, values));
    for (const auto& [name, value] : names) {
        if (asked != name) continue;
        member_at<path...>(request) = value;
        return;
    }
    throw UsageError(fmt::format("unknown {} '{}'; allowed: {}", word.name, asked, list_of(names)));
}

}  // namespace miebrdf
