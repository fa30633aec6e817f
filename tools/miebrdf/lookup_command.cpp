// miebrdf lookup: values between the nodes of a sweep's table.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include <miebrdf/error.h>
#include "pipeline/scene/number_list.h"
#include "pipeline/sweep/netcdf/netcdf_table.h"
#include "tools/miebrdf/command.h"
#include "tools/miebrdf/direction_options.h"
#include "tools/miebrdf/program.h"

namespace miebrdf::program {
namespace {

struct LookupArguments {
    std::string file;
    std::string interpolation = "linear";
    std::vector<std::string> variables;
};

/// `--NAME VALUE` or `--NAME=VALUE`, in pairs.
std::vector<std::pair<std::string, std::string>> pairs_of(const std::vector<std::string>& words) {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string& word = words[i];
        if (word.rfind("--", 0) != 0)
            throw UsageError(fmt::format("'{}': write --NAME VALUE, NAME an axis", word));
        const std::size_t equals = word.find('=');
        std::string name = word.substr(2, equals == std::string::npos ? equals : equals - 2);
        std::replace(name.begin(), name.end(), '-', '_');
        if (equals != std::string::npos) {
            pairs.emplace_back(name, word.substr(equals + 1));
        } else if (++i < words.size()) {
            pairs.emplace_back(name, words[i]);
        } else {
            throw UsageError(fmt::format("{} needs a value", word));
        }
    }
    return pairs;
}

/// The axis of cosines that degrees are given for; null for other names.
const char* cosine_named(const std::string& name) {
    if (name == "theta_in" || name == "sun_zenith") return "mu_in";
    if (name == "theta_out" || name == "view_zenith") return "mu_out";
    return nullptr;
}

/// Options by the names that they were typed with.
std::map<std::string, std::string> asked_values(const std::vector<std::string>& words,
                                                const sweep::StoredTable& table) {
    std::map<std::string, std::string> asked;
    for (auto [name, value] : pairs_of(words)) {
        if (const char* cosine = cosine_named(name)) {
            name = cosine;
            value = fmt::format("{}", cosine_of_degrees(parse_number(value, "degrees")));
        }
        if (!asked.emplace(name, value).second)
            throw UsageError(fmt::format("--{}: given twice", name));
    }
    return sweep::named_values(table, asked);
}

/// A row for each value; axes that the variable has not stay empty.
void add_rows(Table& table, const sweep::LookedUp& found, const std::vector<std::string>& listed) {
    for (std::size_t row = 0; row < found.values.size(); ++row) {
        std::map<std::string, Cell> place;
        std::size_t rest = row;
        for (std::size_t a = found.listed.size(); a-- > 0;) {
            const sweep::StoredAxis& axis = found.listed[a];
            const std::size_t at = rest % axis.size();
            rest /= axis.size();
            place[axis.name] = axis.texts.empty() ? Cell(axis.numbers[at]) : Cell(axis.texts[at]);
        }
        std::vector<Cell> cells = {found.variable};
        for (const std::string& name : listed) cells.push_back(place[name]);
        cells.insert(cells.end(), {found.values[row], rounded(found.errors[row], 2), found.unit});
        table.rows.push_back(std::move(cells));
    }
}

int look_up(const LookupArguments& arguments, const std::vector<std::string>& words,
            const Shell& shell) {
    const auto stored = sweep::open_netcdf_table(arguments.file);
    const auto asked = asked_values(words, *stored);
    const sweep::Interpolation order = sweep::parse_interpolation(arguments.interpolation);
    std::vector<std::string> listed;
    for (const std::string& name : sweep::axes_of_table(*stored)) {
        if (!asked.contains(name)) listed.push_back(name);
    }
    Table table;
    table.columns = {"variable"};
    table.columns.insert(table.columns.end(), listed.begin(), listed.end());
    table.columns.insert(table.columns.end(), {"value", "interpolation_error", "unit"});
    table.facts.emplace_back("table", arguments.file);
    table.facts.emplace_back("interpolation", arguments.interpolation);
    for (const auto& [name, value] : asked) table.facts.emplace_back(name, value);
    table.facts.emplace_back(
        "interpolation_error",
        "absolute, from nodes that the interpolation leaves out; empty: none is left out. The "
        "error of the nodes themselves is the variable error_estimate");
    for (const std::string& variable : sweep::named_variables(*stored, arguments.variables))
        add_rows(table, sweep::look_up(*stored, variable, asked, order), listed);
    return shell.write(std::move(table));
}

}  // namespace

void add_lookup(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<LookupArguments>();
    command.allow_extras();  // the axes are known when the table is open
    option(command, "table", arguments->file, "TABLE.nc", "table that miebrdf sweep wrote")
        ->required();
    option(command, "--interpolation", arguments->interpolation, "",
           "linear or cubic, along every axis; over the logarithm of logarithmic axes");
    option(command, "--variables", arguments->variables, "LIST",
           "some of the table's variables, with commas between; default: all")
        ->delimiter(',')
        ->expected(1);
    shell.add_common_options(command);
    command.footer(
        "Any other option is an axis of the table, --NAME VALUE; the beginning of a name will do, "
        "and --theta-in gives mu_in in degrees. "
        "Axes that are not given are listed at all their nodes.\n\n"
        "Example:\n  miebrdf lookup snow.nc --radius 220 --soot 3e-8 --mu-in 0.5");
    shell.on_run(command, [arguments, &command, &shell] {
        return look_up(*arguments, command.remaining(), shell);
    });
}

}  // namespace miebrdf::program
