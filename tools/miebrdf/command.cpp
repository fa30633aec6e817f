#include "tools/miebrdf/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <ostream>

#include <miebrdf/error.h>
#include <miebrdf/version.h>
#include "materials/readers/text.h"
#include "pipeline/io/atomic_file.h"
#include "tools/miebrdf/processor_path.h"
#include "tools/miebrdf/terminal.h"

namespace miebrdf::program {
namespace {

/// Refuses a file in a folder that does not exist, before anything is computed for it.
void require_folder_of(const std::string& file) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    std::error_code unreadable;  // is no folder either
    if (folder.empty() || std::filesystem::is_directory(folder, unreadable)) return;
    throw InputError(
        fmt::format("cannot write '{}': there is no folder '{}'", file, folder.string()));
}

/// A note where a file's name promises another format (`brdf -o brdf.npz` writes CSV); else empty.
std::string misnamed(const std::string& file, bool is_json) {
    const std::string ending = std::filesystem::path(file).extension().string();
    constexpr std::array any_text = {"", ".txt", ".dat", ".out", ".log"};
    if (std::find(any_text.begin(), any_text.end(), ending) != any_text.end()) return "";
    if (ending == (is_json ? ".json" : ".csv")) return "";
    const char* const holds = is_json ? "JSON" : "CSV";
    if (ending == ".json") return fmt::format("'{}' holds {}; --json writes JSON", file, holds);
    if (ending == ".csv")
        return fmt::format("'{}' holds {}; without --json it is CSV", file, holds);
    return fmt::format(
        "'{}' holds {}, whatever its name says; other formats of a BRDF are "
        "written by 'miebrdf export'",
        file, holds);
}

}  // namespace

std::string version_text() {
    return fmt::format("miebrdf {}\n{}", kVersion, processor_path_line());
}

void Shell::add_common_options(CLI::App& command, Writes writes) {
    command
        .add_option_function<std::string>(
            "-o,--output",
            [this, writes](const std::string& file) {
                if (file.empty()) {
                    throw CLI::ValidationError(
                        "--output", "an empty name; give a FILE, or - for standard output");
                }
                if (writes != Writes::folder) require_folder_of(file);
                common_.output = file;
            },
            "write to FILE instead of standard output; FILE appears when it is complete")
        ->type_name("FILE");
    command.add_flag("--json", common_.json,
                     writes == Writes::table
                         ? "write JSON instead of CSV"
                         : "list the files that were written, as JSON, on standard output");
    if (writes == Writes::table) {
        command.add_flag(
            "--no-comments", common_.no_comments,
            "leave out the comment lines (#), for spreadsheets; the error estimate is among them");
    }
    option(command, "--threads", common_.threads, "N",
           "largest number of threads; 0: one for each processor")
        ->check(CLI::Range(0, 4096));
    command.add_flag("-q,--quiet", common_.quiet, "print nothing but errors to standard error");
    command.add_flag("--no-cache", common_.no_cache,
                     "neither use nor store results of earlier runs");
    option(command, "--progress", common_.progress, "",
           "how progress is shown on standard error: auto (a line on a terminal, else a line every "
           "ten seconds), none or json");
    command.set_version_flag("--version", version_text);
}

void Shell::on_prepare(CLI::App& command, std::function<Job()> prepare) {
    command.callback([this, prepare = std::move(prepare)] { prepare_ = prepare; });
}

void Shell::on_run(CLI::App& command, Job job) {
    command.callback([this, job = std::move(job)] { set_job(job); });
}

void Shell::set_job(Job job) {
    prepare_ = [job = std::move(job)] { return job; };
}

Job Shell::prepare() const {
    if (!prepare_) return [] { return int(kGood); };
    return [this, job = prepare_()] {
        if (progress_ != nullptr) progress_->begin();
        const int code = job();
        if (progress_ != nullptr) progress_->end();
        for (const std::string& line : notes_at_end_) note(line);
        return code;
    };
}

void Shell::add_origin(Table& table) const {
    table.facts.insert(table.facts.begin(), {{"version", fmt::format("miebrdf {}", kVersion)},
                                             {"command", command_line_}});
}

void Shell::tell_written(Table files) const {
    if (!common_.json) return;
    add_origin(files);
    write_json(files, std::cout);
    std::cout.flush();
}

int Shell::write(Table table, bool converged) const {
    if (common_.no_comments && common_.json)
        throw UsageError("--no-comments belongs to CSV; JSON keeps its facts apart");
    add_origin(table);
    if (common_.no_comments) {
        table.facts.clear();
        table.report_columns.clear();
        table.report.clear();
    }
    write_to_output(
        [&](std::ostream& out) { common_.json ? write_json(table, out) : write_csv(table, out); });
    const std::string other_name = misnamed(common_.output, common_.json);
    if (!other_name.empty()) note(other_name);
    return converged ? kGood : kNotConverged;
}

int Shell::write_text(const std::string& text) const {
    write_to_output([&](std::ostream& out) {
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
    });
    return kGood;
}

void Shell::write_to_output(const std::function<void(std::ostream&)>& write) const {
    if (common_.output.empty() || common_.output == "-") {
        errno = 0;
        write(std::cout);
        std::cout.flush();
        if (!std::cout)
            throw InputError(
                fmt::format("cannot write to standard output{}",
                            errno != 0 ? fmt::format(": {}", std::strerror(errno)) : ""));
        return;
    }
    AtomicFile file(common_.output);
    write(file.stream());
    file.commit();
}

Control Shell::control() const {
    Control control;
    control.threads = common_.threads;
    control.is_cancelled = [&interrupted = watch_for_interrupts()] { return interrupted.load(); };
    control.memo = memo_;
    if (!common_.no_cache) {
        if (cache_ == nullptr) cache_ = open_cache();
        control.cache = cache_;
    }
    const ProgressStyle style =
        common_.quiet ? ProgressStyle::none : parse_progress_style(common_.progress);
    if (style == ProgressStyle::none) return control;
    if (progress_ == nullptr) progress_ = std::make_shared<ProgressLine>(style);
    control.progress = [line = progress_](const std::string& stage, std::size_t done,
                                          std::size_t total) { line->update(stage, done, total); };
    control.job_begun = [line = progress_](const std::string& stage, std::size_t total) {
        line->job_begun(stage, total);
    };
    control.piece_done = [line = progress_] { line->piece_done(); };
    return control;
}

void Shell::note_at_end(const std::string& line) const {
    const auto known = std::find(notes_at_end_.begin(), notes_at_end_.end(), line);
    if (known == notes_at_end_.end()) notes_at_end_.push_back(line);
}

void Shell::note(const std::string& line) const {
    if (common_.quiet) return;
    std::cerr << "miebrdf: ";
    for (const std::string_view part : materials::split_lines(line))
        std::cerr << materials::printable(part) << '\n';
}

}  // namespace miebrdf::program
