// Numbers with names in the words of a scene: `{radius=0.13}`.
#pragma once

#include <span>
#include <vector>

#include "pipeline/scene/scene_words.h"

namespace miebrdf {

/// The values of a word with plain numbers in the place of those that have names. The scene keeps
/// the word as it was said, or forgets what it kept of it before.
/// @throws UsageError  for a name without value, or with two, and for names in words that describe
///         no matter
std::vector<WordValue> without_names(const SceneWord& word, std::span<const WordValue> values,
                                     Scene& scene);

}  // namespace miebrdf
