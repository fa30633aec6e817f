// miebrdf stress: the battery of stiff and extreme cases.
#include <fmt/format.h>

#include <miebrdf/error.h>
#include "tools/bench/report.h"
#include "tools/miebrdf/command.h"
#include "tools/stress/battery.h"

namespace miebrdf::program {
namespace {

struct StressArguments {
    bool fast = false;
    std::string docs;
};

Table table_of(const std::vector<stress::Check>& checks) {
    Table table;
    table.facts.emplace_back("meaning", "a row is ok when value <= bound; not-a-number is not ok");
    table.columns = {"suite", "case", "quantity", "value", "bound", "ok", "cause"};
    for (const auto& c : checks) {
        table.rows.push_back({c.suite, c.test_case, c.quantity, c.value, c.bound,
                              std::string(c.ok() ? "true" : "false"), c.cause});
    }
    return table;
}

int run(const StressArguments& arguments, const Shell& shell) {
    std::vector<stress::Check> checks;
    for (const stress::Suite& suite : stress::kSuites) {
        shell.note(suite.name);
        stress::Log log(suite.name, checks);
        suite.run(log, arguments.fast);
    }
    shell.write(table_of(checks));
    int failed = 0;
    for (const auto& c : checks) {
        if (c.ok()) continue;
        ++failed;
        shell.note(fmt::format("not ok: {} / {}: {} is {:.3g}, bound {:.3g}", c.suite, c.test_case,
                               c.quantity, c.value, c.bound));
    }
    shell.note(fmt::format("{} checks, {} not ok", checks.size(), failed));
    if (!arguments.docs.empty()) {
        bench::update_document(arguments.docs + "/stability.md", "stress",
                               fmt::format("{} checks, {} not ok.\n\n{}", checks.size(), failed,
                                           stress::tally(checks)));
    }
    return failed == 0 ? kGood : kCheckFailed;
}

}  // namespace

void add_stress(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<StressArguments>();
    command.add_flag("--fast", arguments->fast, "leave out what takes longest");
    option(command, "--docs", arguments->docs, "FOLDER",
           "rewrite the generated part of stability.md in this folder");
    finish(command, shell, arguments, run,
           "Exit code 1 when a bound is broken.\nExample:\n  miebrdf stress -o stress.csv");
}

}  // namespace miebrdf::program
