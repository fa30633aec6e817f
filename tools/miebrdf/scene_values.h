// Values of a scene file as words of a command line.
#pragma once

#include <toml++/toml.h>

#include <functional>
#include <string>
#include <vector>

#include "tools/miebrdf/scene_file.h"

namespace miebrdf::program {

/// Throws, with the place in the file.
using Refuse = std::function<void(const toml::source_region& where, const std::string& reason)>;

/// "--key=value" for each value of a repeated option, one with a list joined by commas for a single
/// one, "--key" or nothing for a flag, the bare value for a positional.
/// @param refuse  called for a value of the wrong kind, an empty text, and an empty list where one
///        value is needed (a repeated option may have none)
std::vector<std::string> option_words(const std::string& key, const toml::node& value,
                                      OptionKind kind, const Refuse& refuse);

}  // namespace miebrdf::program
