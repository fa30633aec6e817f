// What every subcommand shares: its common options, how it writes a table, and its exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>

#include "pipeline/cache/result_cache.h"
#include "pipeline/io/table.h"
#include "pipeline/solve/run_control.h"

namespace miebrdf::program {

/// Exit codes of the program; scripts depend on them (docs/command-line.md).
enum ExitCode { kGood = 0, kCheckFailed = 1, kUsage = 2, kBadInput = 3, kNotConverged = 4 };

/// Options that every command has.
struct CommonOptions {
    std::string output;  ///< -o FILE; empty or "-": standard output
    bool json = false;
    bool quiet = false;
    int threads = 0;
    std::string progress = "auto";
    bool no_cache = false;
};

/// What a command puts out: rows, as CSV or JSON; a file whose format its own options choose; a
/// folder, which it makes.
enum class Writes { table, file, folder };

/// What main() gives to commands and takes from them.
class Shell {
  public:
    /// @param command_line  as typed, for the header of every file written
    /// @param shared  what the results of a scene file have in common; may be null
    explicit Shell(std::string command_line, SharedWork* shared = nullptr)
        : command_line_(std::move(command_line)), shared_(shared) {}

    /// Adds -o, --json, --threads, --quiet and --version to a command.
    void add_common_options(CLI::App& command, Writes writes = Writes::table);

    /// Runs `action` when this command is the one typed; what it returns is the exit code.
    void on_run(CLI::App& command, std::function<int()> action);
    /// The same for a command that decides while it is parsed.
    void set_action(std::function<int()> action) { action_ = std::move(action); }

    /// Writes a table as CSV, or as JSON with --json, to -o FILE or standard output; version and
    /// command line are put before its own facts.
    /// @throws InputError  when it cannot be written; nothing is left half-written
    void write(Table table) const;

    /// Writes text that is no table (an export, a plot) to -o FILE or standard output.
    void write_text(const std::string& text) const;

    /// With --json: tells on standard output what a command has written that writes no table, one
    /// row for each file; version and command line are put before its own facts.
    void tell_written(Table files) const;

    /// One line on stderr, unless --quiet.
    void note(const std::string& line) const;

    /// Threads, progress on a terminal's stderr, Ctrl-C and the cache for a computation.
    RunControl control() const;

    const CommonOptions& common() const { return common_; }
    const std::string& command_line() const { return command_line_; }
    int run() const { return action_ ? action_() : kGood; }

  private:
    void add_origin(Table& table) const;

    std::string command_line_;
    SharedWork* shared_;
    CommonOptions common_;
    mutable std::unique_ptr<ResultCache> cache_;  ///< opened when first wanted
    std::function<int()> action_;
};

/// A command: what it is called, one line about it, and the function that adds its options and says
/// what it does.
struct Command {
    const char* name;
    const char* help;
    void (*add)(CLI::App& command, Shell& shell);
    bool in_scene_files = false;  ///< it computes something that a scene file may ask for
};

}  // namespace miebrdf::program
