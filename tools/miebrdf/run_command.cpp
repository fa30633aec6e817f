// miebrdf run: everything that a scene file asks for.
#include "tools/miebrdf/run_command.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/solve/shared_work.h"
#include "tools/miebrdf/commands.h"
#include "tools/miebrdf/export_formats.h"
#include "tools/miebrdf/program.h"
#include "tools/miebrdf/scene_file.h"
#include "tools/miebrdf/scene_requests.h"
#include "tools/miebrdf/suggestions.h"

namespace miebrdf::program {
namespace {

/// Names of the commands that a scene file may use: those that compute something.
std::vector<std::string> scene_commands() {
    std::vector<std::string> names;
    for (const Command& command : commands()) {
        if (command.in_scene_files) names.emplace_back(command.name);
    }
    return names;
}

/// The commands' own parsers are what knows their options.
std::optional<OptionKind> kind_of(const CLI::App& program, const std::string& command,
                                  const std::string& name) {
    const CLI::App* app = program.get_subcommand(command);
    const CLI::Option* option = app->get_option_no_throw("--" + name);
    if (option == nullptr) {
        option = app->get_option_no_throw(name);
        if (option == nullptr || !option->get_positional()) return std::nullopt;
        return OptionKind::positional;
    }
    if (option->get_items_expected_max() == 0) return OptionKind::flag;
    return option->get_items_expected_max() > 1 ? OptionKind::repeated : OptionKind::single;
}

/// An option of `run` for one result: it takes the place of what the scene file says.
void override_option(std::vector<std::string>& line, const std::string& name,
                     const std::string& value) {
    std::erase_if(line, [&](const std::string& word) { return word.rfind(name + "=", 0) == 0; });
    line.push_back(name + "=" + value);
}

/// The results as they will be run, with the options of `run` itself.
std::vector<std::vector<std::string>> lines_of(const std::string& path, const Shell& shell) {
    const CommonOptions& common = shell.common();
    if (!common.output.empty()) {
        throw UsageError(
            "run writes as many files as its scene file has results; give each its own "
            "'output' there");
    }
    std::vector<std::vector<std::string>> lines = scene_command_lines(path);
    for (std::vector<std::string>& line : lines) {
        for (const auto& [flag, given] : {std::pair("--no-cache", common.no_cache),
                                          {"--quiet", common.quiet},
                                          {"--json", common.json}}) {
            if (given) line.emplace_back(flag);
        }
        if (common.threads > 0) override_option(line, "--threads", std::to_string(common.threads));
        if (common.progress != "auto") override_option(line, "--progress", common.progress);
    }
    return lines;
}

/// Two results that name one file: the second would replace the first.
void refuse_one_file_twice(const std::vector<std::vector<std::string>>& lines) {
    std::map<std::filesystem::path, std::size_t> owner;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        for (const std::string& file : output_files(lines[i])) {
            const auto path = std::filesystem::weakly_canonical(file);
            if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path))
                continue;  // pipes and devices take one after the other
            const auto [other, first] = owner.emplace(path, i);
            if (first) continue;
            throw UsageError(fmt::format(
                "results {} ({}) and {} ({}) would both write '{}'; give each its own 'output'",
                other->second + 1, lines[other->second].front(), i + 1, lines[i].front(), file));
        }
    }
}

/// Tells what the results have in common. Mistakes in any of them come to light here, before the
/// first is computed.
void expect(const std::vector<std::vector<std::string>>& lines, SharedWork& shared) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const std::string result = fmt::format("result {} ({}): ", i + 1, lines[i].front());
        try {
            check(lines[i]);
            if (const auto layers = layer_request(lines[i])) {
                shared.expect(layers->request, layers->quantity);
            }
        } catch (const UsageError& error) {
            throw UsageError(result + error.what());
        } catch (const InputError& error) {
            throw InputError(result + error.what());
        }
    }
}

int run(const std::string& path, const Shell& shell) {
    const std::vector<std::vector<std::string>> lines = lines_of(path, shell);
    refuse_one_file_twice(lines);
    SharedWork shared;
    expect(lines, shared);
    int worst = kGood;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        shell.note(
            fmt::format("result {} of {}: {}", i + 1, lines.size(), command_line_of(lines[i])));
        const int code = run_program(commands(), lines[i], &shared);
        if (code != kGood && code != kNotConverged) return code;
        worst = std::max(worst, code);
    }
    return worst;
}

}  // namespace

std::vector<std::vector<std::string>> scene_command_lines(const std::string& path) {
    CLI::App probe;
    Shell probe_shell("");
    add_commands(probe, probe_shell, commands());
    const SceneCommands commands = {
        scene_commands(),
        [&](const auto& command, const auto& name) { return kind_of(probe, command, name); },
        [&](const auto& command) { return option_names(*probe.get_subcommand(command)); },
        [](const auto& command, const auto& format) {
            std::vector<std::string> keys;
            if (command != "export") return keys;
            for (const std::string& option : ignored_options_of(format))
                keys.push_back(option.substr(2));  // without its dashes
            return keys;
        }};
    return read_scene_file(path, commands);
}

void add_run(CLI::App& command, Shell& shell) {
    auto path = std::make_shared<std::string>();
    command
        .add_option("scene", *path, "scene file (TOML); its keys are the options of the commands")
        ->type_name("SCENE.toml")
        ->required();
    shell.add_common_options(command);
    command.footer("Example:\n  miebrdf run docs/examples/paint.toml");
    shell.on_run(command, [path, &shell] { return run(*path, shell); });
}

}  // namespace miebrdf::program
