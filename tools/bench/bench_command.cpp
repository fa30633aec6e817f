// miebrdf bench: error against run time, as a table, a page and plots.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"
#include "tools/bench/peers.h"
#include "tools/bench/report.h"
#include "tools/bench/results.h"
#include "tools/bench/suites.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
    std::string suites;
    std::string compare_with;
    std::string read;
    std::string docs;
    int repeats = 5;
    double longest = 4.0;
    std::vector<std::string> peers;
    double patience = 60.0;
};

/// The names of all suites.
std::string suite_names(const char* separator) {
    std::vector<std::string> names;
    names.reserve(std::size(bench::kSuites));
    for (const bench::Suite& suite : bench::kSuites) names.emplace_back(suite.name);
    return fmt::format("{}", fmt::join(names, separator));
}

std::vector<bench::BenchCase> cases_of_suites(const std::string& list) {
    std::vector<bench::BenchCase> cases;
    for (const std::string& name : split_list(list)) {
        const auto* suite = std::find_if(std::begin(bench::kSuites), std::end(bench::kSuites),
                                         [&](const bench::Suite& s) { return s.name == name; });
        if (suite == std::end(bench::kSuites)) {
            throw UsageError(
                fmt::format("unknown suite '{}'; allowed: {}", name, suite_names(", ")));
        }
        for (auto& c : suite->cases()) cases.push_back(std::move(c));
    }
    return cases;
}

bench::Results measured(const BenchArguments& arguments, const Shell& shell) {
    if (!arguments.read.empty()) return bench::read_results(arguments.read);
    std::vector<bench::BenchCase> cases =
        cases_of_suites(arguments.suites.empty() ? suite_names(",") : arguments.suites);
    const auto note = [&](const std::string& line) { shell.note(line); };
    for (const std::string& words : arguments.peers)
        bench::add_peer(bench::parse_peer(words), arguments.patience, note, cases);
    bench::Results results{bench::machine_facts(), {}};
    for (const bench::BenchCase& c : cases) {
        shell.note(c.suite + ": " + c.name);
        results.facts.emplace_back("case " + c.suite + "/" + c.name,
                                   c.quantity + " Truth: " + c.truth);
        for (auto& m :
             bench::measure(c, {.repeats = arguments.repeats, .longest_total = arguments.longest}))
            results.measurements.push_back(std::move(m));
    }
    results.facts.emplace_back("command", shell.command_line());
    return results;
}

void write_folder(const fs::path& folder, const bench::Results& results,
                  const std::vector<bench::Change>& changes) {
    std::error_code error;
    fs::create_directories(folder, error);
    const auto write = [&](const std::string& name, const std::string& text) {
        bench::write_text(folder / name, text);
    };
    std::ostringstream table, comparison;
    bench::write_results(results, table);
    write("results.csv", table.str());
    write("index.html", bench::report_page(results, changes));
    for (const auto& [suite, name] : bench::cases_of(results)) {
        if (bench::is_about_rules(suite)) continue;  // a table, no curve
        write(bench::plot_file_name(suite, name), bench::case_plot(results, suite, name));
    }
    bench::write_comparison(changes, comparison);
    if (!changes.empty()) write("comparison.csv", comparison.str());
}

int run(const BenchArguments& arguments, const Shell& shell) {
    if (shell.common().output.empty())
        throw UsageError("bench writes several files: give a folder with -o DIR");
    if (arguments.repeats < 1)
        throw UsageError(fmt::format("{} repeats; at least 1", arguments.repeats));
    bench::Results before;
    if (!arguments.compare_with.empty()) before = bench::read_results(arguments.compare_with);
    const auto results = measured(arguments, shell);
    const std::vector<bench::Change> changes = bench::compare(before, results);
    write_folder(shell.common().output, results, changes);
    for (const auto& c : changes) {
        if (c.verdict != "same") {
            shell.note(fmt::format("{} / {}, {} {}: {}", c.after.suite, c.after.test_case,
                                   c.after.method, c.after.parameter, c.verdict));
        }
    }
    if (!arguments.docs.empty()) bench::update_bench_documents(arguments.docs, results);
    shell.tell_written({.facts = {{"points", double(results.measurements.size())}},
                        .columns = {"folder"},
                        .rows = {{shell.common().output}}});
    shell.note(fmt::format("{} points in {}", results.measurements.size(), shell.common().output));
    return kGood;
}

}  // namespace

void add_bench(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<BenchArguments>();
    option(command, "--suite", arguments->suites, "LIST", suite_names(", ") + "; default all");
    option(command, "--compare", arguments->compare_with, "OLD.csv",
           "compare with the results.csv of an earlier run");
    option(command, "--repeats", arguments->repeats, "", "how often every method is timed");
    option(command, "--longest", arguments->longest, "",
           "longest CPU time in seconds for repeating one measurement");
    option(command, "--peer", arguments->peers, "NAME=COMMAND",
           "another program, asked the same by COMMAND (docs/benchmarking.md); repeatable");
    option(command, "--patience", arguments->patience, "", "seconds in which a peer must answer");
    option(command, "--read", arguments->read, "FILE",
           "do not measure; draw plots and page from this results.csv");
    option(command, "--docs", arguments->docs, "FOLDER",
           "rewrite the generated parts of accuracy.md and performance.md in this folder");
    finish(command, shell, arguments, run,
           "Writes results.csv, index.html and one SVG for each case into the folder.\nExample:\n  "
           "miebrdf bench --suite half-space -o bench-results",
           Writes::folder);
}

}  // namespace miebrdf::program
