#include "tools/miebrdf/file_origin.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include <miebrdf/error.h>
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

/// Longer command lines are not looked for.
constexpr std::size_t kLongestCommand = std::size_t{1} << 16;
constexpr std::size_t kBlock = std::size_t{1} << 20;

constexpr std::string_view kProgram = "miebrdf ";

/// The string that begins at `text[0] == '"'`; empty when it is no whole JSON string.
std::string json_string(std::string_view text) {
    std::size_t end = 1;
    while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
    if (end >= text.size()) return "";
    const auto value = nlohmann::json::parse(text.substr(0, end + 1), nullptr, false);
    return value.is_string() ? value.get<std::string>() : "";
}

/// Comments of XML hold no "--" and are written with "- -".
std::string without_gaps(std::string command) {
    if (command.find("--") != std::string::npos) return command;
    for (std::size_t at; (at = command.find("- -")) != std::string::npos;) command.erase(at + 1, 1);
    return command;
}

/// In JSON, whatever lies around it: "command": "miebrdf ...".
std::string command_in_json(std::string_view text) {
    constexpr std::string_view kKey = "\"command\":";
    for (std::size_t at = 0; (at = text.find(kKey, at)) != text.npos;) {
        at = text.find_first_not_of(' ', at + kKey.size());
        if (at == text.npos || text[at] != '"') continue;
        const std::string value = json_string(text.substr(at, kLongestCommand));
        if (value.starts_with(kProgram)) return without_gaps(value);
    }
    return "";
}

/// In a line of CSV: # command: miebrdf ...
std::string command_in_comment(std::string_view text) {
    constexpr std::string_view kLine = "# command: ";
    const std::size_t at = text.find(kLine);
    if (at == text.npos) return "";
    const std::string_view line = text.substr(at + kLine.size(), kLongestCommand);
    const std::size_t end = line.find_first_of("\r\n");
    if (end == line.npos || !line.starts_with(kProgram)) return "";
    return std::string(line.substr(0, end));
}

std::string command_in_stream(std::istream& stream) {
    std::string text;
    while (stream) {
        // A match that the end of a block cut off is looked at again with the next one.
        if (text.size() > kLongestCommand) text.erase(0, text.size() - kLongestCommand);
        const std::size_t kept = text.size();
        text.resize(kept + kBlock);
        stream.read(text.data() + kept, kBlock);
        text.resize(kept + std::size_t(stream.gcount()));
        std::string command = command_in_json(text);
        if (command.empty()) command = command_in_comment(text);
        if (!command.empty()) return command;
    }
    return "";
}

/// The scene's words among others, which are left alone.
class MadeBy {
  public:
    explicit MadeBy(const std::string& command_line)
        : words_(words_of_command(command_line)), shell_(command_line) {
        app_.allow_extras();
        app_.set_help_flag();
        scene_.add_to(app_, shell_);
        app_.add_option("--component", found_.component);
        app_.add_option("--rgb", found_.rgb);
    }

    SceneOfFile read() {
        const bool has_scene = words_.size() > 2 && (words_[1] == "export" || words_[1] == "brdf");
        if (!has_scene)
            throw UsageError("only commands of `miebrdf export` and `miebrdf brdf` say a scene");
        // CLI11 takes its arguments from the back.
        app_.parse(std::vector<std::string>(words_.rbegin(), words_.rend() - 2));
        found_.request = scene_.parse();
        if (words_[1] == "export" && !scene_.given("coupling"))
            found_.request.scene.coupling = rte::SurfaceCoupling::reciprocal;
        return std::move(found_);
    }

  private:
    std::vector<std::string> words_;
    Shell shell_;
    CLI::App app_;
    SceneArguments scene_;
    SceneOfFile found_;
};

}  // namespace

std::string command_of_file(const std::string& path) {
    std::ifstream file;
    if (std::filesystem::is_regular_file(path)) file.open(path, std::ios::binary);
    if (!file.is_open()) throw InputError(fmt::format("'{}' cannot be read", path));
    std::string command = command_in_stream(file);
    if (!command.empty()) return command;
    std::ifstream sidecar(path + ".json", std::ios::binary);
    return command_in_stream(sidecar);
}

std::vector<std::string> words_of_command(const std::string& command_line) {
    std::vector<std::string> words;
    bool quoted = false, within = false;
    for (std::size_t i = 0; i < command_line.size(); ++i) {
        const char c = command_line[i];
        if (!quoted && c == ' ') {
            within = false;
            continue;
        }
        if (!within) words.emplace_back();
        within = true;
        if (c == '\'') {
            quoted = !quoted;
        } else if (!quoted && c == '\\' && i + 1 < command_line.size()) {
            words.back() += command_line[++i];
        } else {
            words.back() += c;
        }
    }
    return words;
}

SceneOfFile scene_of_file(const std::string& path) {
    const std::string command = command_of_file(path);
    constexpr const char* kRemedy = "give the scene's options (--base ...) in place of --own-scene";
    if (command.empty()) {
        throw InputError(
            fmt::format("'{}' does not say by which command it was made; {}", path, kRemedy));
    }
    try {
        return MadeBy(command).read();
    } catch (const CLI::ParseError& error) {
        throw InputError(
            fmt::format("'{}' was made by `{}`: {}; {}", path, command, error.what(), kRemedy));
    } catch (const UsageError& error) {
        throw InputError(
            fmt::format("'{}' was made by `{}`: {}; {}", path, command, error.what(), kRemedy));
    }
}

}  // namespace miebrdf::program
