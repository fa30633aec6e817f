#include "pipeline/scene/named_numbers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <optional>

#include "pipeline/scene/number_list.h"

namespace miebrdf {
namespace {

/// Words whose numbers are those of matter.
constexpr std::array kMayHaveNames = {"base",
                                      "substrate",
                                      "coat",
                                      "boundary",
                                      "roughness",
                                      "surface-index",
                                      "effective-radius",
                                      "effective-variance",
                                      "host-index",
                                      "layer-density",
                                      "k-floor"};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// A name is letters, digits and _.
bool is_name(const std::string& text) {
    return !text.empty() && is_letter(text.front()) &&
           std::all_of(text.begin(), text.end(), [](char c) {
               return is_letter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
           });
}

/// `{name}` or `{name=value}`.
struct Place {
    std::string name;
    std::optional<double> value;
};

/// The text with what `spell` makes of each place; braces around anything but a name are left.
std::string rewritten(const std::string& text,
                      const std::function<std::string(const Place&, const std::string&)>& spell) {
    std::string result;
    std::size_t begin = 0;
    for (std::size_t open = text.find('{'); open != std::string::npos;
         open = text.find('{', begin)) {
        const std::size_t close = text.find('}', open);
        if (close == std::string::npos) break;
        const std::string inside = text.substr(open + 1, close - open - 1);
        const std::size_t equals = inside.find('=');
        Place place{inside.substr(0, equals), {}};
        result += text.substr(begin, open - begin);
        begin = close + 1;
        const std::string whole = text.substr(open, begin - open);
        if (!is_name(place.name)) {
            result += whole;
            continue;
        }
        if (equals != std::string::npos)
            place.value = parse_number(inside.substr(equals + 1), fmt::format("'{}'", whole));
        result += spell(place, whole);
    }
    return result + text.substr(begin);
}

const NamedNumber* find(const std::vector<NamedNumber>& numbers, const std::string& name) {
    const auto found = std::find_if(numbers.begin(), numbers.end(),
                                    [&](const NamedNumber& one) { return one.name == name; });
    return found == numbers.end() ? nullptr : &*found;
}

/// Adds the numbers of a text to those known; one name has one value.
void collect(const std::string& text, std::vector<NamedNumber>& numbers) {
    rewritten(text, [&](const Place& place, const std::string& whole) {
        const NamedNumber* known = find(numbers, place.name);
        if (known != nullptr && place.value && known->value != *place.value) {
            throw UsageError(fmt::format("'{}' has two values, {} and {}; one name is one number",
                                         place.name, known->value, *place.value));
        }
        if (known == nullptr && place.value) numbers.push_back({place.name, *place.value});
        return whole;
    });
}

bool has_names(const std::string& text) {
    bool any = false;
    rewritten(text, [&](const Place&, const std::string& whole) {
        any = true;
        return whole;
    });
    return any;
}

/// Plain numbers. @throws UsageError  for a name without value
std::string spelled_out(const std::string& text, const std::vector<NamedNumber>& numbers) {
    return rewritten(text, [&](const Place& place, const std::string&) {
        const NamedNumber* known = find(numbers, place.name);
        if (known == nullptr) {
            throw UsageError(
                fmt::format("the number '{0}' has no value; write {{{0}=0.13}}", place.name));
        }
        return fmt::format("{}", known->value);
    });
}

}  // namespace

std::vector<WordValue> without_names(const SceneWord& word, std::span<const WordValue> values,
                                     Scene& scene) {
    std::vector<WordValue> plain(values.begin(), values.end());
    std::erase_if(scene.named, [&](const NamedWords& one) { return one.word == word.name; });
    NamedWords said{word.name, {}};
    bool any = false;
    for (const WordValue& value : values) {
        said.values.push_back(text_of(value));
        any = any || (std::holds_alternative<std::string>(value) && has_names(said.values.back()));
    }
    if (!any) return plain;
    if (std::find(kMayHaveNames.begin(), kMayHaveNames.end(), word.name) == kMayHaveNames.end()) {
        throw UsageError(fmt::format("{}: its numbers cannot have names; those of {} can",
                                     word.name, fmt::join(kMayHaveNames, ", ")));
    }
    std::vector<NamedNumber> numbers = named_numbers(scene);
    for (const std::string& text : said.values) collect(text, numbers);
    for (std::size_t i = 0; i < plain.size(); ++i) {
        if (std::holds_alternative<std::string>(plain[i]))
            plain[i] = spelled_out(said.values[i], numbers);
    }
    scene.named.push_back(std::move(said));
    return plain;
}

void say(Scene& scene, const std::string& word, const std::vector<std::string>& values) {
    const SceneWord* known = find_scene_word(word);
    if (known == nullptr)
        throw UsageError(fmt::format("'{}' is not a word of a scene, as base and coat are", word));
    Request request{.scene = std::move(scene), .wavelength_nm = {}, .solver = {}};
    const std::vector<WordValue> said(values.begin(), values.end());
    try {
        apply(*known, said, request);
    } catch (...) {
        scene = std::move(request.scene);
        throw;
    }
    scene = std::move(request.scene);
}

std::vector<NamedNumber> named_numbers(const Scene& scene) {
    std::vector<NamedNumber> numbers;
    for (const NamedWords& words : scene.named) {
        for (const std::string& text : words.values) collect(text, numbers);
    }
    return numbers;
}

Scene with_values(const Scene& scene, const std::vector<NamedNumber>& values) {
    std::vector<NamedNumber> all = named_numbers(scene);
    for (const NamedNumber& value : values) {
        const auto known = std::find_if(all.begin(), all.end(), [&](const NamedNumber& number) {
            return number.name == value.name;
        });
        if (known != all.end()) {
            known->value = value.value;
            continue;
        }
        std::vector<std::string> names;
        for (const NamedNumber& number : all) names.push_back(number.name);
        throw UsageError(
            names.empty()
                ? fmt::format("the scene has no number '{0}'; write {{{0}=0.13}} where it stands "
                              "in the words of the scene",
                              value.name)
                : fmt::format("the scene has no number '{}'; it has {}", value.name,
                              fmt::join(names, ", ")));
    }
    Request request{.scene = scene, .wavelength_nm = {}, .solver = {}};
    for (const NamedWords& words : scene.named) {
        std::vector<WordValue> said;
        for (const std::string& text : words.values) said.emplace_back(with_values(text, all));
        request.scene.named.clear();  // others have their old values still
        apply(*find_scene_word(words.word), said, request);
    }
    request.scene.named.clear();
    for (const NamedWords& words : scene.named) {
        NamedWords& now = request.scene.named.emplace_back(words);
        for (std::string& text : now.values) text = with_values(text, all);
    }
    return request.scene;
}

std::string with_values(const std::string& text, const std::vector<NamedNumber>& values) {
    return rewritten(text, [&](const Place& place, const std::string& whole) {
        const NamedNumber* value = find(values, place.name);
        return value == nullptr ? whole : fmt::format("{{{}={}}}", place.name, value->value);
    });
}

}  // namespace miebrdf
