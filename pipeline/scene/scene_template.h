// Words of a scene with gaps, `radius={radius_um}`: sweeps fill them with the values of their axes,
// fits with those of their unknowns.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pipeline/scene/scene_words.h"

namespace miebrdf {

/// A word of the scene; texts in its values may have {NAME} for a value that comes later.
struct TemplateWord {
    std::string name;
    std::vector<WordValue> values;
    std::string where;  ///< "sweep file 'x.toml', line 3, column 8", for messages

    bool operator==(const TemplateWord& other) const {
        return name == other.name && values == other.values;
    }
};

/// The names that stand in braces in a text, but for `{name=value}`. @throws UsageError  for braces
/// without one
std::vector<std::string> gaps_in(const std::string& text);

/// The text that stands for a name.
using TextOfName = std::function<std::string(const std::string& name)>;

/// Sets what the word says once its gaps are filled; an empty text says nothing (no coat).
/// @param folder  of the file that has the word (with_files_in); empty: none
/// @throws UsageError, InputError  as apply() of scene_words.h
void apply(const TemplateWord& word, const TextOfName& text_of_name, Request& request,
           const std::string& folder = {});

}  // namespace miebrdf
