#include "tools/miebrdf/program.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "materials/database/names.h"
#include "materials/readers/text.h"
#include "pipeline/scene/species_keys.h"
#include "tools/miebrdf/processor_path.h"
#include "tools/miebrdf/terminal.h"

namespace miebrdf::program {
namespace {

constexpr std::size_t kMostSuggestions = 3;

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* sub : subcommands(app)) {
        if (!sub->get_name().empty()) names.push_back(sub->get_name());
    }
    return names;
}

/// The subcommand that was typed; null when there is none.
const CLI::App* typed_subcommand(const CLI::App& app) {
    for (const CLI::App* sub : subcommands(app)) {
        if (!sub->get_name().empty() && sub->parsed()) return sub;
    }
    return nullptr;
}

/// Words that belong elsewhere, and where: what people try first.
struct Elsewhere {
    const char* option;
    const char* place;
};
constexpr Elsewhere kElsewhere[] = {
    {"--radius",
     "a radius belongs to its medium: TiO2,radius=100nm; --effective-radius is that of all media "
     "that say none"},
    {"--size", "sizes belong to their medium: TiO2,radius=100nm"},
    {"--variance", "a variance belongs to its medium: TiO2,radius=100nm,variance=0.1"},
    {"--volume", "an amount belongs to its medium: 'TiO2,radius=100nm,volume=15% in PMMA'"},
    {"--mass", "an amount belongs to its medium: H2O_ice,radius=200,mass=20%"},
    {"--density",
     "a density belongs to its medium: C_graphite,density=1.8; --layer-density is "
     "that of the layers"},
    {"--host",
     "a host belongs to its medium: 'TiO2,radius=100nm in PMMA'; --host-index is that of "
     "all media that say none"},
    {"--thickness", "a thickness belongs to its coat: --coat 'TiO2,volume=15% in PMMA@40um'"},
    {"--depth", "a depth belongs to its coat: --coat TiO2@0.5 or, with amounts, @40um"},
};

std::string unknown_option(const std::string& word, const CLI::App& command) {
    const std::string name = word.substr(0, word.find('='));
    std::vector<std::string> known;
    for (const std::string& option : option_names(command)) known.push_back("--" + option);
    const bool takes_media =
        std::find(known.begin(), known.end(), "--effective-radius") != known.end();
    for (const Elsewhere& elsewhere : kElsewhere) {
        if (takes_media && name == elsewhere.option)
            return fmt::format("unknown option '{}' of {}; {}", name, command.get_name(),
                               elsewhere.place);
    }
    return fmt::format("unknown option '{}' of {}{}", name, command.get_name(),
                       did_you_mean(name, known));
}

/// `radius=100nm`
bool is_key(const std::string& word) {
    Species of_word;
    try {
        return take_keys("," + word, false, of_word).empty();
    } catch (const UsageError&) {
        return true;  // a key with a wrong value
    }
}

std::string unknown_word(const std::string& word, const CLI::App& command) {
    const std::vector<std::string> commands = command_names(command);
    if (commands.empty() && is_key(word)) {
        return fmt::format(
            "unexpected word '{}' after {}; what a medium says of itself follows it with a comma "
            "and without blanks: TiO2,{}",
            word, command.get_name(), word);
    }
    if (commands.empty()) {
        return fmt::format("unexpected word '{}' after {} (lists have commas and no blanks: 1,2,3)",
                           word, command.get_name());
    }
    const std::string nearest = did_you_mean(word, commands);
    return fmt::format(
        "unknown command '{}'{}", word,
        nearest.empty() ? fmt::format("; allowed: {}", fmt::join(commands, ", ")) : nearest);
}

/// `plan brfd --base TiO2`: a mistyped command may have been taken for a scene file.
std::optional<std::string> command_taken_for_file(const CLI::App& command) {
    const std::vector<std::string> commands = command_names(command);
    if (commands.empty() || typed_subcommand(command) != nullptr) return std::nullopt;
    for (const CLI::Option* option : command.get_options()) {
        if (!option->get_positional() || option->count() == 0) continue;
        const std::string word = option->results().front();
        if (!did_you_mean(word, commands).empty()) return unknown_word(word, command);
    }
    return std::nullopt;
}

std::optional<std::string> unknown_in(const CLI::App& command) {
    const std::vector<std::string> words = command.remaining();
    if (words.empty()) return std::nullopt;
    if (auto mistyped = command_taken_for_file(command)) return mistyped;
    const auto is_option = [](const std::string& word) {
        return word.size() > 1 && word.front() == '-';
    };
    const auto option = std::find_if(words.begin(), words.end(), is_option);
    const auto other = std::find_if_not(words.begin(), words.end(), is_option);
    // The options of a mistyped command are unknown here for that alone.
    const bool is_command = !command_names(command).empty() && typed_subcommand(command) == nullptr;
    if (is_command && option == words.begin() && other != words.end())
        return fmt::format("{} stands before a command; write the command first: {} {}", *option,
                           command.get_name(), fmt::join(command_names(command), ", "));
    if (other != words.end() && (is_command || option == words.end()))
        return unknown_word(*other, command);
    if (option != words.end()) return unknown_option(*option, command);
    return std::nullopt;
}

}  // namespace

std::string did_you_mean(std::string_view asked, const std::vector<std::string>& known) {
    const auto nearest = materials::nearest_names(asked, known, kMostSuggestions);
    return nearest.empty() ? "" : fmt::format("; did you mean {}?", fmt::join(nearest, " or "));
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        const std::vector<std::string>& long_names = option->get_lnames();
        names.insert(names.end(), long_names.begin(), long_names.end());
    }
    for (const CLI::App* group : subcommands(command)) {
        if (!group->get_name().empty()) continue;
        for (std::string& name : option_names(*group)) names.push_back(std::move(name));
    }
    return names;
}

std::string explain(const CLI::App& program, const CLI::ParseError& error) {
    std::string path = program.get_name();
    const CLI::App* command = &program;
    while (true) {
        if (const auto unknown = unknown_in(*command)) {
            return fmt::format("{} (see {} --help)", *unknown, path);
        }
        const CLI::App* next = typed_subcommand(*command);
        if (next == nullptr) break;
        command = next;
        path += " " + command->get_name();
    }
    return fmt::format("{} (see {} --help)", error.what(), path);
}

namespace {

int complain(int code, const std::string& message) {
    std::cerr << "miebrdf: error: " << materials::printable(message) << '\n';
    return code;
}

/// The word that stands where a command should, if none of them is called so.
std::optional<std::string> unknown_command(const CLI::App& command, const std::string& path) {
    if (const CLI::App* next = typed_subcommand(command))
        return unknown_command(*next, path + " " + next->get_name());
    if (command_names(command).empty()) return std::nullopt;
    const std::vector<std::string> words = command.remaining();
    const auto word = std::find_if(words.begin(), words.end(),
                                   [](const std::string& w) { return !w.empty() && w[0] != '-'; });
    if (word == words.end()) return std::nullopt;
    return fmt::format("{} (see {} --help)", unknown_word(*word, command), path);
}

/// The commands that these arguments can be about: describing all of them takes longer than many a
/// command. All where a word is not known, so that near ones can be named, and for --help.
std::span<const Command> commands_for(const std::vector<std::string>& arguments,
                                      std::span<const Command> all) {
    if (arguments.empty()) return all;
    if (arguments.size() == 1 && arguments.front() == "--version") return {};
    const auto typed = std::find_if(all.begin(), all.end(), [&](const Command& command) {
        return command.name == arguments.front();
    });
    return typed == all.end() ? all : all.subspan(std::size_t(typed - all.begin()), 1);
}

int parse_and_run(std::span<const Command> commands, const std::vector<std::string>& arguments) {
    CLI::App program{"From a material's complex refractive index to its spectral BRDF.", "miebrdf"};
    program.set_version_flag("--version", version_text);
    program.require_subcommand(1);
    program.footer("miebrdf COMMAND --help explains a command and shows an example.");
    Shell shell(command_line_of(arguments));
    add_commands(program, shell, commands_for(arguments, commands));
    try {
        // CLI11 takes its arguments from the back.
        program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::Success& success) {
        if (const auto unknown = unknown_command(program, program.get_name()))
            return complain(kUsage, *unknown);
        return program.exit(success);  // --help, --version
    } catch (const CLI::ParseError& error) {
        return complain(kUsage, explain(program, error));
    }
    refuse_to_overwrite(shell.common().output, arguments);
    const int code = shell.prepare()();
    if (code == kNotConverged) shell.note(shell.advice() + "; exit code 4");
    return code;
}

}  // namespace

void add_commands(CLI::App& parent, Shell& shell, std::span<const Command> commands) {
    for (const Command& command : commands)
        command.add(*parent.add_subcommand(command.name, command.help), shell);
}

void refuse_to_overwrite(const std::string& output, const std::vector<std::string>& read) {
    namespace fs = std::filesystem;
    std::error_code unknown;
    if (!fs::is_regular_file(output, unknown)) return;
    for (std::size_t i = 0; i < read.size(); ++i) {
        const bool is_output = read[i].starts_with("--output=") ||
                               (i > 0 && (read[i - 1] == "-o" || read[i - 1] == "--output"));
        if (is_output) continue;
        // FILE, FILE#2, name=FILE, kind:FILE
        const std::string word = read[i].substr(0, read[i].rfind('#'));
        for (const std::size_t begin : {std::size_t{0}, word.find('=') + 1, word.find(':') + 1}) {
            if (!fs::equivalent(word.substr(begin), output, unknown) || unknown) continue;
            throw UsageError(fmt::format(
                "'{}' is read by this command, which would replace it; give -o another file",
                output));
        }
    }
}

std::string command_line_of(const std::vector<std::string>& arguments) {
    constexpr char kSpecial[] = " \t\n\"'\\$&|;<>()*?[]{}#~`!";
    std::string line = "miebrdf";
    for (const std::string& word : arguments) {
        if (!word.empty() && word.find_first_of(kSpecial) == std::string::npos) {
            line += " " + word;
            continue;
        }
        line += " " + materials::shell_quoted(word);
    }
    return line;
}

std::string message_of(const Error& error) {
    std::string message = error.what();
    for (const SceneWord& word : scene_words()) {
        const std::string option = "--" + word.name;
        // The field that was at fault comes first; others may be named where they help.
        if (word.field == error.field() && message.rfind(word.field + ":", 0) == 0) {
            const std::string unit = word.unit.empty() ? "" : fmt::format(" ({})", word.unit);
            message.replace(0, word.field.size(), option + unit);
        }
        if (message.rfind(word.name + ":", 0) == 0) message.insert(0, "--");  // a word's own
        if (word.field.find('_') == std::string::npos) continue;              // an ordinary word
        for (std::size_t at = message.find(word.field); at != std::string::npos;
             at = message.find(word.field, at + 1)) {
            // Quotes and a comma without a space belong to the header of a file, " =" to a line.
            const std::string next = message.substr(at + word.field.size(), 2);
            if ((at > 0 && message[at - 1] == '\'') || next == " =" ||
                (!next.empty() && next[0] == ',' && next != ", "))
                continue;
            message.replace(at, word.field.size(), option);
        }
    }
    if (error.field() == "wavelength_nm" && dynamic_cast<const InputError*>(&error) != nullptr)
        message +=
            "; `miebrdf materials search TEXT --covers 300:5000` lists tables that go further, "
            "`miebrdf materials import` takes your own";
    return message;
}

int run_program(std::span<const Command> commands, const std::vector<std::string>& arguments) {
    try {
        return parse_and_run(commands, arguments);
    } catch (const Cancelled&) {
        return complain(interrupt_exit_code(), "interrupted; nothing unfinished was written");
    } catch (const UsageError& error) {
        return complain(kUsage, message_of(error));
    } catch (const Error& error) {
        return complain(kBadInput, message_of(error));
    } catch (const std::invalid_argument& error) {
        return complain(kUsage, error.what());
    } catch (const std::bad_alloc&) {
        return complain(kBadInput, "not enough memory for this request");
    } catch (const std::exception& error) {
        return complain(kBadInput, error.what());
    }
}

void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int kLargest = 256 << 20;
    ::mallopt(M_MMAP_THRESHOLD, kLargest);
    ::mallopt(M_TRIM_THRESHOLD, kLargest);
    ::mallopt(M_TOP_PAD, 16 << 20);
#endif
}

int run_main(std::span<const Command> commands, int argc, char** argv) {
    try {
        obey_processor_path(argv);
    } catch (const UsageError& error) {
        return complain(kUsage, error.what());
    }
    keep_freed_memory();
    std::signal(SIGXFSZ, SIG_IGN);  // a limit of file sizes is an error of writing, no death
    return run_program(commands, {argv + 1, argv + argc});
}

}  // namespace miebrdf::program
