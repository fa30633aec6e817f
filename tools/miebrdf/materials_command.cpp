// miebrdf materials: the database of optical constants.
#include "tools/miebrdf/materials_command.h"

#include <fmt/format.h>

#include <miebrdf/error.h>
#include <miebrdf/version.h>

namespace miebrdf::program {

void DatabaseArgument::add_to(CLI::App& command) {
    command
        .add_option("--database", file_,
                    "the user's materials; default: $MIEBRDF_DATABASE, else "
                    "$XDG_DATA_HOME/miebrdf/materials.sqlite")
        ->type_name("FILE");
}

std::filesystem::path DatabaseArgument::file() const {
    return file_.empty() ? materials::default_user_database() : std::filesystem::path(file_);
}

materials::Database open_database(const std::string& file) {
    if (file.empty()) return materials::Database::layered(materials::default_user_database());
    if (!std::filesystem::exists(file))
        throw InputError(fmt::format("materials database '{}' does not exist", file));
    return materials::Database::layered(file);
}

void add_materials(CLI::App& command, Shell& shell) {
    command.require_subcommand(1);
    command.set_version_flag("--version", fmt::format("miebrdf {}", kVersion));
    add_materials_query_commands(command, shell);
    add_materials_nk_commands(command, shell);
    add_materials_edit_commands(command, shell);
    add_materials_check_commands(command, shell);
    command.footer(
        "Example:\n  miebrdf materials search oxide --covers 400:700\n"
        "  miebrdf materials nk GaP --wavelengths 400:700:10");
}

}  // namespace miebrdf::program
