#include "tools/miebrdf/program.h"

#include <fmt/format.h>
#include <malloc.h>

#include <exception>
#include <iostream>
#include <new>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "tools/miebrdf/suggestions.h"
#include "tools/miebrdf/terminal.h"

namespace miebrdf::program {
namespace {

int complain(int code, const std::string& message) {
    std::string line = message;
    for (char& c : line) {
        if (c == '\n') c = ' ';
    }
    std::cerr << "miebrdf: error: " << line << '\n';
    return code;
}

int parse_and_run(std::span<const Command> commands, const std::vector<std::string>& arguments) {
    CLI::App program{"From a material's complex refractive index to its spectral BRDF.", "miebrdf"};
    program.set_version_flag("--version", fmt::format("miebrdf {}", kVersion));
    program.require_subcommand(1);
    program.footer("miebrdf COMMAND --help explains a command and shows an example.");
    Shell shell(command_line_of(arguments));
    add_commands(program, shell, commands);
    try {
        // CLI11 takes its arguments from the back.
        program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::Success& success) {
        return program.exit(success);  // --help, --version
    } catch (const CLI::ParseError& error) {
        return complain(kUsage, explain(program, error));
    }
    const int code = shell.prepare()();
    if (code == kNotConverged) {
        shell.note(
            "not converged: the estimated error is above the tolerance (`miebrdf brdf` says "
            "where); "
            "exit code 4");
    }
    return code;
}

}  // namespace

void add_commands(CLI::App& parent, Shell& shell, std::span<const Command> commands) {
    for (const Command& command : commands)
        command.add(*parent.add_subcommand(command.name, command.help), shell);
}

std::string command_line_of(const std::vector<std::string>& arguments) {
    constexpr char kSpecial[] = " \t\n\"'\\$&|;<>()*?[]{}#~`!";
    std::string line = "miebrdf";
    for (const std::string& word : arguments) {
        if (!word.empty() && word.find_first_of(kSpecial) == std::string::npos) {
            line += " " + word;
            continue;
        }
        line += " '";
        for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += "'";
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
        if (word.field.find('_') == std::string::npos) continue;  // an ordinary word
        for (std::size_t at = message.find(word.field); at != std::string::npos;
             at = message.find(word.field, at)) {
            message.replace(at, word.field.size(), option);
        }
    }
    if (error.field() == "wavelength_nm" && dynamic_cast<const InputError*>(&error) != nullptr)
        message += "; `miebrdf materials import` takes a table that goes further";
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
    keep_freed_memory();
    return run_program(commands, {argv + 1, argv + argc});
}

}  // namespace miebrdf::program
