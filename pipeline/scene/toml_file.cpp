#include "pipeline/scene/toml_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "materials/database/names.h"
#include "materials/readers/text_table.h"

namespace miebrdf {

std::string found_in(const std::string& folder, const std::string& name) {
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    std::error_code unreadable;
    return std::filesystem::is_regular_file(file, unreadable) ? file.string() : name;
}

TomlFile::TomlFile(std::string kind, std::string path, std::string_view text)
    : kind_(std::move(kind)), path_(std::move(path)) {
    try {
        root_ = toml::parse(text, path_);
    } catch (const toml::parse_error& error) {
        throw InputError(located(error.source(), std::string(error.description())));
    }
}

std::string TomlFile::located(const toml::source_region& where, const std::string& reason) const {
    return fmt::format("{} '{}', line {}, column {}: {}", kind_, path_, where.begin.line,
                       where.begin.column, reason);
}

void TomlFile::refuse(const toml::node& node, const std::string& reason) const {
    throw InputError(located(node.source(), reason));
}

void TomlFile::refuse_word(const toml::source_region& where, const std::string& reason,
                           std::string_view word, const std::vector<std::string>& known) const {
    const auto nearest = materials::nearest_names(word, known, 3);
    throw UsageError(located(
        where, reason + (nearest.empty()
                             ? fmt::format("; allowed: {}", fmt::join(known, ", "))
                             : fmt::format("; did you mean {}?", fmt::join(nearest, " or ")))));
}

void TomlFile::check_keys(const toml::table& table, const std::vector<std::string>& known,
                          const std::string& what) const {
    for (const auto& [key, value] : table) {
        const std::string name(key.str());
        if (std::find(known.begin(), known.end(), name) == known.end())
            refuse_word(key.source(), fmt::format("unknown {} '{}'", what, name), name, known);
    }
}

std::string TomlFile::text_of(const toml::table& table, const std::string& key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return {};
    const auto text = node->value_exact<std::string>();
    if (!text) refuse(*node, fmt::format("'{}' is a text", key));
    return *text;
}

const toml::table& TomlFile::table_of(const std::string& key, const std::string& example) const {
    const toml::node* node = root_.get(key);
    if (node == nullptr || !node->is_table())
        throw InputError(fmt::format("{} '{}' needs a table [{}], {}", kind_, path_, key, example));
    return *node->as_table();
}

std::vector<std::pair<std::string, const toml::node*>> TomlFile::in_order(
    const toml::table& table) {
    std::vector<std::pair<std::string, const toml::node*>> keys;
    for (const auto& [key, value] : table) keys.emplace_back(key.str(), &value);
    const auto place = [](const auto& entry) {
        const toml::source_position where = entry.second->source().begin;
        return std::pair(where.line, where.column);
    };
    std::sort(keys.begin(), keys.end(),
              [&](const auto& a, const auto& b) { return place(a) < place(b); });
    return keys;
}

std::string read_toml_text(const std::string& kind, const std::string& path) {
    const auto refuse = [&](const char* reason) {
        throw InputError(fmt::format("{} '{}' {}", kind, path, reason));
    };
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) refuse("does not exist");
    // Reading a pipe or a device may not end.
    if (!std::filesystem::is_regular_file(status)) refuse("is no ordinary file");
    if (::access(path.c_str(), R_OK) != 0) refuse("cannot be read");
    return materials::read_bytes(path);
}

}  // namespace miebrdf
