#include "pipeline/scene/scene_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
// Compiled here once, rather than a library to load at every start.
#define TOML_HEADER_ONLY 0
#define TOML_IMPLEMENTATION
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include <miebrdf/error.h>
#include "materials/database/names.h"
#include "pipeline/scene/toml_file.h"

namespace miebrdf {
namespace {

using Tables = std::map<std::string, const toml::table*>;
using Nodes = std::map<std::string, const toml::node*>;

bool contains(const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
}

/// Keys that arrange the file and belong to no command.
bool is_structure(std::string_view key) {
    return key == "result" || key == "scene" || key == "command";
}

/// How a command takes a key; empty: not at all.
std::optional<WordKind> kind_of(const SceneFileCommand& command, const std::string& key) {
    if (contains(command.words, key)) return find_scene_word(key)->kind;
    for (const CommandKey& known : command.keys) {
        if (known.name == key) return known.kind;
    }
    return std::nullopt;
}

std::vector<std::string> keys_of(const SceneFileCommand& command) {
    std::vector<std::string> keys = command.words;
    for (const CommandKey& key : command.keys) keys.push_back(key.name);
    return keys;
}

/// " key=value,value", quoted where there are blanks; " key=value key=value" for a repeated key.
std::string entry(const std::string& key, WordKind kind, const std::vector<WordValue>& values) {
    if (kind == WordKind::flag) return " " + key;
    std::vector<std::string> texts;
    texts.reserve(values.size());
    for (const WordValue& value : values) {
        texts.push_back(text_of(value));
        if (texts.back().find(' ') != std::string::npos)
            texts.back() = fmt::format("'{}'", texts.back());
    }
    const std::string between = kind == WordKind::repeated ? fmt::format(" {}=", key) : ",";
    return fmt::format(" {}={}", key, fmt::join(texts, between));
}

class SceneFile {
  public:
    SceneFile(const std::string& path, std::span<const SceneFileCommand> commands)
        : path_(path), commands_(commands) {
        const std::string text = read_toml_text("scene file", path);
        try {
            root_ = toml::parse(text, path);
        } catch (const toml::parse_error& error) {
            refuse(error.source(), std::string(error.description()));
        }
    }

    std::vector<SceneFileResult> results() const {
        check_shared_keys(root_);
        for (const auto& [name, scene] : scenes()) check_shared_keys(*scene);
        const toml::array* tables = nullptr;
        if (const toml::node* node = root_.get("result")) tables = node->as_array();
        if (tables == nullptr || tables->empty() || !tables->is_array_of_tables()) {
            throw InputError(
                fmt::format("scene file '{}' asks for nothing; add a [[result]] with "
                            "command = \"brdf\"",
                            path_));
        }
        std::vector<SceneFileResult> all;
        for (const toml::node& table : *tables)
            all.push_back(result_of(*table.as_table(), all.size() + 1));
        return all;
    }

    std::vector<NamedScene> named_scenes() const {
        check_shared_keys(root_);
        const Tables tables = scenes();
        std::vector<std::pair<std::string, const toml::table*>> in_order(tables.begin(),
                                                                         tables.end());
        std::sort(in_order.begin(), in_order.end(), [](const auto& a, const auto& b) {
            return a.second->source().begin.line < b.second->source().begin.line;
        });
        std::vector<NamedScene> all;
        for (const auto& [name, scene] : in_order) {
            check_shared_keys(*scene);
            NamedScene& named = all.emplace_back(NamedScene{name, {}});
            Nodes words;
            for (const toml::table* table : {&root_, scene}) {
                for (const auto& [key, node] : *table) words[std::string(key.str())] = &node;
            }
            for (const auto& [key, node] : words) {
                const SceneWord* word = find_scene_word(key);
                if (word == nullptr) continue;  // of commands
                const std::vector<WordValue> values = values_of(key, *node, word->kind);
                if (!values.empty()) set(key, values, *node, "scene " + name, named.request);
            }
        }
        if (!all.empty()) return all;
        for (const SceneFileResult& result : results())
            all.push_back({fmt::format("result {}", all.size() + 1), result.request});
        return all;
    }

  private:
    std::string located(const toml::source_region& where, const std::string& reason) const {
        return fmt::format("scene file '{}', line {}, column {}: {}", path_, where.begin.line,
                           where.begin.column, reason);
    }

    [[noreturn]] void refuse(const toml::source_region& where, const std::string& reason) const {
        throw InputError(located(where, reason));
    }

    /// A word that is none of those known, where it stands.
    [[noreturn]] void refuse_word(const toml::source_region& where, const std::string& reason,
                                  std::string_view word,
                                  const std::vector<std::string>& known) const {
        const auto nearest = materials::nearest_names(word, known, 3);
        const std::string question =
            nearest.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(nearest, " or "));
        throw UsageError(located(where, reason + question));
    }

    Tables scenes() const {
        Tables found;
        const toml::node* node = root_.get("scene");
        if (node == nullptr) return found;
        if (!node->is_table()) refuse(node->source(), "'scene' must be a table: [scene.NAME]");
        for (const auto& [name, scene] : *node->as_table()) {
            if (!scene.is_table()) refuse(scene.source(), "write [scene.NAME], then its options");
            found[std::string(name.str())] = scene.as_table();
        }
        return found;
    }

    /// A shared key must belong to at least one command.
    void check_shared_keys(const toml::table& table) const {
        for (const auto& [key, value] : table) {
            const std::string name(key.str());
            if (name == "command")
                refuse(key.source(), "'command' goes into a [[result]], one into each");
            if (is_structure(name)) continue;
            const bool known = std::any_of(commands_.begin(), commands_.end(), [&](const auto& c) {
                return kind_of(c, name).has_value();
            });
            if (!known) {
                refuse_word(key.source(), fmt::format("unknown option '{}'", name), name,
                            all_keys());
            }
        }
    }

    /// Everything that may stand at the top of the file.
    std::vector<std::string> all_keys() const {
        std::set<std::string> keys = {"result", "scene"};
        for (const SceneFileCommand& command : commands_) {
            for (std::string& key : keys_of(command)) keys.insert(std::move(key));
        }
        return {keys.begin(), keys.end()};
    }

    SceneFileResult result_of(const toml::table& table, std::size_t number) const {
        const SceneFileCommand& command = command_of(table);
        SceneFileResult result;
        result.command = result.text = command.name;
        for (const auto& [key, node] : keys_of_result(table, command)) {
            const auto kind = kind_of(command, key);
            if (!kind) continue;  // shared, and for other commands
            const std::vector<WordValue> values = values_of(key, *node, *kind);
            // Off, or an empty list of coats: what is shared is taken back.
            if (values.empty()) continue;
            result.text += entry(key, *kind, values);
            if (!contains(command.words, key)) {
                const auto where = node->source().begin;
                result.keys.push_back({key, *kind, values, where.line, where.column});
                continue;
            }
            result.words.push_back(key);
            result.said.push_back(values);
            set(key, values, *node, fmt::format("result {} ({})", number, command.name),
                result.request);
        }
        return result;
    }

    /// The keys of one result. Later ones win: those of the file, of the scene, of the result.
    Nodes keys_of_result(const toml::table& table, const SceneFileCommand& command) const {
        Nodes merged;
        const auto merge = [&](const toml::table& more) {
            for (const auto& [key, value] : more) {
                if (!is_structure(key.str())) merged[std::string(key.str())] = &value;
            }
        };
        merge(root_);
        if (const toml::table* scene = scene_of(table)) merge(*scene);
        for (const auto& [key, value] : table) {
            const std::string name(key.str());
            if (is_structure(name) || kind_of(command, name)) continue;
            refuse_word(key.source(), fmt::format("'{}' has no option '{}'", command.name, name),
                        name, keys_of(command));
        }
        const toml::node* format = table.get("format");
        if (format == nullptr && merged.count("format") > 0) format = merged["format"];
        if (format != nullptr && command.useless_for) {
            for (const std::string& key : command.useless_for(format->value_or(std::string())))
                merged.erase(key);
        }
        merge(table);
        return merged;
    }

    /// Applies a word of the scene; what is wrong with its value is said with its place.
    void set(const std::string& key, const std::vector<WordValue>& values, const toml::node& node,
             const std::string& result, Request& request) const {
        const auto where = [&](const Error& error) {
            return located(node.source(), fmt::format("{}: {}", result, error.what()));
        };
        std::vector<WordValue> found = values;
        for (WordValue& value : found) {
            if (auto* text = std::get_if<std::string>(&value))
                *text = with_files_in(*text, std::filesystem::path(path_).parent_path().string());
        }
        try {
            apply(*find_scene_word(key), found, request);
        } catch (const UsageError& error) {
            throw UsageError(where(error));
        } catch (const InputError& error) {
            throw InputError(where(error));
        }
    }

    WordValue value_of(const std::string& key, const toml::node& node) const {
        if (const auto number = node.value_exact<double>()) return *number;
        if (const auto number = node.value_exact<std::int64_t>()) return double(*number);
        const auto text = node.value_exact<std::string>();
        if (!text)
            refuse(node.source(),
                   fmt::format("'{}' takes a number, a text or a list of them", key));
        if (text->empty()) {
            refuse(node.source(), fmt::format("'{}' is empty; give a value or leave it out", key));
        }
        return *text;
    }

    /// Empty for a switch that is off, and for an empty list of a repeated key.
    std::vector<WordValue> values_of(const std::string& key, const toml::node& node,
                                     WordKind kind) const {
        if (kind == WordKind::flag) {
            const auto on = node.value_exact<bool>();
            if (!on) refuse(node.source(), fmt::format("'{}' is true or false", key));
            return *on ? std::vector<WordValue>{true} : std::vector<WordValue>{};
        }
        const toml::array* list = node.as_array();
        if (list == nullptr) return {value_of(key, node)};
        std::vector<WordValue> values;
        for (const toml::node& item : *list) values.push_back(value_of(key, item));
        if (values.empty() && kind != WordKind::repeated) {
            refuse(
                node.source(),
                fmt::format("'{}' is an empty list; give at least one value or leave it out", key));
        }
        return values;
    }

    const SceneFileCommand& command_of(const toml::table& result) const {
        const toml::node* node = result.get("command");
        if (node == nullptr || !node->is_string())
            refuse(result.source(), "a [[result]] needs a command, e.g. command = \"brdf\"");
        const std::string asked = node->as_string()->get();
        std::vector<std::string> names;
        for (const SceneFileCommand& command : commands_) {
            if (command.name == asked) return command;
            names.push_back(command.name);
        }
        refuse_word(node->source(),
                    fmt::format("unknown command '{}'; allowed: {}", asked, fmt::join(names, ", ")),
                    asked, names);
    }

    const toml::table* scene_of(const toml::table& result) const {
        const toml::node* node = result.get("scene");
        if (node == nullptr) return nullptr;
        const Tables known = scenes();
        const auto found = node->is_string() ? known.find(node->as_string()->get()) : known.end();
        if (found != known.end()) return found->second;
        std::vector<std::string> names;
        names.reserve(known.size());
        for (const auto& [name, scene] : known) names.push_back(name);
        refuse_word(node->source(),
                    fmt::format("no such scene; this file has: {}", fmt::join(names, ", ")),
                    node->value_or(std::string()), names);
    }

    std::string path_;
    std::span<const SceneFileCommand> commands_;
    toml::table root_;
};

}  // namespace

std::vector<SceneFileResult> read_scene_file(const std::string& path,
                                             std::span<const SceneFileCommand> commands) {
    return SceneFile(path, commands).results();
}

std::vector<NamedScene> read_named_scenes(const std::string& path,
                                          std::span<const SceneFileCommand> commands) {
    return SceneFile(path, commands).named_scenes();
}

}  // namespace miebrdf
