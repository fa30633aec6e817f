// miebrdf run: everything that a scene file asks for.
#include "tools/miebrdf/run_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include <miebrdf/error.h>
#include "tools/miebrdf/commands.h"
#include "tools/miebrdf/export_options.h"
#include "tools/miebrdf/program.h"

namespace miebrdf::program {
namespace {

/// A command's options, with what its own parser knows of them.
CommandKey key_of(const std::string& name, const CLI::Option& option) {
    if (option.get_items_expected_max() == 0) return {name, WordKind::flag};
    return {name, option.get_items_expected_max() > 1 ? WordKind::repeated : WordKind::single};
}

SceneFileCommand file_command(const Command& command) {
    CLI::App probe;
    Shell shell("");
    command.add(probe, shell);
    SceneFileCommand known{command.name, shell.scene_words(), {}, {}};
    const auto is_word = [&](const std::string& name) {
        return std::find(known.words.begin(), known.words.end(), name) != known.words.end();
    };
    for (const std::string& name : option_names(probe)) {
        if (!is_word(name) && name != "help" && name != "version")
            known.keys.push_back(key_of(name, *probe.get_option("--" + name)));
    }
    for (const CLI::Option* option : probe.get_options()) {
        if (option->get_positional()) known.keys.push_back(key_of(option->get_name(), *option));
    }
    if (known.name == "export") {
        known.useless_for = [](const std::string& format) {
            std::vector<std::string> keys = ignored_options_of(format);
            for (std::string& key : keys) key = key.substr(2);  // without its dashes
            return keys;
        };
    }
    return known;
}

bool is_output(const SceneFileKey& key) { return key.name == "output" || key.name == "exr"; }

/// Two results that name one file: the second would replace the first.
void refuse_one_file_twice(const std::vector<SceneFileResult>& results) {
    std::map<std::filesystem::path, std::size_t> owner;
    for (std::size_t i = 0; i < results.size(); ++i) {
        for (const SceneFileKey& key : results[i].keys) {
            if (!is_output(key)) continue;
            const std::string file = text_of(key.values.front());
            if (file == "-") continue;
            const auto path = std::filesystem::weakly_canonical(file);
            if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path))
                continue;  // pipes and devices take one after the other
            const auto [other, first] = owner.emplace(path, i);
            if (first) continue;
            throw UsageError(fmt::format(
                "results {} ({}) and {} ({}) would both write '{}'; give each its own 'output'",
                other->second + 1, results[other->second].command, i + 1, results[i].command,
                file));
        }
    }
}

/// Does something for one result; what is wrong with it is said with its number.
template <typename Action>
auto for_result(std::size_t number, const SceneFileResult& result, const Action& action) {
    const auto located = [&](const Error& error) {
        return fmt::format("result {} ({}): {}", number, result.command, message_of(error));
    };
    try {
        return action();
    } catch (const UsageError& error) {
        throw UsageError(located(error));
    } catch (const InputError& error) {
        throw InputError(located(error));
    }
}

/// The options of `run` hold for all its results, over what the file says.
void override_options(CLI::App& command, const CommonOptions& of_run) {
    const auto set = [&](const char* name, const std::string& value) {
        CLI::Option* option = command.get_option(name);
        option->clear();
        option->add_result(value);
    };
    if (of_run.json) set("--json", "true");
    if (of_run.no_comments && command.get_option_no_throw("--no-comments") != nullptr)
        set("--no-comments", "true");
    if (of_run.quiet) set("--quiet", "true");
    if (of_run.no_cache) set("--no-cache", "true");
    if (of_run.threads > 0) set("--threads", std::to_string(of_run.threads));
    if (of_run.progress != "auto") set("--progress", of_run.progress);
}

void give_keys(const SceneFileResult& result, CLI::App& command) {
    for (const SceneFileKey& key : result.keys) {
        CLI::Option* option = command.get_option_no_throw("--" + key.name);
        if (option == nullptr) option = command.get_option(key.name);  // without a dash
        std::vector<std::string> texts;
        for (const WordValue& value : key.values) texts.push_back(text_of(value));
        if (key.kind == WordKind::repeated) {
            option->add_result(texts);
        } else {
            option->add_result(fmt::format("{}", fmt::join(texts, ",")));
        }
    }
}

/// Has the options read that were given.
void parse_given(CLI::App& command) {
    try {
        std::vector<std::string> nothing_typed;
        command.parse(nothing_typed);
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
}

/// A result on its way: its command, with the options that the file gave it.
struct Running {
    std::unique_ptr<CLI::App> command;
    std::unique_ptr<Shell> shell;
    Job job;
};

Running prepare(const SceneFileResult& result, const std::string& origin,
                const CommonOptions& of_run, const std::shared_ptr<OpticsMemo>& memo) {
    const Command& command = *find_command(result.command);
    Running running{std::make_unique<CLI::App>(command.help, command.name),
                    std::make_unique<Shell>(origin, &result, memo),
                    {}};
    command.add(*running.command, *running.shell);
    give_keys(result, *running.command);
    override_options(*running.command, of_run);
    parse_given(*running.command);
    running.job = running.shell->prepare();
    return running;
}

int run(const std::string& path, const Shell& shell) {
    if (!shell.common().output.empty()) {
        throw UsageError(
            "run writes as many files as its scene file has results; give each its own "
            "'output' there");
    }
    const std::vector<SceneFileResult> results = read_scene_results(path);
    refuse_one_file_twice(results);
    for (const SceneFileResult& result : results) {
        std::vector<std::string> read = {path};
        for (const SceneFileKey& key : result.keys) {
            if (is_output(key)) continue;
            for (const WordValue& value : key.values) read.push_back(text_of(value));
        }
        for (const SceneFileKey& key : result.keys) {
            if (is_output(key)) refuse_to_overwrite(text_of(key.values.front()), read);
        }
    }
    // Mistakes in any result come to light here, before the first is computed.
    const std::shared_ptr<OpticsMemo> memo = make_optics_memo();
    std::vector<Running> all;
    for (std::size_t i = 0; i < results.size(); ++i) {
        const std::string origin =
            fmt::format("miebrdf run {}, result {}: {}", path, i + 1, results[i].text);
        all.push_back(for_result(
            i + 1, results[i], [&] { return prepare(results[i], origin, shell.common(), memo); }));
    }
    int worst = kGood;
    for (std::size_t i = 0; i < all.size(); ++i) {
        shell.note(fmt::format("result {} of {}: {}", i + 1, all.size(), results[i].text));
        const int code = for_result(i + 1, results[i], all[i].job);
        all[i] = {};  // its matrices are not needed any more
        if (code != kGood && code != kNotConverged) return code;
        if (code == kNotConverged) shell.note(fmt::format("result {}: not converged", i + 1));
        worst = std::max(worst, code);
    }
    return worst;
}

}  // namespace

namespace {

std::vector<SceneFileCommand> known_commands() {
    std::vector<SceneFileCommand> known;
    for (const Command& command : commands()) {
        if (command.in_scene_files) known.push_back(file_command(command));
    }
    return known;
}

}  // namespace

std::vector<SceneFileResult> read_scene_results(const std::string& path) {
    return read_scene_file(path, known_commands());
}

std::vector<NamedScene> read_scenes(const std::string& path) {
    return read_named_scenes(path, known_commands());
}

void read_keys(const SceneFileResult& result, CLI::App& command) {
    give_keys(result, command);
    parse_given(command);
}

void add_run(CLI::App& command, Shell& shell) {
    auto path = std::make_shared<std::string>();
    option(command, "scene", *path, "SCENE.toml",
           "scene file (TOML); its keys are the options of the commands, without dashes")
        ->required();
    finish(command, shell, path, run, "Example:\n  miebrdf run docs/examples/paint.toml");
}

}  // namespace miebrdf::program
