// A YAML document as a tree of text, with line numbers for messages.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace miebrdf::materials {

struct YamlNode {
    enum class Kind { scalar, sequence, mapping };
    Kind kind = Kind::scalar;
    std::string text;               ///< of a scalar
    std::vector<YamlNode> items;    ///< of a sequence, or the values of a mapping
    std::vector<std::string> keys;  ///< of a mapping: keys[i] belongs to items[i]
    int line = 0;                   ///< from 1

    /// The entry of a mapping, or nullptr.
    const YamlNode* find(std::string_view key) const;
    /// The text of a scalar entry, or nothing.
    std::string text_of(std::string_view key) const;
};

/// The first document of a text, by libyaml. Anchors and aliases are refused (no source uses them,
/// and they can make a small file huge), as is nesting deeper than 32.
/// @throws ImportError
YamlNode parse_yaml(std::string_view text, const std::string& file);

}  // namespace miebrdf::materials
