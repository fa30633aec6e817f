// From measurements to a scene: unknown numbers of a scene found by least
// squares, with what the data tell of them and what they cannot
// (docs/fitting.md).
//
//     const auto problem = miebrdf::read_fit_file("snow.toml");
//     const auto found = miebrdf::fit(problem);
//     for (const auto& v : found.values) std::cout << v.unknown << ' ' <<
//     v.value << '\n';
#pragma once

#include <miebrdf/colour.h>
#include <miebrdf/control.h>
#include <miebrdf/measured.h>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#pragma GCC visibility push(default)
namespace miebrdf {

/// A number of the scene that is looked for; `{name}` stands for it in the
/// scene's words.
struct Unknown {
    /// What is fitted in place of it, so that its errors are even: positive
    /// numbers over decades in the logarithm, albedos near 1 as log(1 - x).
    enum class Scale { linear, logarithm, log_of_one_minus };

    std::string name = {};
    double start = 0.0, low = 0.0, high = 0.0;  ///< low < high, start within
    Scale scale = Scale::linear;
    bool per_wavelength = false;  ///< one value at each wavelength of the data
};

/// Reads `START in LOW:HIGH`, perhaps followed by `log` or `log1m`, perhaps
/// after `per wavelength,`. @throws UsageError  with what is allowed
Unknown unknown(const std::string& name, const std::string& text);

/// A number of the scene that follows from unknowns and the wavelength: `{name}` stands for it.
struct DerivedNumber {
    std::string name = {};
    /// Of muParser, of names of unknowns and wavelength_nm: `a*(wavelength_nm/500)^-b`.
    std::string formula = {};
};

/// A word of a scene with its values as somebody would type them.
struct SceneText {
    std::string word = {};
    std::vector<std::string> values = {};

    bool operator==(const SceneText&) const = default;
};

/// The largest error of a wavelength axis that is looked for, nm.
inline constexpr double kLargestShiftNm = 20.0;

/// Values that were measured of one scene.
struct FitData {
    std::string name = {};
    /// Those of unknown geometry are of light from mu_in, or from all sides where
    /// it is not known.
    std::vector<MeasuredValue> values = {};
    std::vector<SceneText> scene = {};  ///< words that differ from the problem's; no values: none
    std::vector<std::string> doubts = {};  ///< of their file: FitResult::notes repeats them
    bool free_scale = false;               ///< the values are known up to one common factor
    /// Added to the wavelengths of the values, within +-kLargestShiftNm: of an axis that is off;
    /// where it is free it is found.
    double wavelength_shift_nm = 0.0;
    bool free_wavelength_shift = false;
    /// Full width at half maximum of the Gaussian band that a value is a mean over, 0 to 200 nm.
    double band_width_nm = 0.0;
    /// Errors of neighbours in a spectrum are correlated by exp(-distance / this); 0: independent.
    double correlation_length_nm = 0.0;
    /// That made the values, of plane albedos and transmittances: they are what it reads.
    std::optional<SphereMeasurement> spheres = {};
    double diffuse_fraction = 0.0;  ///< of hdrf, in [0, 1]
    Sky sky = {};                   ///< that this share comes from
    Viewing viewing = {};           ///< of Lab, of the plane albedo over 400 to 700 nm
};

/// How residuals beyond a few sigma count: as their square, linearly (Huber),
/// or hardly (Cauchy).
enum class FitLoss { squares, huber, cauchy };

/// What is to be fitted: a scene with unknowns, and measurements of it.
struct FitProblem {
    std::vector<SceneText> scene = {};  ///< words of a scene file; values may hold {name}
    std::vector<Unknown> unknowns = {};
    std::vector<DerivedNumber> derived = {};
    std::vector<FitData> data = {};
    /// The given start, then points that fill the bounds evenly, 1 to 1000; 0: six where no unknown
    /// changes spheres, else one.
    int starts = 0;
    FitLoss loss = FitLoss::squares;
    double loss_width = 2.0;   ///< sigmas from where a robust loss differs from squares, > 0
    int most_iterations = 50;  ///< from each start, 1 to 10000
};

/// Reads a fit file (docs/fitting.md); names of measured files, and of files in words of its scene
/// that are there, are relative to its folder.
/// @throws UsageError, InputError  with file, line and column
FitProblem read_fit_file(const std::string& path);
/// The same from a text; `name` stands for the file in messages.
FitProblem read_fit_text(const std::string& text, const std::string& folder,
                         const std::string& name);

/// What was found of an unknown.
struct FittedValue {
    std::string unknown = {};
    std::optional<double> wavelength_nm = {};  ///< of unknowns at each wavelength
    double value = 0.0;                        ///< in the unit of its word
    double standard_error =
        0.0;  ///< likewise; NaN: the data do not tell, or the value is at a bound
    double interval_low = 0.0,
           interval_high = 0.0;                 ///< 95 % (Student's t), within the bounds
    double start = 0.0, low = 0.0, high = 0.0;  ///< as of Unknown
    bool at_bound = false;
    std::string note = {};
};

/// A minimum that one or more starts led to.
struct FitMinimum {
    double chi_squared = 0.0;         ///< as of FitResult
    int starts = 0;                   ///< how many led there
    std::vector<double> values = {};  ///< as FitResult::values
};

/// A measured value beside that of the fitted scene.
struct FitResidual {
    std::size_t data = 0;  ///< index in FitProblem::data
    /// Its sigma, where it has none, is that of all values, estimated from the
    /// residuals.
    MeasuredValue measured = {};
    double model = 0.0;  ///< in the unit of the measured value
};

/// What was found, how certain it is, and what the measurements leave open.
struct FitResult {
    std::vector<FittedValue> values = {};  ///< unknowns in their order, wavelengths ascending
    /// Of the given sigmas; where there are none, the sum of squared residuals.
    double chi_squared = 0.0;
    int degrees_of_freedom = 0;  ///< number of values minus that of unknowns
    bool sigma_known = false;    ///< else standard errors come from the residuals themselves
    /// [i * n + j] of n = values.size(); NaN where one of them is at a bound.
    std::vector<double> correlation = {};
    std::vector<std::string> undetermined = {};  ///< directions that the data leave open, in words
    std::vector<std::string> notes = {};
    std::vector<FitMinimum> minima = {};  ///< best first
    std::vector<FitResidual> residuals = {};
    bool converged = false;
    bool interrupted = false;  ///< by Control::is_cancelled: values are the best so far
    std::string reason = {};   ///< why it is not converged
    int iterations = 0;
    int solved_scenes = 0;  ///< how many
    /// Where optics come from a lattice of sizes: how far averages of their own would move the
    /// numbers at most, in standard errors, >= 0. Empty: there is no lattice.
    std::optional<double> interpolation_shift = {};
    std::string scene_file = {};  ///< the fitted scene, a scene file for `miebrdf run`
};

/// Whether this build can fit: it needs Ceres (docs/dependencies.md).
bool has_fit();

/// Finds the unknowns by bounded least squares: Levenberg-Marquardt from each
/// start, standard errors from the curvature at the best minimum. Where no
/// unknown is shared between wavelengths, each wavelength is a problem of its
/// own. The discretisation of each scene is chosen at the start and checked at
/// the minimum, so that the sum of squares is smooth in between.
///
/// Not converging, being stopped, and ending at the edge of what can be computed (then there are no
/// intervals) are outcomes: read `converged`.
/// @throws UsageError  for a problem that cannot be solved as it stands (an
/// unknown that no word
///         uses, fewer values than unknowns, a start outside its bounds), with
///         what would help
/// @throws InputError  for measured values that cannot be (not a number, a
/// reflectance above 1)
FitResult fit(const FitProblem& problem, const Control& control = {});

// From a wanted colour to a recipe: amounts of pigments, in grams (docs/recipes.md).
//
//     auto problem = miebrdf::read_match_file("pastel.toml");
//     miebrdf::add_measured(problem, "batch.csv");  // to correct a batch that has been made
//     const auto found = miebrdf::match(problem);
//     for (const auto& part : found.recipes.at(0).parts)
//         std::cout << part.name << ' ' << part.grams << '\n';

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

/// What is looked for: a scene whose amounts are unknown, and the colours that it should have.
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
    std::optional<double> grams = {};  ///< g in the batch, >= 0; of a correction what to add
    std::optional<double> weight_share = {}, volume_share = {};  ///< of the paint, in [0, 1]
    std::optional<double> delta_e_per_tenth_gram = {};  ///< CIEDE2000 by 0.1 g more, first colour
    double cost = 0.0;  ///< of its grams, >= 0, in the currency of cost_per_kg
    bool at_bound = false;
};

/// The colour of a recipe for one wanted colour.
struct RecipeColour {
    std::string target = {}, light = {};
    Lab lab = {}, wanted = {};  ///< of a correction lab has the model's offset
    double delta_e_2000 = 0.0;  ///< between both, >= 0
};

/// Amounts, what they look like and what they cost.
struct Recipe {
    std::vector<RecipePart> parts = {};
    std::vector<RecipeColour> colours = {};     ///< target by target
    double delta_e_2000 = 0.0;                  ///< largest under the first light, >= 0
    std::optional<double> delta_e_second = {};  ///< largest under any other
    std::optional<double> contrast_ratio = {};  ///< over black and a white of 0.8, first light
    double cost = 0.0;  ///< of the batch, of a correction of what is added; >= 0, currency as above
    std::string left_out = {};  ///< the unknown that this recipe does without
    std::string file = {};      ///< a match file whose starts are this recipe
};

/// Recipes, and what is to be known of them.
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
