// miebrdf completion, miebrdf manual: what --help says, as scripts for shells and as a man page.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "materials/readers/text.h"
#include "tools/miebrdf/commands.h"
#include "tools/miebrdf/program.h"

namespace miebrdf::program {
namespace {

struct DescribedOption {
    std::string long_name, short_name;  ///< without dashes; both empty for a positional one
    std::string value;                  ///< "FILE"; empty for flags
    std::string help;
    bool positional = false;
};

/// A command as its CLI::App describes it.
struct DescribedCommand {
    std::vector<std::string> path;  ///< "materials", "list"; empty: the program
    std::string help, example;
    std::vector<DescribedOption> options;
    std::vector<std::string> subcommands;

    std::string name() const { return fmt::format("{}", fmt::join(path, " ")); }
};

std::string in_one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

DescribedOption described(const CLI::Option& option) {
    DescribedOption result;
    result.positional = option.get_positional();
    if (!option.get_lnames().empty()) result.long_name = option.get_lnames().front();
    if (!option.get_snames().empty()) result.short_name = option.get_snames().front();
    if (option.get_items_expected_max() > 0)
        result.value = result.positional ? option.get_name() : option.get_type_name();
    result.help = in_one_line(option.get_description());
    if (!option.get_default_str().empty() && !result.value.empty())
        result.help += fmt::format(" [{}]", option.get_default_str());
    return result;
}

/// The command's own options and those of its groups, which are subcommands without a name.
void add_options(const CLI::App& app, DescribedCommand& command,
                 std::vector<const CLI::App*>& subcommands) {
    for (const CLI::Option* option : app.get_options())
        command.options.push_back(described(*option));
    for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (sub->get_name().empty()) {
            add_options(*sub, command, subcommands);
        } else {
            command.subcommands.push_back(sub->get_name());
            subcommands.push_back(sub);
        }
    }
}

void describe(const CLI::App& app, const std::vector<std::string>& path,
              std::vector<DescribedCommand>& all) {
    DescribedCommand command;
    command.path = path;
    command.help = in_one_line(app.get_description());
    command.example = app.get_footer();
    std::vector<const CLI::App*> subcommands;
    add_options(app, command, subcommands);
    all.push_back(command);
    for (const CLI::App* sub : subcommands) {
        std::vector<std::string> below = path;
        below.push_back(sub->get_name());
        describe(*sub, below, all);
    }
}

/// The program first, then every command before those below it.
std::vector<DescribedCommand> describe_program() {
    CLI::App program{"From a material's complex refractive index to its spectral BRDF.", "miebrdf"};
    program.set_version_flag("--version", std::string(kVersion));
    Shell shell("miebrdf");
    add_commands(program, shell, commands());
    std::vector<DescribedCommand> all;
    describe(program, {}, all);
    return all;
}

const DescribedCommand& command_at(const std::vector<DescribedCommand>& all,
                                   const DescribedCommand& above, const std::string& name) {
    std::vector<std::string> path = above.path;
    path.push_back(name);
    return *std::find_if(all.begin(), all.end(),
                         [&](const DescribedCommand& c) { return c.path == path; });
}

std::vector<std::string> words_of(const DescribedCommand& command) {
    std::vector<std::string> words = command.subcommands;
    for (const DescribedOption& option : command.options) {
        if (!option.long_name.empty()) words.push_back("--" + option.long_name);
    }
    return words;
}

constexpr char kOrigin[] = "# Written by `miebrdf completion {}`.\n";

std::string bash_completion() {
    const auto all = describe_program();
    std::string paths, cases, values;
    for (const DescribedCommand& command : all) {
        const std::string name = command.name();
        if (!name.empty()) paths += fmt::format("{}'{}'", paths.empty() ? "" : "|", name);
        cases +=
            fmt::format("        '{}') words='{}' ;;\n", name, fmt::join(words_of(command), " "));
        for (const DescribedOption& option : command.options) {
            if (option.value.empty()) continue;
            for (const std::string& spelled :
                 {option.long_name.empty() ? "" : "--" + option.long_name,
                  option.short_name.empty() ? "" : "-" + option.short_name}) {
                if (!spelled.empty() && values.find("|" + spelled + "|") == std::string::npos)
                    values += (values.empty() ? "|" : "") + spelled + "|";
            }
        }
    }
    values = values.substr(1, values.size() - 2);
    return fmt::format(kOrigin, "bash") + R"(_miebrdf() {
    local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} path= word words
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        case "${path:+$path }$word" in
        )" +
           paths +
           R"() path="${path:+$path }$word" ;;
        esac
    done
    case "$path" in
)" + cases +
           R"(    esac
    case "$before" in
        )" +
           values +
           R"() COMPREPLY=($(compgen -f -- "$current")) ;;
        *) COMPREPLY=($(compgen -W "$words" -- "$current"))
           [[ $current == -* || ${#COMPREPLY[@]} -gt 0 ]] || COMPREPLY=($(compgen -f -- "$current")) ;;
    esac
}
complete -o filenames -F _miebrdf miebrdf
)";
}

/// Inside a specification of _arguments, between single quotes.
std::string zsh_escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return result;
}

std::string zsh_function(const DescribedCommand& command) {
    std::string name = "_miebrdf";
    for (const std::string& word : command.path) name += "_" + word;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

std::string zsh_completion() {
    const auto all = describe_program();
    std::string text = "#compdef miebrdf\n" + fmt::format(kOrigin, "zsh");
    for (const DescribedCommand& command : all) {
        text += zsh_function(command) + "() {\n    local line state\n    _arguments -C";
        for (const DescribedOption& option : command.options) {
            if (option.positional) continue;
            const std::string value =
                option.value.empty() ? "" : fmt::format(":{}:_files", zsh_escaped(option.value));
            for (const std::string& spelled :
                 {option.long_name.empty() ? "" : "--" + option.long_name,
                  option.short_name.empty() ? "" : "-" + option.short_name}) {
                if (!spelled.empty())
                    text += fmt::format(" \\\n        '*{}[{}]{}'", spelled,
                                        zsh_escaped(option.help), value);
            }
        }
        if (command.subcommands.empty()) {
            text += " \\\n        '*:file:_files'\n}\n";
            continue;
        }
        text +=
            " \\\n        '1:command:->command' '*::argument:->argument'\n    case $state in\n"
            "    command)\n        local -a commands=(\n";
        for (const std::string& sub : command.subcommands)
            text += fmt::format("            '{}:{}'\n", sub,
                                zsh_escaped(command_at(all, command, sub).help));
        text +=
            "        )\n        _describe command commands ;;\n    argument)\n"
            "        case $line[1] in\n";
        for (const std::string& sub : command.subcommands)
            text += fmt::format("        {}) {} ;;\n", sub,
                                zsh_function(command_at(all, command, sub)));
        text += "        esac ;;\n    esac\n}\n";
    }
    return text +
           "if [[ $funcstack[1] == _miebrdf ]]; then _miebrdf \"$@\"; else compdef _miebrdf "
           "miebrdf; fi\n";
}

std::string fish_completion() {
    const auto all = describe_program();
    std::string text = fmt::format(kOrigin, "fish");
    for (const DescribedCommand& command : all) {
        // All words of the path were typed, and none of those that may follow.
        std::string when;
        for (const std::string& word : command.path)
            when +=
                fmt::format("{}__fish_seen_subcommand_from {}", when.empty() ? "" : "; and ", word);
        std::string choosing = when;
        if (!command.subcommands.empty())
            choosing +=
                fmt::format("{}not __fish_seen_subcommand_from {}", when.empty() ? "" : "; and ",
                            fmt::join(command.subcommands, " "));
        for (const std::string& sub : command.subcommands)
            text += fmt::format("complete -c miebrdf -n '{}' -f -a {} -d {}\n", choosing, sub,
                                materials::shell_quoted(command_at(all, command, sub).help));
        for (const DescribedOption& option : command.options) {
            if (option.positional) continue;
            text += "complete -c miebrdf";
            if (!choosing.empty()) text += " -n " + materials::shell_quoted(choosing);
            if (!option.long_name.empty()) text += " -l " + option.long_name;
            if (!option.short_name.empty()) text += " -s " + option.short_name;
            text += option.value.empty() ? "" : " -r";
            text += " -d " + materials::shell_quoted(option.help) + "\n";
        }
    }
    return text;
}

/// For the man page: no line begins with a control character.
std::string roff(const std::string& text) {
    std::string result;
    bool line_begins = true;
    for (const char c : text) {
        if (line_begins && (c == '.' || c == '\'')) result += "\\&";
        if (c == '\\') {
            result += "\\e";
        } else if (c == '-') {
            result += "\\-";
        } else {
            result += c;
        }
        line_begins = c == '\n';
    }
    return result;
}

std::string roff_option(const DescribedOption& option) {
    std::string names;
    if (option.positional) {
        names = fmt::format("\\fI{}\\fR", roff(option.value));
    } else {
        if (!option.short_name.empty()) names += fmt::format("\\fB\\-{}\\fR, ", option.short_name);
        names += fmt::format("\\fB\\-\\-{}\\fR", roff(option.long_name));
        if (!option.value.empty()) names += fmt::format(" \\fI{}\\fR", roff(option.value));
    }
    return fmt::format(".TP\n{}\n{}\n", names, roff(option.help));
}

std::string manual() {
    const auto all = describe_program();
    std::string text = fmt::format(
        ".\\\" Written by `miebrdf manual`.\n.TH MIEBRDF 1 \"\" \"miebrdf {}\" \"User Commands\"\n"
        ".SH NAME\nmiebrdf \\- {}\n.SH SYNOPSIS\n.B miebrdf\n.I COMMAND\n[\\fIOPTION\\fR]...\n"
        ".SH DESCRIPTION\nLooks up n + ik in a database with sources, averages Mie theory over a "
        "size distribution, solves radiative transfer for a base under coats, adds a rough "
        "surface, and writes the values with an error estimate. Output is CSV on standard output, "
        "unless options say otherwise.\n.SH COMMANDS\n",
        kVersion, roff("from a material's complex refractive index to its spectral BRDF"));
    for (const DescribedCommand& command : all) {
        if (command.path.empty()) continue;
        text += fmt::format(".SS miebrdf {}\n{}\n", roff(command.name()), roff(command.help));
        for (const DescribedOption& option : command.options) text += roff_option(option);
        if (!command.example.empty())
            text += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command.example));
    }
    return text +
           ".SH EXIT STATUS\n.TP\n0\ngood\n.TP\n1\na check failed\n.TP\n2\nthe request is wrong\n"
           ".TP\n3\ndata is missing, damaged, or does not cover the request\n.TP\n4\nvalues were "
           "written, but did not converge\n.TP\n130, 143\ninterrupted; nothing unfinished was "
           "written\n"
           ".SH ENVIRONMENT\n.TP\n.B MIEBRDF_DATABASE\nfile of your own materials\n"
           ".TP\n.B MIEBRDF_PROCESSOR_PATH\ninstructions of the processor that are used, of those "
           "that --version names\n"
           ".TP\n.B XDG_CACHE_HOME\nwhere results of earlier runs are kept, in miebrdf/\n"
           ".TP\n.B XDG_DATA_HOME\nwhere your own materials are kept, in miebrdf/\n"
           ".TP\n.B NO_COLOR\nno colours\n";
}

}  // namespace

void add_completion(CLI::App& command, Shell& shell) {
    static const std::vector<std::pair<std::string, std::string (*)()>> shells = {
        {"bash", bash_completion}, {"zsh", zsh_completion}, {"fish", fish_completion}};
    auto name = std::make_shared<std::string>();
    option(command, "SHELL", *name, "", "bash, zsh or fish")->required();
    shell.add_common_options(command, Writes::file);
    command.footer("Example:\n  source <(miebrdf completion bash)");
    shell.on_prepare(command, [name, &shell]() -> Job {
        for (const auto& [known, script] : shells) {
            if (*name == known) {
                return [write = script, &shell]() -> int { return shell.write_text(write()); };
            }
        }
        throw UsageError(fmt::format("unknown shell '{}'; allowed: bash, zsh, fish", *name));
    });
}

void add_manual(CLI::App& command, Shell& shell) {
    shell.add_common_options(command, Writes::file);
    command.footer("Example:\n  miebrdf manual | man -l -");
    shell.on_run(command, [&shell]() -> int { return shell.write_text(manual()); });
}

}  // namespace miebrdf::program
