// From a wanted colour to a recipe: amounts of pigments, in grams (docs/recipes.md).
//
//     const auto found = miebrdf::match(miebrdf::read_match_file("pastel.toml"));
//     for (const auto& part : found.recipes.at(0).parts)
//         std::cout << part.name << ' ' << part.grams << '\n';
#pragma once

#include <miebrdf/fit.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// A wanted colour in one light.
struct MatchColour {
    std::string light = "d65";  ///< words of viewing()
    Lab lab = {};
};

/// What the film should look like, in one geometry over one ground.
struct MatchTarget {
    std::string name = {};
    MeasuredOptions options = {};       ///< quantity and directions; empty: plane albedo, 8 degrees
    std::vector<SceneText> scene = {};  ///< words that differ from the problem's
    std::vector<MatchColour> colours = {};  ///< at least one
};

struct MatchProblem {
    std::vector<SceneText> scene = {};      ///< as of FitProblem
    std::vector<Unknown> unknowns = {};     ///< amounts, thicknesses, any other number
    std::vector<MatchTarget> targets = {};  ///< the first colour's light counts most
    std::vector<std::pair<std::string, double>> cost_per_kg =
        {};                      ///< of unknowns, >= 0, any currency
    double batch_grams = 100.0;  ///< > 0
    /// Of all species whose amount is unknown, in (0, 1]; of all layers together, um.
    std::optional<double> most_volume = {}, most_thickness_um = {};
    /// A correction: what was measured of the batch that the starts of the unknowns have made, for
    /// the targets in their order. Other targets over the same ground share it.
    std::vector<FitData> measured = {};
};

/// Reads a match file (docs/recipes.md); names of files as of read_fit_file().
/// @throws UsageError, InputError  with file, line and column
MatchProblem read_match_file(const std::string& path);
/// The same from a text; `name` stands for the file in messages.
MatchProblem read_match_text(const std::string& text, const std::string& folder,
                             const std::string& name);

/// Adds a measured spectrum or Lab of the batch, for the next target.
/// @throws UsageError, InputError
void add_measured(MatchProblem& problem, const std::string& file, const std::string& column = {});

/// A component of a recipe, or an unknown that is none (a thickness).
struct RecipePart {
    std::string name = {};             ///< of the unknown; of other components their words
    std::optional<double> value = {};  ///< of the unknown, in the unit of its word
    std::optional<double> grams = {};  ///< in the batch; of a correction what to add
    std::optional<double> weight_share = {}, volume_share = {};  ///< of the paint, in [0, 1]
    std::optional<double> delta_e_per_tenth_gram = {};  ///< CIEDE2000 by 0.1 g more, first colour
    double cost = 0.0;                                  ///< of its grams
    bool at_bound = false;
};

/// The colour of a recipe for one wanted colour.
struct RecipeColour {
    std::string target = {}, light = {};
    Lab lab = {}, wanted = {};  ///< of a correction lab has the model's offset
    double delta_e_2000 = 0.0;  ///< between both
};

struct Recipe {
    std::vector<RecipePart> parts = {};
    std::vector<RecipeColour> colours = {};     ///< target by target
    double delta_e_2000 = 0.0;                  ///< largest under the first light
    std::optional<double> delta_e_second = {};  ///< largest under any other
    std::optional<double> contrast_ratio = {};  ///< over black and a white of 0.8, first light
    double cost = 0.0;                          ///< of the batch; of a correction of what is added
    std::string left_out = {};                  ///< the unknown that this recipe does without
    std::string file = {};                      ///< a match file whose starts are this recipe
};

struct MatchResult {
    std::vector<Recipe> recipes = {};  ///< best first, at least one
    bool reached = false;              ///< delta_e_2000 <= kMatched
    std::vector<std::string> notes = {};
    int solved_scenes = 0;  ///< how many
};

/// A colour is reached up to this CIEDE2000: side by side, smaller differences are hardly seen.
inline constexpr double kMatched = 1.0;

/// Finds the amounts with the least CIEDE2000 under the first light, among these the least under
/// the others, among these the least cost; then the best recipes that do without one component
/// each. Colours are of 400 to 700 nm in steps of 10 nm. A colour that is out of reach is an
/// outcome: read `reached` and `notes`.
/// @throws UsageError, InputError  as fit(); for amounts in several layers, components without a
///         density, and corrections of amounts that are not unknown
MatchResult match(const MatchProblem& problem, const Control& control = {});

}  // namespace miebrdf
#pragma GCC visibility pop
