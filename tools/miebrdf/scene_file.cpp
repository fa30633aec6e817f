#include "tools/miebrdf/scene_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <miebrdf/error.h>
#include "tools/miebrdf/scene_values.h"
#include "tools/miebrdf/suggestions.h"

namespace miebrdf::program {
namespace {

using Arguments = std::vector<std::string>;

class SceneFile {
  public:
    SceneFile(const std::string& path, const SceneCommands& commands)
        : path_(path), commands_(commands) {
        if (!std::filesystem::is_regular_file(path)) {
            throw InputError(fmt::format("scene file '{}' does not exist", path));
        }
        try {
            root_ = toml::parse_file(path);
        } catch (const toml::parse_error& error) {
            refuse(error.source(), std::string(error.description()));
        }
    }

    std::vector<Arguments> command_lines() const {
        check_shared_keys(root_);
        for (const auto& [name, scene] : scenes()) check_shared_keys(*scene);
        const toml::array* results = nullptr;
        if (const toml::node* node = root_.get("result")) results = node->as_array();
        if (results == nullptr || results->empty() || !results->is_array_of_tables()) {
            throw InputError(
                fmt::format("scene file '{}' asks for nothing; add a [[result]] with "
                            "command = \"brdf\"",
                            path_));
        }
        std::vector<Arguments> lines;
        for (const toml::node& result : *results) lines.push_back(command_line(*result.as_table()));
        return lines;
    }

  private:
    [[noreturn]] void refuse(const toml::source_region& where, const std::string& reason) const {
        throw InputError(located(where, reason));
    }

    /// A word that is none of those known, where it stands.
    [[noreturn]] void refuse_word(const toml::source_region& where, const std::string& reason,
                                  std::string_view word,
                                  const std::vector<std::string>& known) const {
        throw UsageError(located(where, reason + did_you_mean(word, known)));
    }

    std::string located(const toml::source_region& where, const std::string& reason) const {
        return fmt::format("scene file '{}', line {}, column {}: {}", path_, where.begin.line,
                           where.begin.column, reason);
    }

    static bool is_structure(std::string_view key) {
        return key == "result" || key == "scene" || key == "command";
    }

    std::map<std::string, const toml::table*> scenes() const {
        std::map<std::string, const toml::table*> found;
        const toml::node* node = root_.get("scene");
        if (node == nullptr) return found;
        if (!node->is_table()) refuse(node->source(), "'scene' must be a table: [scene.NAME]");
        for (const auto& [name, scene] : *node->as_table()) {
            if (!scene.is_table()) refuse(scene.source(), "write [scene.NAME], then its options");
            found[std::string(name.str())] = scene.as_table();
        }
        return found;
    }

    /// What is shared must be an option of at least one command.
    void check_shared_keys(const toml::table& table) const {
        for (const auto& [key, value] : table) {
            const std::string name(key.str());
            if (name == "command") {
                refuse(key.source(), "'command' belongs into a [[result]], one in each");
            }
            if (is_structure(name)) continue;
            const bool known =
                std::any_of(commands_.names.begin(), commands_.names.end(),
                            [&](const auto& c) { return commands_.kind_of(c, name).has_value(); });
            if (!known) {
                refuse_word(key.source(), fmt::format("unknown option '{}'", name), name,
                            all_keys());
            }
        }
    }

    /// Everything that may stand at the top of the file.
    std::vector<std::string> all_keys() const {
        std::set<std::string> keys = {"result", "scene"};
        for (const std::string& command : commands_.names) {
            for (std::string& option : commands_.options_of(command))
                keys.insert(std::move(option));
        }
        return {keys.begin(), keys.end()};
    }

    Arguments command_line(const toml::table& result) const {
        const std::string command = command_of(result);
        // Later ones win: the file's own options, the scene's, the result's.
        std::map<std::string, const toml::node*> merged;
        const auto merge = [&](const toml::table& table) {
            for (const auto& [key, value] : table) {
                if (!is_structure(key.str())) merged[std::string(key.str())] = &value;
            }
        };
        merge(root_);
        if (const toml::table* scene = scene_of(result)) merge(*scene);
        for (const auto& [key, value] : result) {
            const std::string name(key.str());
            if (is_structure(name) || commands_.kind_of(command, name)) continue;
            refuse_word(key.source(), fmt::format("'{}' has no option '{}'", command, name), name,
                        commands_.options_of(command));
        }
        if (const toml::node* format = merged_format(merged, result)) {
            const std::string name = format->value_or(std::string());
            for (const std::string& key : commands_.useless_for(command, name)) merged.erase(key);
        }
        merge(result);

        Arguments positional, arguments = {command};
        for (const auto& [key, value] : merged) {
            if (const auto kind = commands_.kind_of(command, key)) {
                auto& words = *kind == OptionKind::positional ? positional : arguments;
                const auto more = option_words(
                    key, *value, *kind,
                    [this](const auto& where, const auto& reason) { refuse(where, reason); });
                words.insert(words.end(), more.begin(), more.end());
            }
        }
        arguments.insert(arguments.end(), positional.begin(), positional.end());
        return arguments;
    }

    static const toml::node* merged_format(const std::map<std::string, const toml::node*>& shared,
                                           const toml::table& result) {
        if (const toml::node* own = result.get("format")) return own;
        const auto found = shared.find("format");
        return found == shared.end() ? nullptr : found->second;
    }

    std::string command_of(const toml::table& result) const {
        const toml::node* node = result.get("command");
        if (node == nullptr || !node->is_string()) {
            refuse(result.source(), "a [[result]] needs a command, e.g. command = \"brdf\"");
        }
        std::string command = node->as_string()->get();
        const auto& names = commands_.names;
        if (std::find(names.begin(), names.end(), command) == names.end()) {
            refuse_word(
                node->source(),
                fmt::format("unknown command '{}'; allowed: {}", command, fmt::join(names, ", ")),
                command, names);
        }
        return command;
    }

    const toml::table* scene_of(const toml::table& result) const {
        const toml::node* node = result.get("scene");
        if (node == nullptr) return nullptr;
        const auto known = scenes();
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
    const SceneCommands& commands_;
    toml::table root_;
};

}  // namespace

std::vector<std::vector<std::string>> read_scene_file(const std::string& path,
                                                      const SceneCommands& commands) {
    return SceneFile(path, commands).command_lines();
}

}  // namespace miebrdf::program
