// miebrdf match: from a wanted colour to a recipe.
#include <fmt/format.h>
#include <miebrdf/fit.h>

#include <iostream>

#include <miebrdf/error.h>
#include "pipeline/io/atomic_file.h"
#include "tools/miebrdf/command.h"

namespace miebrdf::program {
namespace {

struct MatchArguments {
    std::string file, made, column;
    std::vector<std::string> measured;
};

std::string text_of(const Lab& lab) {
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", lab.l, lab.a, lab.b);
}

/// A recipe as a laboratory reads it; the table has the same numbers in full.
void add_facts(Table& table, std::size_t rank, const Recipe& recipe, bool is_correction) {
    std::string parts;
    for (const RecipePart& part : recipe.parts) {
        if (!parts.empty()) parts += ", ";
        parts += part.grams ? fmt::format("{} {:.2f} g", part.name, *part.grams)
                            : fmt::format("{} {:.4g}", part.name, *part.value);
    }
    const std::string without =
        recipe.left_out.empty() ? "" : fmt::format(" (without {})", recipe.left_out);
    table.facts.emplace_back(
        fmt::format("recipe {}{}", rank, without),
        fmt::format(
            "{}{}; dE2000 {:.2f}{}{}{}", is_correction ? "add " : "", parts, recipe.delta_e_2000,
            recipe.delta_e_second
                ? fmt::format(", {:.2f} in the second light", *recipe.delta_e_second)
                : "",
            recipe.contrast_ratio ? fmt::format(", contrast ratio {:.3f}", *recipe.contrast_ratio)
                                  : "",
            recipe.cost > 0.0 ? fmt::format(", cost {:.4g}", recipe.cost) : ""));
    for (const RecipeColour& colour : recipe.colours)
        table.facts.emplace_back(
            fmt::format("colour {}", rank),
            fmt::format("{}, {}: Lab {}, wanted {}, dE2000 {:.2f}", colour.target, colour.light,
                        text_of(colour.lab), text_of(colour.wanted), colour.delta_e_2000));
}

Table table_of(const MatchProblem& problem, const MatchResult& result) {
    const bool is_correction = !problem.measured.empty();
    Table table;
    table.facts.emplace_back(
        "units",
        "value: as the number stands in the scene's words; shares of the paint; delta_e_per_0.1g: "
        "CIEDE2000 by 0.1 g more; contrast_ratio: Y over black by Y over a white of 0.8");
    table.facts.emplace_back("batch",
                             fmt::format("{:.5g} g{}", problem.batch_grams,
                                         is_correction ? "; grams are to be added to it" : ""));
    table.columns = {"rank",           "unknown",          "value",        "grams",
                     "weight_share",   "volume_share",     "delta_e_2000", "delta_e_second_light",
                     "contrast_ratio", "delta_e_per_0.1g", "cost"};
    std::size_t rank = 0;
    for (const Recipe& recipe : result.recipes) {
        add_facts(table, ++rank, recipe, is_correction);
        for (const RecipePart& part : recipe.parts)
            table.rows.push_back({double(rank), part.name, cell_of(part.value), cell_of(part.grams),
                                  cell_of(part.weight_share), cell_of(part.volume_share),
                                  recipe.delta_e_2000, cell_of(recipe.delta_e_second),
                                  cell_of(recipe.contrast_ratio),
                                  cell_of(part.delta_e_per_tenth_gram), part.cost});
    }
    for (const std::string& note : result.notes) table.facts.emplace_back("note", note);
    return table;
}

int run_match(const MatchProblem& problem, const Shell& shell) {
    const MatchResult result = match(problem, shell.control());
    Table table = table_of(problem, result);
    if (shell.common().output.ends_with(".toml")) {
        AtomicFile file(shell.common().output);
        file.stream() << result.recipes.front().file;
        file.commit();
        table.facts.insert(table.facts.begin(), {"command", shell.command_line()});
        shell.common().json ? write_json(table, std::cout) : write_csv(table, std::cout);
    } else {
        shell.write(std::move(table));
    }
    for (const std::string& note : result.notes) shell.note(note);
    return kGood;
}

}  // namespace

void add_match(CLI::App& command, Shell& shell) {
    auto arguments = std::make_shared<MatchArguments>();
    option(command, "match", arguments->file, "MATCH.toml",
           "match file (TOML): a [scene] with {name} in place of amounts, [unknowns], [[target]]");
    option(command, "--from", arguments->made, "RECIPE.toml",
           "correct a batch that was made by this recipe (written by -o RECIPE.toml)");
    option(command, "--measured", arguments->measured, "FILE",
           "measurement of that batch, one file for each target in the order of the recipe");
    option(command, "--column", arguments->column, "",
           "one column or sample of these files, if they have several");
    shell.add_common_options(command);
    command.footer(
        "-o RECIPE.toml writes the best recipe as a match file, and the table to standard output.\n"
        "Example:\n  miebrdf match docs/examples/match/pastel.toml -o recipe.toml\n"
        "  miebrdf match --from recipe.toml --measured batch.csv");
    shell.on_prepare(command, [arguments, &shell]() -> Job {
        if (!has_fit())
            throw UsageError(
                "this build cannot search recipes; install libceres-dev, then configure and build "
                "again");
        if (arguments->file.empty() == arguments->made.empty())
            throw UsageError("give a match file, or --from RECIPE.toml with --measured FILE");
        if (arguments->made.empty() != arguments->measured.empty())
            throw UsageError("a correction needs both --from RECIPE.toml and --measured FILE");
        MatchProblem problem =
            read_match_file(arguments->made.empty() ? arguments->file : arguments->made);
        for (const std::string& file : arguments->measured)
            add_measured(problem, file, arguments->column);
        return [problem, &shell] { return run_match(problem, shell); };
    });
}

}  // namespace miebrdf::program
