// miebrdf plan: what a command or a scene file would compute, what it leaves out and why.
#include <fmt/format.h>

#include <string>

#include <miebrdf/error.h>
#include <miebrdf/plan.h>
#include "pipeline/solve/solved_table.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"
#include "tools/miebrdf/run_command.h"
#include "tools/miebrdf/scene_options.h"

namespace miebrdf::program {
namespace {

/// An estimate is not written to sixteen digits.
double estimate(double seconds) { return rounded(seconds, 2); }

/// Adds one plan to a table; `result` numbers the results of a scene file.
void add_plan(Table& table, const Plan& plan, const std::string& result) {
    for (const PlannedStep& step : plan.steps) {
        table.rows.push_back({result, std::string("compute"), step.stage, step.what,
                              static_cast<double>(step.jobs), estimate(step.seconds)});
    }
    for (const Omission& omission : plan.omissions) {
        table.rows.push_back({result, std::string("leave out"), omission.rule, omission.reason,
                              Cell(), estimate(omission.saved_s)});
    }
    table.facts.emplace_back(
        "estimate", fmt::format("{}: {:.2g} s on one thread, {:.0f} MB", result, plan.seconds(),
                                1e-6 * plan.memory_bytes));
}

Table empty_table() {
    Table table;
    table.facts.emplace_back("units",
                             "seconds: estimate for one thread, of the work or of what "
                             "leaving it out saves");
    table.columns = {"result", "action", "name", "detail", "jobs", "seconds"};
    return table;
}

void add_plans(Table& table, const BrdfQuestion& question, const Control& control,
               EarlierWork& earlier, const std::string& name) {
    add_plan(table,
             plan_evaluate(solved(question.request, control), question.directions, question.parts,
                           &earlier),
             name);
}

void add_plans(Table& table, const AlbedoQuestion& question, const Control& control,
               EarlierWork& earlier, const std::string& name) {
    if (question.over.empty()) {
        const Brdf brdf = solved(question.request, control);
        add_plan(table, plan_albedo(brdf, question.mu_in, &earlier), name);
        return;
    }
    Request request = question.request;
    for (const Substrate& ground : question.over) {
        request.scene.substrate = ground;
        add_plan(table, plan_albedo(solved(request, control), question.mu_in, &earlier),
                 name + " over " + describe(ground));
    }
}

/// A table of all directions, as `report` and `export` fill it.
struct TableArguments {
    SceneArguments scene;
    void add_to(CLI::App& command, Shell& shell) {
        scene.add_to(command, shell, SceneArguments::Base::required, "400:700:10");
    }
    Request parse() const { return scene.parse(); }
};

void add_plans(Table& table, const Request& request, const Control& control, EarlierWork& earlier,
               const std::string& name) {
    add_plan(table, plan_evaluate(solved(request, control), probe_directions(), {}, &earlier),
             name);
}

/// The plans of a result of a scene file.
template <typename Arguments>
void add_plans(Table& table, const SceneFileResult& result, const Control& control,
               EarlierWork& earlier, const std::string& name) {
    CLI::App command;
    Shell shell("", &result);
    Arguments arguments;
    arguments.add_to(command, shell);
    shell.add_common_options(command);
    read_keys(result, command);
    add_plans(table, arguments.parse(), control, earlier, name);
}

int plan_scene_file(const std::string& path, const Shell& shell) {
    Table table = empty_table();
    EarlierWork earlier;
    const Control control = shell.control();
    std::size_t number = 0;
    for (const SceneFileResult& result : read_scene_results(path)) {
        const std::string name = fmt::format("{} {}", ++number, result.command);
        if (result.command == "brdf") {
            add_plans<BrdfArguments>(table, result, control, earlier, name);
        } else if (result.command == "albedo") {
            add_plans<AlbedoArguments>(table, result, control, earlier, name);
        } else {
            table.facts.emplace_back("not planned", name + ": plans are made of brdf and albedo");
        }
    }
    return shell.write(std::move(table));
}

template <typename Arguments>
void add_kind(CLI::App& plan, Shell& shell, const std::string& name, const std::string& example) {
    auto* command = plan.add_subcommand(
        name, "what miebrdf " + name + " would compute; it takes the same options");
    auto arguments = std::make_shared<Arguments>();
    arguments->add_to(*command, shell);
    command->footer(fmt::format("Example:\n  miebrdf plan {} {}", name, example));
    shell.add_common_options(*command);
    shell.on_run(*command, [arguments, name, &shell] {
        Table table = empty_table();
        EarlierWork earlier;
        add_plans(table, arguments->parse(), shell.control(), earlier, name);
        return shell.write(std::move(table));
    });
}

}  // namespace

void add_plan(CLI::App& command, Shell& shell) {
    auto path = std::make_shared<std::string>();
    command.require_subcommand(0, 1);
    option(command, "scene", *path, "SCENE.toml", "scene file (TOML)");
    add_kind<BrdfArguments>(command, shell, "brdf",
                            "--base TiO2 --coat AlGaAs7@0.1 --mu-in 1 --mu-out 0.1:1:0.1");
    add_kind<AlbedoArguments>(command, shell, "albedo", "--base TiO2 --coat AlGaAs7@0.1");
    add_kind<TableArguments>(command, shell, "report", "--base TiO2 --coat AlGaAs7@0.1");
    shell.add_common_options(command);
    command.footer(
        "Example:\n  miebrdf plan docs/examples/paint.toml\n  miebrdf plan brdf --base TiO2 "
        "--mu-in 1 "
        "--mu-out 0.1:1:0.1");
    command.callback([&command, path, &shell] {
        if (!command.get_subcommands().empty()) return;
        shell.set_job([path, &shell]() -> int {
            if (path->empty()) {
                throw UsageError(
                    "plan what? give a scene file, or brdf, albedo or report with options");
            }
            return plan_scene_file(*path, shell);
        });
    });
}

}  // namespace miebrdf::program
