// The parts of `miebrdf materials`, one function per group of subcommands.
#pragma once

#include <filesystem>
#include <string>

#include <miebrdf/database.h>
#include "tools/miebrdf/command.h"

namespace miebrdf::program {

/// The user's own materials over the embedded ones.
/// @param file  empty: $MIEBRDF_DATABASE, else the default place
/// @throws InputError
materials::Database open_database(const std::string& file);

/// The database that a subcommand reads or writes.
class DatabaseArgument {
  public:
    void add_to(CLI::App& command);
    /// @throws InputError
    materials::Database open() const { return open_database(file_); }
    /// The file that changes go to: --database, $MIEBRDF_DATABASE or the default place.
    std::filesystem::path file() const;

  private:
    std::string file_;
};

/// Options for n and k between and beyond the rows.
class IndexArguments {
  public:
    void add_to(CLI::App& command);
    materials::IndexOptions options() const;
    const std::string& interpolation() const { return interpolation_; }

  private:
    std::string interpolation_ = "pchip";
    std::string extrapolate_ = "refuse";
    bool missing_k_zero_ = false;
};

void add_materials_query_commands(CLI::App& materials, Shell& shell);  ///< list, search, show
void add_materials_nk_commands(CLI::App& materials, Shell& shell);     ///< nk, plot
void add_materials_edit_commands(CLI::App& materials,
                                 Shell& shell);  ///< import, alias, default, remove
void add_materials_check_commands(CLI::App& materials, Shell& shell);  ///< export, diff, verify

}  // namespace miebrdf::program
