#include "tools/miebrdf/scene_values.h"

#include <fmt/format.h>

namespace miebrdf::program {
namespace {

std::string text_of(const std::string& key, const toml::node& value, const Refuse& refuse) {
    if (const auto* text = value.as_string()) return text->get();
    if (const auto* integer = value.as_integer()) return fmt::format("{}", integer->get());
    if (const auto* number = value.as_floating_point()) return fmt::format("{}", number->get());
    refuse(value.source(), fmt::format("'{}' takes a number, a text or a list of them", key));
    return {};
}

std::vector<std::string> texts_of(const std::string& key, const toml::node& value,
                                  const Refuse& refuse) {
    std::vector<std::string> texts;
    const auto add = [&](const toml::node& item) {
        texts.push_back(text_of(key, item, refuse));
        // As a word it would be `--key=`, which takes the next word for its value.
        if (texts.back().empty())
            refuse(item.source(), fmt::format("'{}' is empty; give a value or leave it out", key));
    };
    if (const toml::array* list = value.as_array()) {
        for (const toml::node& item : *list) add(item);
    } else {
        add(value);
    }
    return texts;
}

}  // namespace

std::vector<std::string> option_words(const std::string& key, const toml::node& value,
                                      OptionKind kind, const Refuse& refuse) {
    if (kind == OptionKind::flag) {
        if (!value.is_boolean()) refuse(value.source(), fmt::format("'{}' is true or false", key));
        return value.value_or(false) ? std::vector{"--" + key} : std::vector<std::string>{};
    }
    const std::vector<std::string> texts = texts_of(key, value, refuse);
    std::vector<std::string> words;
    if (kind == OptionKind::repeated) {
        for (const std::string& text : texts) words.push_back(fmt::format("--{}={}", key, text));
        return words;  // none for an empty list, which takes back what is shared
    }
    if (texts.empty()) {
        refuse(value.source(), fmt::format("'{}' is an empty list; give at least one value or "
                                           "leave it out",
                                           key));
    }
    const std::string joined = fmt::format("{}", fmt::join(texts, ","));
    return {kind == OptionKind::positional ? joined : fmt::format("--{}={}", key, joined)};
}

}  // namespace miebrdf::program
