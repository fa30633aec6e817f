#include <miebrdf/match.h>

#include <iostream>

void show_match() {
    using namespace miebrdf;
    if (!has_fit()) return;  // a build without Ceres
    // As in a file for read_match_file: a blue tint that hides.
    MatchProblem problem = read_match_text(
        "[scene]\nboundary = \"smooth\"\nstokes = 1\n"
        "base = \"paste:oil_cobalt_blue,mass={blue} + paste:oil_zinc_white in index:1.5\"\n"
        "[unknowns]\nblue = \"0.05 in 0:0.5\"\n"
        "[[target]]\nlab = [72, -7, -28]\nlight = \"d65,10\"\n",
        ".", "example");
    problem.batch_grams = 500;
    const MatchResult found = match(problem);
    const Recipe& recipe = found.recipes.at(0);
    for (const RecipePart& part : recipe.parts)
        std::cout << part.name << ' ' << part.grams.value_or(0.0) << " g\n";
    const RecipeColour& colour = recipe.colours.at(0);
    std::cout << colour.light << ": dE2000 " << colour.delta_e_2000
              << (found.reached ? ", reached\n" : ", out of reach\n");
}
