// Every subcommand shares this: common options, how a table is written, and exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <miebrdf/control.h>
#include "pipeline/io/table.h"
#include "pipeline/scene/scene_file.h"
#include "tools/miebrdf/terminal.h"

namespace miebrdf::program {

/// Exit codes of the program; scripts depend on them (docs/command-line.md).
enum ExitCode { kGood = 0, kCheckFailed = 1, kUsage = 2, kBadInput = 3, kNotConverged = 4 };

/// The text of --version: the version, then the processor path in use and those that are there.
std::string version_text();

/// Options that every command has.
struct CommonOptions {
    std::string output;  ///< -o FILE; empty or "-": standard output
    bool json = false;
    bool no_comments = false;  ///< of tables as CSV
    bool quiet = false;
    int threads = 0;
    std::string progress = "auto";
    bool no_cache = false;
};

/// The output of a command: rows, as CSV or JSON; a file in a format that its own options choose; a
/// folder, which it creates.
enum class Writes { table, file, folder };

/// The work that is left to do of a command; returns its exit code.
using Job = std::function<int()>;

/// main() gives this to commands, and takes their job from it.
class Shell {
  public:
    /// @param command_line  as typed, for the header of every file written
    /// @param result  of a scene file, which says the command's scene; null: options say it
    /// @param memo    single scattering that the results of a scene file share; may be null
    explicit Shell(std::string command_line, const SceneFileResult* result = nullptr,
                   std::shared_ptr<OpticsMemo> memo = nullptr)
        : command_line_(std::move(command_line)), result_(result), memo_(std::move(memo)) {}

    /// Adds -o, --json, --threads, --quiet and --version to a command.
    void add_common_options(CLI::App& command, Writes writes = Writes::table);

    /// Calls `prepare` when this command is the one typed: it reads and checks all that was asked
    /// for and returns what is left to do. A scene file prepares all its results first.
    void on_prepare(CLI::App& command, std::function<Job()> prepare);
    /// As above, for a command whose job does its own checks.
    void on_run(CLI::App& command, Job job);
    /// For a command that decides while it is parsed.
    void set_job(Job job);

    /// The job of the command that was parsed; it needs this object.
    /// @throws UsageError, InputError
    Job prepare() const;

    /// Writes a table as CSV, or as JSON with --json, to -o FILE or standard output; version and
    /// command line are put before its own facts.
    /// @return the exit code of the command
    /// @throws InputError  when it cannot be written; nothing is left half-written
    int write(Table table, bool converged = true) const;

    /// Writes text that is no table (an export, a plot) to -o FILE or standard output.
    int write_text(const std::string& text) const;

    /// With --json: prints a table of the files that a command has written, for commands that write
    /// no table themselves; version and command line are put before its own facts.
    void tell_written(Table files) const;

    /// One line on stderr, unless --quiet.
    void note(const std::string& line) const;
    /// Notes a line once, when the command has succeeded: bad input is answered with one line
    /// alone.
    void note_at_end(const std::string& line) const;

    /// The advice of the program where a command ends with kNotConverged.
    const std::string& advice() const { return advice_; }
    void set_advice(std::string advice) const { advice_ = std::move(advice); }

    /// Threads, progress on a terminal's stderr, Ctrl-C and the cache for a computation.
    Control control() const;

    const CommonOptions& common() const { return common_; }
    const std::string& command_line() const { return command_line_; }
    const SceneFileResult* scene_file_result() const { return result_; }

    /// The words of a scene that the command's options are made of (scene_options.h); scene files
    /// read them for it.
    const std::vector<std::string>& scene_words() const { return scene_words_; }
    void add_scene_word(const std::string& name) { scene_words_.push_back(name); }

  private:
    void add_origin(Table& table) const;
    /// Calls write(stream) with the file that -o names, which appears when it is complete, or with
    /// standard output.
    void write_to_output(const std::function<void(std::ostream&)>& write) const;

    std::string command_line_;
    const SceneFileResult* result_;
    std::shared_ptr<OpticsMemo> memo_;
    CommonOptions common_;
    mutable std::shared_ptr<ResultCache> cache_;  ///< opened when first wanted, like the next
    mutable std::shared_ptr<ProgressLine> progress_;
    mutable std::vector<std::string> notes_at_end_;
    mutable std::string advice_ =
        "not converged: the estimated error exceeds the tolerance; the output names where, in "
        "lines 'not converged'. Either accept the error with a larger --tolerance, or lower it "
        "with more --streams (at most 256; twice as many take up to eight times as long). If the "
        "error comes from polarisation that was left out, compute it with --stokes 3, or ignore it "
        "with --stokes 1";
    std::vector<std::string> scene_words_;
    std::function<Job()> prepare_;
};

/// Adds an option whose help shows the default, where there is one.
/// @param placeholder  of its value in the help; empty: the kind of number, or TEXT
template <typename Value>
CLI::Option* option(CLI::App& command, const std::string& names, Value& value,
                    const std::string& placeholder, const std::string& help) {
    CLI::Option* added = command.add_option(names, value, help);
    if (!placeholder.empty()) added->type_name(placeholder);
    if constexpr (std::is_arithmetic_v<Value>) {
        added->capture_default_str();
    } else if constexpr (requires { value.empty(); }) {
        if (!value.empty()) added->capture_default_str();
    }
    return added;
}

/// Ends the description of a command by the options that all have, a footer and what it does.
template <typename Arguments>
void finish(CLI::App& command, Shell& shell, const std::shared_ptr<Arguments>& arguments,
            int (*run)(const Arguments&, const Shell&), const std::string& footer,
            Writes writes = Writes::table) {
    shell.add_common_options(command, writes);
    command.footer(footer);
    shell.on_run(command, [arguments, run, &shell] { return run(*arguments, shell); });
}

/// A command: what it is called, one line about it, and the function that adds its options and says
/// what it does.
struct Command {
    const char* name;
    const char* help;
    void (*add)(CLI::App& command, Shell& shell);
    bool in_scene_files = false;  ///< it computes something that a scene file may ask for
};

}  // namespace miebrdf::program
