#include <miebrdf/fit.h>

#include <iostream>

void show_fit() {
    using namespace miebrdf;
    if (!has_fit()) return;  // a build without Ceres
    // As in a file for read_fit_file: which albedo has a half-space that reflects a third?
    const FitProblem from_text = read_fit_text(
        "[scene]\nbase = \"hg:{w},0.5\"\n[unknowns]\nw = \"0.8 in 0.1:0.999 log1m\"\n"
        "[[measured]]\nvalues = [0.33]\nwavelength_nm = [550]\nquantity = \"spherical_albedo\"\n",
        ".", "example");
    // The same, filled in by hand.
    FitProblem problem;
    problem.scene = {SceneText{"base", {"hg:{w},0.5"}}};
    Unknown w = unknown("w", "0.8 in 0.1:0.999 log1m");
    problem.unknowns = {w};
    MeasuredValue reflectance;
    reflectance.geometry = MeasuredGeometry::hemispherical;
    reflectance.wavelength_nm = 550;
    reflectance.value = 0.33;
    reflectance.sigma = 0.01;
    FitData data;
    data.values = {reflectance};
    problem.data = {data};
    // A number by a formula: `{mus}` in words of a scene, which this one has not.
    problem.derived = {DerivedNumber{"mus", "10*w*(wavelength_nm/500)^-1.2"}};
    problem.loss = FitLoss::squares;

    const FitResult found = fit(problem);
    const FittedValue& value = found.values[0];
    std::cout << value.unknown << " = " << value.value << " +- " << value.standard_error << " ("
              << from_text.unknowns[0].name << " of the text alike)\n";
    const FitMinimum& best = found.minima[0];
    const FitResidual& residual = found.residuals[0];
    std::cout << best.starts << " start led there; " << residual.measured.value << " measured, "
              << residual.model << " computed\n";
}

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
    const MatchTarget& target = problem.targets.at(0);
    const MatchColour& wanted = target.colours.at(0);
    const MatchResult found = match(problem);
    const Recipe& recipe = found.recipes.at(0);
    for (const RecipePart& part : recipe.parts)
        std::cout << part.name << ' ' << part.grams.value_or(0.0) << " g\n";
    const RecipeColour& colour = recipe.colours.at(0);
    std::cout << wanted.light << ": dE2000 " << colour.delta_e_2000
              << (found.reached ? ", reached\n" : ", out of reach\n");
}
