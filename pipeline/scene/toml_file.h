// A TOML file of ours: what is wrong in it is said with file, line and column.
#pragma once

#define TOML_HEADER_ONLY 0  // it is in pipeline/scene/scene_file.cpp
#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <miebrdf/error.h>

namespace miebrdf {

/// The file of this name in the folder if there is one, else the name: names in files are relative
/// to them.
std::string found_in(const std::string& folder, const std::string& name);

class TomlFile {
  public:
    /// @param kind  names it in messages: "sweep file"
    /// @throws InputError  for what is no TOML
    TomlFile(std::string kind, std::string path, std::string_view text);

    const toml::table& root() const { return root_; }
    const std::string& path() const { return path_; }

    std::string located(const toml::source_region& where, const std::string& reason) const;
    [[noreturn]] void refuse(const toml::node& node, const std::string& reason) const;
    /// Names the nearest of those known.
    [[noreturn]] void refuse_word(const toml::source_region& where, const std::string& reason,
                                  std::string_view word,
                                  const std::vector<std::string>& known) const;
    /// @param what  "key"
    void check_keys(const toml::table& table, const std::vector<std::string>& known,
                    const std::string& what) const;

    /// Does something; what is wrong is said with the place of this value.
    template <typename Action>
    void at(const toml::node& node, const Action& action) const {
        try {
            action();
        } catch (const UsageError& error) {
            throw UsageError(located(node.source(), error.what()));
        } catch (const InputError& error) {
            throw InputError(located(node.source(), error.what()));
        }
    }

    /// Empty if there is no such key. @throws InputError  for anything but a text
    std::string text_of(const toml::table& table, const std::string& key) const;
    /// The table of this name at the top. @throws InputError  where there is none
    const toml::table& table_of(const std::string& key, const std::string& example) const;
    /// Keys in the order of the file; toml++ sorts them.
    static std::vector<std::pair<std::string, const toml::node*>> in_order(
        const toml::table& table);

  private:
    std::string kind_, path_;
    toml::table root_;
};

/// The whole file. @throws InputError
std::string read_toml_text(const std::string& kind, const std::string& path);

}  // namespace miebrdf
