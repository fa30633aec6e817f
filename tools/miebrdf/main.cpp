// The miebrdf program: subcommands, errors in one line, exit codes.
#include <fmt/format.h>

#include <exception>
#include <iostream>
#include <new>

#include "pipeline/error.h"
#include "pipeline/version.h"
#include "tools/miebrdf/command.h"

namespace {

using namespace miebrdf;

/// The command line as typed, quoted so that a shell would read it back.
std::string joined(int argc, char** argv) {
    std::string line = "miebrdf";
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool plain = !word.empty() && word.find_first_of(" \t\n\"'\\$&|;<>()*?[]{}#~`!") ==
                                                std::string::npos;
        if (plain) {
            line += " " + word;
            continue;
        }
        line += " '";
        for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += "'";
    }
    return line;
}

int complain(int code, const std::string& message) {
    std::string line = message;
    for (char& c : line) {
        if (c == '\n') c = ' ';
    }
    std::cerr << "miebrdf: error: " << line << '\n';
    return code;
}

int run(int argc, char** argv) {
    CLI::App program{"From a material's complex refractive index to its spectral BRDF.", "miebrdf"};
    program.set_version_flag("--version", fmt::format("miebrdf {}", kVersion));
    program.require_subcommand(1);
    program.footer("miebrdf COMMAND --help explains a command and shows an example.");
    program::Shell shell(joined(argc, argv));
    program::add_brdf_command(program, shell);
    program::add_albedo_command(program, shell);
    program::add_optics_command(program, shell);
    program::add_phase_command(program, shell);
    program::add_sphere_command(program, shell);
    program::add_table1_command(program, shell);
    program::add_materials_command(program, shell);
    try {
        program.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return program.exit(success);  // --help, --version
    } catch (const CLI::ParseError& error) {
        return complain(program::kUsage, std::string(error.what()) + " (see miebrdf --help)");
    }
    return shell.run();
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const UsageError& error) {
        return complain(program::kUsage, error.what());
    } catch (const InputError& error) {
        return complain(program::kBadInput, error.what());
    } catch (const std::invalid_argument& error) {
        return complain(program::kUsage, error.what());
    } catch (const std::bad_alloc&) {
        return complain(program::kBadInput, "not enough memory for this request");
    } catch (const std::exception& error) {
        return complain(program::kBadInput, error.what());
    }
}
