// miebrdf run: everything that a scene file asks for.
#include "tools/miebrdf/run_command.h"

#include <fmt/format.h>

#include "pipeline/error.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/program.h"
#include "tools/miebrdf/scene_file.h"

namespace miebrdf::program {
namespace {

/// Commands that a scene file may use: those that compute something.
const std::vector<std::string> kCommands = {
#ifdef MIEBRDF_HAS_RENDER
    "render",
#endif
    "brdf", "albedo", "optics", "phase", "sphere", "table1"};

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

int run(const std::string& path, const Shell& shell) {
    int worst = kGood;
    for (std::vector<std::string> line : scene_command_lines(path)) {
        if (shell.common().no_cache) line.emplace_back("--no-cache");
        if (shell.common().quiet) line.emplace_back("--quiet");
        if (shell.common().threads > 0) line.push_back(fmt::format("--threads={}", shell.common().threads));
        shell.note(command_line_of(line));
        const int code = run_program(line);
        if (code != kGood && code != kNotConverged) return code;
        worst = std::max(worst, code);
    }
    return worst;
}

}  // namespace

std::vector<std::vector<std::string>> scene_command_lines(const std::string& path) {
    CLI::App probe;
    Shell probe_shell("");
    add_commands(probe, probe_shell);
    return read_scene_file(path, kCommands, [&](const auto& command, const auto& name) {
        return kind_of(probe, command, name);
    });
}

void add_run_command(CLI::App& program, Shell& shell) {
    auto* command = program.add_subcommand("run", "everything that a scene file asks for");
    auto path = std::make_shared<std::string>();
    command->add_option("scene", *path, "scene file (TOML); its keys are the options of the commands")
        ->type_name("SCENE.toml")
        ->required();
    shell.add_common_options(*command);
    command->footer("Example:\n  miebrdf run docs/examples/paint.toml");
    shell.on_run(*command, [path, &shell] { return run(*path, shell); });
}

}  // namespace miebrdf::program
