#include "tools/miebrdf/scene_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "pipeline/error.h"

namespace miebrdf::program {
namespace {

using Arguments = std::vector<std::string>;

class SceneFile {
  public:
    SceneFile(const std::string& path, const std::vector<std::string>& commands,
              const OptionLookup& lookup)
        : path_(path), commands_(commands), lookup_(lookup) {
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
        const toml::array* results = nullptr;
        if (const toml::node* node = root_.get("result")) results = node->as_array();
        if (results == nullptr || results->empty() || !results->is_array_of_tables()) {
            throw InputError(fmt::format("scene file '{}' asks for nothing; add a [[result]] with "
                                         "command = \"brdf\"", path_));
        }
        check_shared_keys(root_);
        for (const auto& [name, scene] : scenes()) check_shared_keys(*scene);
        std::vector<Arguments> lines;
        for (const toml::node& result : *results) lines.push_back(command_line(*result.as_table()));
        return lines;
    }

  private:
    [[noreturn]] void refuse(const toml::source_region& where, const std::string& reason) const {
        throw InputError(fmt::format("scene file '{}', line {}, column {}: {}", path_,
                                     where.begin.line, where.begin.column, reason));
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
            if (is_structure(name)) continue;
            const bool known = std::any_of(commands_.begin(), commands_.end(), [&](const auto& c) {
                return lookup_(c, name).has_value();
            });
            if (!known) refuse(key.source(), fmt::format("unknown option '{}'", name));
        }
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
            if (is_structure(key.str()) || lookup_(command, std::string(key.str()))) continue;
            refuse(key.source(), fmt::format("'{}' has no option '{}'", command, key.str()));
        }
        merge(result);

        Arguments positional, arguments = {command};
        for (const auto& [key, value] : merged) {
            if (const auto kind = lookup_(command, key)) {
                append(key, *value, *kind, *kind == OptionKind::positional ? positional : arguments);
            }
        }
        arguments.insert(arguments.end(), positional.begin(), positional.end());
        return arguments;
    }

    std::string command_of(const toml::table& result) const {
        const toml::node* node = result.get("command");
        if (node == nullptr || !node->is_string()) {
            refuse(result.source(), "a [[result]] needs a command, e.g. command = \"brdf\"");
        }
        std::string command = node->as_string()->get();
        if (std::find(commands_.begin(), commands_.end(), command) == commands_.end()) {
            refuse(node->source(), fmt::format("unknown command '{}'; allowed: {}", command,
                                               fmt::join(commands_, ", ")));
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
        refuse(node->source(), fmt::format("no such scene; this file has: {}", fmt::join(names, ", ")));
    }

    void append(const std::string& key, const toml::node& value, OptionKind kind,
                Arguments& arguments) const {
        if (kind == OptionKind::flag) {
            if (!value.is_boolean()) refuse(value.source(), fmt::format("'{}' is true or false", key));
            if (value.as_boolean()->get()) arguments.push_back("--" + key);
            return;
        }
        const std::vector<std::string> texts = texts_of(key, value);
        if (kind == OptionKind::repeated) {
            for (const std::string& text : texts) {
                arguments.push_back(fmt::format("--{}={}", key, text));
            }
            return;
        }
        const std::string joined = fmt::format("{}", fmt::join(texts, ","));
        arguments.push_back(kind == OptionKind::positional ? joined
                                                           : fmt::format("--{}={}", key, joined));
    }

    std::vector<std::string> texts_of(const std::string& key, const toml::node& value) const {
        std::vector<std::string> texts;
        if (const toml::array* list = value.as_array()) {
            for (const toml::node& item : *list) texts.push_back(text_of(key, item));
        } else {
            texts.push_back(text_of(key, value));
        }
        return texts;
    }

    std::string text_of(const std::string& key, const toml::node& value) const {
        if (const auto* text = value.as_string()) return text->get();
        if (const auto* integer = value.as_integer()) return fmt::format("{}", integer->get());
        if (const auto* number = value.as_floating_point()) return fmt::format("{}", number->get());
        refuse(value.source(), fmt::format("'{}' takes a number, a text or a list of them", key));
    }

    std::string path_;
    const std::vector<std::string>& commands_;
    const OptionLookup& lookup_;
    toml::table root_;
};

}  // namespace

std::vector<std::vector<std::string>> read_scene_file(const std::string& path,
                                                      const std::vector<std::string>& commands,
                                                      const OptionLookup& lookup) {
    return SceneFile(path, commands, lookup).command_lines();
}

}  // namespace miebrdf::program
