// miebrdf plan: what a command or a scene file would compute, what it leaves out and why.
#include <fmt/format.h>

#include <string>

#include <miebrdf/error.h>
#include "pipeline/plan/plan.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/reflection_options.h"
#include "tools/miebrdf/run_command.h"
#include "tools/miebrdf/scene_requests.h"

namespace miebrdf::program {
namespace {

/// An estimate within a factor of three is not written to sixteen digits.
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
    table.facts.emplace_back("estimate",
                             fmt::format("{}: {:.2g} s on one thread", result, plan.seconds()));
}

Table empty_table() {
    Table table;
    table.facts.emplace_back("units",
                             "seconds: estimate for one thread, of the work or of what "
                             "leaving it out saves");
    table.columns = {"result", "action", "name", "detail", "jobs", "seconds"};
    return table;
}

/// The cache as it is; nothing is stored.
ResultCache* cache_of(const Shell& shell) { return shell.control().cache; }

int plan_scene_file(const std::string& path, const Shell& shell) {
    Table table = empty_table();
    EarlierWork earlier;
    std::size_t number = 0;
    for (const std::vector<std::string>& line : scene_command_lines(path)) {
        const std::string result = fmt::format("{} {}", ++number, line.front());
        if (const auto layers = layer_request(line)) {
            add_plan(table, make_plan(layers->request, layers->quantity, cache_of(shell), &earlier),
                     result);
        } else {
            table.facts.emplace_back("not planned", result + ": plans are made of brdf and albedo");
        }
    }
    shell.write(std::move(table));
    return kGood;
}

template <typename Arguments>
void add_kind(CLI::App& plan, Shell& shell, const std::string& name) {
    auto* command = plan.add_subcommand(name, "the plan of miebrdf " + name + ", same options");
    auto arguments = std::make_shared<Arguments>();
    arguments->add_to(*command);
    const bool brdf = std::is_same_v<Arguments, BrdfArguments>;
    command->footer(fmt::format("Example:\n  miebrdf plan {} --base TiO2 --coat AlGaAs7@0.1{}",
                                name, brdf ? " --mu-in 1 --mu-out 0.1:1:0.1" : ""));
    shell.add_common_options(*command);
    shell.on_run(*command, [arguments, name, &shell] {
        Table table = empty_table();
        const Request request = arguments->parse();
        const auto quantity = std::is_same_v<Arguments, AlbedoArguments>
                                  ? albedo_quantity(request.scene)
                                  : LayerQuantity::reflection;
        add_plan(table, make_plan(request, quantity, cache_of(shell)), name);
        shell.write(std::move(table));
        return kGood;
    });
}

}  // namespace

void add_plan(CLI::App& command, Shell& shell) {
    auto path = std::make_shared<std::string>();
    command.require_subcommand(0, 1);
    command.add_option("scene", *path, "scene file (TOML)")->type_name("SCENE.toml");
    add_kind<BrdfArguments>(command, shell, "brdf");
    add_kind<AlbedoArguments>(command, shell, "albedo");
    shell.add_common_options(command);
    command.footer(
        "Example:\n  miebrdf plan docs/examples/paint.toml\n  miebrdf plan brdf --base TiO2 "
        "--mu-in 1 "
        "--mu-out 0.1:1:0.1");
    command.callback([&command, path, &shell] {
        if (!command.get_subcommands().empty()) return;
        shell.set_action([path, &shell] {
            if (path->empty()) {
                throw UsageError("plan what? give a scene file, or brdf or albedo with options");
            }
            return plan_scene_file(*path, shell);
        });
    });
}

}  // namespace miebrdf::program
