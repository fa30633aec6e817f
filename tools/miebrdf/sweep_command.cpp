// miebrdf sweep: tables over many scenes.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "pipeline/io/netcdf_file.h"
#include "pipeline/sweep/crew.h"
#include "pipeline/sweep/layout.h"
#include "pipeline/sweep/netcdf/netcdf_table.h"
#include "pipeline/sweep/run.h"
#include "pipeline/sweep/satellite.h"
#include "pipeline/sweep/slurm.h"
#include "pipeline/sweep/sweep_file.h"
#include "pipeline/sweep/sweep_plan.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

namespace fs = std::filesystem;

struct SweepArguments {
    std::string file;
    std::string part;
    std::string costs;
    std::optional<std::size_t> sbatch_parts;
    bool plan = false, merge = false, keep_parts = false;
    double sample_s = 2.0;
};

bool is_netcdf(const std::string& table) { return fs::path(table).extension() == ".nc"; }

/// Refuses what no table can be written to, before anything is computed for it.
void require_table(const sweep::Sweep& sweep, const std::string& table) {
    const std::string extension = fs::path(table).extension().string();
    if (table.empty() || table == "-")
        throw UsageError("sweep writes a file; give -o table.nc or -o table.csv");
    const bool is_mat = sweep::is_mat_file(sweep);
    if (is_mat && extension != ".mat")
        throw UsageError("layouts isofit and isofit-surface are MAT-files; give -o surface.mat");
    if (!is_mat && sweep.table_layout != sweep::TableLayout::cf && extension != ".nc")
        throw UsageError(fmt::format("layout {} is one of NetCDF; give -o table.nc",
                                     sweep.for_eradiate() ? "eradiate" : "crtm-snow"));
    if (!is_mat && extension != ".nc" && extension != ".csv") {
        throw UsageError(fmt::format(
            "'{}': unknown kind of table '{}'; allowed: .nc (NetCDF-4), .csv", table, extension));
    }
    if (extension == ".nc" && !has_netcdf())
        throw UsageError(
            "this build cannot write NetCDF; install libnetcdf-dev, then configure and "
            "build again, or write a .csv");
}

std::unique_ptr<sweep::TableWriter> writer_of(const sweep::Sweep& sweep,
                                              const sweep::Layout& layout,
                                              const std::string& table) {
    if (sweep::is_mat_file(sweep)) return sweep::make_isofit_writer(sweep, layout, table);
    if (sweep.table_layout == sweep::TableLayout::crtm_snow)
        return sweep::make_crtm_writer(sweep, layout, table);
    return is_netcdf(table) ? sweep::make_netcdf_writer(sweep, layout, table)
                            : sweep::make_csv_writer(sweep, layout, table);
}

/// Whether the table is there already, whole: it appears when all parts are in it.
bool is_complete(const sweep::Sweep& sweep, const std::string& table) {
    if (!fs::is_regular_file(table)) return false;
    return (sweep::is_mat_file(sweep) ? sweep::identity_of_mat(table)
            : is_netcdf(table)        ? sweep::identity_of_netcdf(table)
                                      : sweep::identity_of_csv(table)) == sweep::identity_of(sweep);
}

Table plan_table(const sweep::SweepPlan& plan) {
    Table table;
    table.columns = {"quantity", "value", "unit"};
    const auto add = [&](const char* name, double value, const char* unit) {
        table.rows.push_back({std::string(name), value, std::string(unit)});
    };
    add("scenes", double(plan.scenes), "");
    add("groups that share Mie theory", double(plan.groups), "");
    add("chunks", double(plan.chunks), "");
    add("values", plan.values, "");
    add("NetCDF file before compression", std::ceil(plan.netcdf_bytes / 1e3), "kB");
    add("CSV file, about", std::ceil(plan.csv_bytes / 1e3), "kB");
    add("memory, at most", std::ceil(plan.memory_bytes / 1e6), "MB");
    add("scenes looked at", double(plan.looked_at), "");
    add("scenes of these that cannot be computed", double(plan.refused), "");
    add("scenes of these that lack wavelengths", double(plan.incomplete), "");
    add("processor time of the sweep", rounded(plan.processor_seconds, 2), "s");
    add("processors", double(plan.processors), "");
    add("time on them", rounded(plan.processor_seconds / double(plan.processors), 2), "s");
    table.facts.emplace_back("estimate",
                             "by the rules and formulas of miebrdf plan, mostly within a factor of "
                             "3; on processors that nothing else uses");
    for (const std::string& refusal : plan.refusals)
        table.facts.emplace_back("cannot be computed", refusal);
    return table;
}

int tell_report(const sweep::TableReport& report, const std::string& table, const Shell& shell) {
    shell.note(fmt::format(
        "{}: {} scenes, {} failed, {} incomplete, {} not converged, error estimate {:.2g}", table,
        report.scenes, report.failed, report.incomplete, report.not_converged,
        report.error_estimate));
    if (!report.first_remark.empty())
        shell.note(fmt::format("the first of these: {}", report.first_remark));
    Table files;
    files.columns = {"file", "scenes", "failed", "incomplete", "not_converged", "error_estimate"};
    files.rows.push_back({table, double(report.scenes), double(report.failed),
                          double(report.incomplete), double(report.not_converged),
                          report.error_estimate});
    shell.tell_written(std::move(files));
    const std::size_t lack_values = report.failed + report.incomplete;
    if (lack_values > 0) {
        const std::string what =
            report.incomplete == 0 ? "have no values"
            : report.failed == 0
                ? "lack some wavelengths"
                : fmt::format("have no values or ({}) lack some wavelengths", report.incomplete);
        shell.set_advice(fmt::format(
            "{} of {} scenes could not be computed and {}; 'remark' in the table says why{}",
            lack_values, report.scenes, what,
            report.not_converged > 0
                ? fmt::format("; {} others are above the tolerance", report.not_converged)
                : ""));
    }
    return lack_values + report.not_converged == 0 ? kGood : kNotConverged;
}

/// Moves a finished table out of the folder of parts, where whatever a killed run leaves of one is
/// removed with them.
void move_table(const fs::path& from, const fs::path& table) {
    std::error_code error;
    fs::rename(from, fs::is_symlink(table) ? fs::weakly_canonical(table) : table, error);
    if (error)
        throw InputError(fmt::format("cannot write '{}': {}", table.string(), error.message()));
}

int merge(const sweep::Sweep& sweep, const sweep::Layout& layout, const sweep::Parts& parts,
          const SweepArguments& arguments, const Shell& shell) {
    const std::string& table = shell.common().output;
    const fs::path unfinished = parts.unfinished_table(table);
    sweep::TableReport report;
    try {
        const auto writer = writer_of(sweep, layout, unfinished.string());
        report = sweep::write_table(parts, *writer, shell.control());
        move_table(unfinished, table);
    } catch (const InputError& error) {
        throw InputError(
            fmt::format("{}; parts are kept in '{}'", error.what(), parts.folder().string()));
    }
    if (!arguments.keep_parts) parts.remove();
    return tell_report(report, table, shell);
}

/// Writes which scenes are expensive: a row for each chunk that was computed.
void write_costs(const sweep::RunReport& report, const std::string& file, const Shell& shell) {
    if (file.empty()) return;
    Table table;
    table.facts = {{"command", shell.command_line()}};
    table.columns = {"chunk", "first_scene", "scenes", "processor_seconds"};
    for (const auto& [chunk, seconds] : report.costs)
        table.rows.push_back(
            {double(chunk.number), double(chunk.first), double(chunk.count), seconds});
    AtomicFile out(file);
    write_csv(table, out.stream());
    out.commit();
}

int tell_complete(const sweep::Sweep& sweep, const sweep::Layout& layout,
                  const SweepArguments& arguments, const Shell& shell) {
    const std::string& table = shell.common().output;
    const fs::path folder = sweep::Parts::folder_of(table);
    shell.note(fmt::format("'{}' is complete already; remove it to compute it again", table));
    if (!arguments.keep_parts && fs::is_directory(folder))
        sweep::Parts(sweep, layout, folder).remove();
    return kGood;
}

/// Runs as one of several processes of mpirun or srun; the first of them writes the table.
int run_in_crew(const sweep::Sweep& sweep, const sweep::Layout& layout, const sweep::Parts& parts,
                const sweep::Crew& crew, const SweepArguments& arguments, const Shell& shell) {
    const auto is_there = [&] { return is_complete(sweep, shell.common().output); };
    const auto report = sweep::run_crew(sweep, layout, parts, crew, is_there, shell.control());
    shell.note(fmt::format(
        "process {} of {}: {} chunks taken, {} of them were there; {} scenes "
        "computed",
        crew.number + 1, crew.size, report.chunks, report.found, report.computed_scenes));
    write_costs(report,
                arguments.costs.empty() ? "" : fmt::format("{}.{}", arguments.costs, crew.number),
                shell);
    if (is_there()) return tell_complete(sweep, layout, arguments, shell);
    return crew.number == 0 ? merge(sweep, layout, parts, arguments, shell) : int(kGood);
}

int run_sweep(const sweep::Sweep& sweep, const SweepArguments& arguments, const Shell& shell) {
    const sweep::Layout layout = sweep::layout_of(sweep);
    const std::string& table = shell.common().output;
    if (arguments.plan) {
        const auto plan = sweep::plan_sweep(sweep, layout, arguments.sample_s, shell.control());
        Shell to_screen(shell.command_line());
        to_screen.write(plan_table(plan));
        return kGood;
    }
    const fs::path folder = sweep::Parts::folder_of(table);
    if (is_complete(sweep, table)) return tell_complete(sweep, layout, arguments, shell);
    const sweep::Parts parts(sweep, layout, folder);
    const auto crew =
        sweep::crew_of_environment([](const char* name) { return std::getenv(name); });
    if (crew && !arguments.merge && arguments.part.empty())
        return run_in_crew(sweep, layout, parts, *crew, arguments, shell);
    if (!arguments.merge) {
        const auto share =
            arguments.part.empty() ? sweep::Share{} : sweep::parse_share(arguments.part);
        const auto report = sweep::run_share(sweep, layout, parts, share, shell.control());
        shell.note(fmt::format("{} of {} chunks were there; {} scenes computed", report.found,
                               report.chunks, report.computed_scenes));
        write_costs(report, arguments.costs, shell);
        if (!arguments.part.empty()) return kGood;
    }
    return merge(sweep, layout, parts, arguments, shell);
}

/// Refuses options that exclude each other.
void require_one_task(const SweepArguments& a) {
    const int tasks =
        int(a.plan) + int(a.merge) + int(!a.part.empty()) + int(a.sbatch_parts.has_value());
    if (tasks > 1) throw UsageError("--plan, --part, --merge and --sbatch: give one of them");
    if (!a.part.empty()) sweep::parse_share(a.part);
}

void add_options(CLI::App& command, SweepArguments& arguments) {
    option(command, "sweep", arguments.file, "SWEEP.toml",
           "sweep file (TOML): scene, axes, outputs")
        ->required();
    command.add_flag(
        "--plan", arguments.plan,
        "print the number of scenes, the scenes that cannot be computed, time, memory and "
        "file size; compute nothing");
    option(command, "--sample-seconds", arguments.sample_s, "S",
           "for --plan: processor time in seconds that is spent on looking at scenes")
        ->check(CLI::Range(0.0, 1e6));
    option(command, "--part", arguments.part, "I/N",
           "compute share I of N (every N-th chunk) and write no table");
    command.add_flag("--merge", arguments.merge,
                     "write the table from its parts, all of which must be finished");
    option(command, "--sbatch", arguments.sbatch_parts, "N",
           "print a script for Slurm: a job array of N parts, and how to merge them")
        ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}));
    option(command, "--costs", arguments.costs, "FILE",
           "also write the processor time of every chunk that is computed, as CSV");
    command.add_flag("--keep-parts", arguments.keep_parts,
                     "do not remove the folder FILE.parts when the table is complete");
}

}  // namespace

void add_sweep(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<SweepArguments>();
    add_options(command, *arguments);
    shell.add_common_options(command, Writes::file);
    command.footer(
        "Finished chunks are kept in the folder FILE.parts: after an interruption, the same "
        "command goes on from there.\n\nExample:\n  miebrdf sweep docs/examples/sweeps/snow.toml "
        "-o snow.nc");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        require_one_task(*arguments);
        const sweep::Sweep sweep = sweep::read_sweep_file(arguments->file);
        if (!arguments->plan) require_table(sweep, shell.common().output);
        if (!arguments->sbatch_parts)
            return [=, &shell] { return run_sweep(sweep, *arguments, shell); };
        return [=, &shell]() -> int {
            Shell to_screen(shell.command_line());
            to_screen.write_text(sweep::slurm_script(arguments->file, shell.common().output,
                                                     *arguments->sbatch_parts));
            return kGood;
        };
    });
}

}  // namespace miebrdf::program
