// Recipes: what is told of each, and what is missing where a colour is out of reach.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/fit.h>

#include <algorithm>
#include <cmath>

#include <miebrdf/error.h>
#include "pipeline/fit/match_problem.h"
#include "pipeline/fit/matcher.h"
#include "pipeline/scene/turbid_medium.h"

namespace miebrdf {
namespace {

using namespace fitting;

/// Y over black by Y over white, in the first light.
std::optional<double> contrast_ratio(const MatchProblem& problem, const Batch& batch,
                                     const std::vector<double>& numbers, const Control& control) {
    if (!batch.has_film()) return 1.0;
    MatchProblem films = problem;
    MatchTarget film = problem.targets.front();
    films.targets.clear();
    for (const char* const ground : {"black", "lambert:0.8"}) {
        MatchTarget& over = films.targets.emplace_back(film);
        std::erase_if(over.scene, [](const SceneText& word) {
            return word.word == "substrate" || word.word == "base";
        });
        over.scene.push_back({"base", {}});
        over.scene.push_back({"substrate", {ground}});
    }
    std::vector<std::size_t> unused;
    const FitProblem fit = spectra_of(films, unused);
    Model model(fit, control);
    std::vector<double> spectra(model.values());
    model.choose_streams(numbers);
    model.evaluate(numbers, spectra, {});
    std::vector<double> nm;
    for (const MeasuredValue& value : fit.data[0].values) nm.push_back(value.wavelength_nm);
    const Colorimeter meter(nm, viewing(problem.targets[0].colours[0].light));
    const auto half = spectra.begin() + std::ptrdiff_t(nm.size());
    const double dark = meter({spectra.begin(), half}).xyz.y,
                 light = meter({half, spectra.end()}).xyz.y;
    return light > 0.0 ? std::optional(dark / light) : std::nullopt;
}

/// @param before  weights of the batch that is corrected; empty: a recipe of its own
Recipe recipe_of(const MatchProblem& problem, const Matcher& matcher, const Point& point,
                 const std::vector<double>& before, const Control& control) {
    Recipe recipe;
    const Batch& batch = matcher.batch();
    const Batch::Shares shares = batch.shares(point.numbers);
    const std::vector<Lab> labs = matcher.labs(point, point.numbers);
    std::size_t c = 0;
    for (const MatchTarget& target : problem.targets) {
        for (const MatchColour& colour : target.colours) {
            const double difference = delta_e_2000(colour.lab, labs[c]);
            recipe.colours.push_back({target.name, colour.light, labs[c], colour.lab, difference});
            double& largest =
                matcher.is_first(c)
                    ? recipe.delta_e_2000
                    : recipe.delta_e_second.emplace(recipe.delta_e_second.value_or(0.0));
            largest = std::max(largest, difference);
            ++c;
        }
    }
    double scale = problem.batch_grams;  // of the batch that is made
    if (!before.empty()) scale *= 1.0 + Matcher::addition(before, shares.weight);
    const auto& components = batch.components();
    std::vector<double> grams;
    for (const double weight : shares.weight) grams.push_back(weight * scale);
    std::vector<bool> told(problem.unknowns.size(), false);
    for (std::size_t i = 0; i < components.size(); ++i) {
        RecipePart part{.name = components[i].name};
        const auto& u = components[i].unknown;
        if (u) {
            part.name = problem.unknowns[*u].name;
            part.value = point.numbers[*u];
            told[*u] = true;
        }
        part.grams = grams[i];
        if (!before.empty()) part.grams = std::max(0.0, grams[i] - before[i] * problem.batch_grams);
        part.weight_share = shares.weight[i];
        part.volume_share = shares.volume[i];
        part.cost = *part.grams * matcher.cost_per_gram(i);
        recipe.cost += part.cost;
        if (u || !components[i].kind) {
            std::vector<double> more = grams;
            more[i] += 0.1;
            const std::vector<double> numbers = batch.numbers_of(more, point.numbers);
            part.delta_e_per_tenth_gram = delta_e_2000(labs[0], matcher.labs(point, numbers)[0]);
        }
        recipe.parts.push_back(std::move(part));
    }
    for (std::size_t u = 0; u < told.size(); ++u)
        if (!told[u])
            recipe.parts.push_back({.name = problem.unknowns[u].name, .value = point.numbers[u]});
    for (RecipePart& part : recipe.parts)
        for (const Unknown& unknown : problem.unknowns)
            if (part.value && part.name == unknown.name) {
                const double near = 1e-3 * (unknown.high - unknown.low);
                part.at_bound = *part.value > unknown.high - near;
            }
    recipe.contrast_ratio = contrast_ratio(problem, batch, point.numbers, control);
    std::string title = fmt::format("{:.5g} g of paint:", scale);
    for (std::size_t i = 0; i < components.size(); ++i)
        title += fmt::format("{} {} {:.4g} g", i > 0 ? "," : "", recipe.parts[i].name, grams[i]);
    MatchProblem made = problem;
    made.batch_grams = scale;
    recipe.file = match_text(made, point.numbers, title);
    return recipe;
}

/// "lighter by 3, redder by 2"
std::string difference_in_words(const Lab& has, const Lab& wanted) {
    std::vector<std::string> words;
    const auto add = [&](double by, const char* more, const char* less) {
        if (std::abs(by) >= 0.5)
            words.push_back(fmt::format("{} by {:.1f}", by > 0 ? more : less, std::abs(by)));
    };
    add(wanted.l - has.l, "lighter", "darker");
    add(wanted.a - has.a, "redder", "greener");
    add(wanted.b - has.b, "yellower", "bluer");
    return fmt::format("{}", fmt::join(words, ", "));
}

/// The problem with one more pigment in its paint.
MatchProblem with_pigment(const MatchProblem& problem, int layer, const std::string& paste,
                          bool by_mass) {
    MatchProblem more = problem;
    const auto add = [&](std::vector<SceneText>& scene) {
        for (SceneText& word : scene) {
            if (word.word != (layer < 0 ? "base" : "coat")) continue;
            std::string& text = word.values[std::size_t(std::max(layer, 0))];
            text = fmt::format("paste:{},{}={{{}}} + {}", paste, by_mass ? "mass" : "volume", paste,
                               text);
        }
    };
    add(more.scene);
    for (MatchTarget& target : more.targets) add(target.scene);
    more.unknowns.push_back({.name = paste, .start = 0.02, .low = 0.0, .high = 0.5});
    return more;
}

/// The embedded pastes of the same set that would bring the colour nearest; each is tried.
std::string missing_pigment(const MatchProblem& problem, Matcher& matcher, const Point& best,
                            double least, const Control& control, int& solved) {
    const auto layer = matcher.batch().layer();
    if (!layer) return "";
    std::string text;
    for (const SceneText& word : problem.scene)
        for (const std::string& value : word.values) text += value + "\n";
    // Sets are named before the first underscore: acrylic_red_oxide.
    const std::size_t paste = text.find("paste:");
    const std::size_t end = paste == std::string::npos ? paste : text.find_first_of("_,/. ", paste);
    const std::string set =
        end == std::string::npos || text[end] != '_' ? "" : text.substr(paste + 6, end - paste - 5);
    bool by_mass = false;
    for (const auto& component : matcher.batch().components())
        by_mass = by_mass || (component.unknown && component.kind == Amount::Kind::mass_fraction);
    std::vector<std::pair<double, std::string>> promised;
    const auto gone = [](const Point& point) { return std::sqrt(point.objective); };
    for (const std::string& name : embedded_paste_names()) {
        if (set.empty() || !name.starts_with(set) ||
            text.find("paste:" + name) != std::string::npos)
            continue;
        try {
            const MatchProblem more = with_pigment(problem, *layer, name, by_mass);
            Matcher other(more, control);
            // Slopes of the known unknowns, and of the new one by a difference.
            std::vector<double> numbers = best.numbers;
            numbers.push_back(0.0);
            Point from{numbers, best.spectra, {}, best.objective};
            const std::size_t n = numbers.size();
            for (std::size_t i = 0; i < best.spectra.size(); ++i) {
                for (std::size_t u = 0; u + 1 < n; ++u)
                    from.slopes.push_back(best.slopes[i * (n - 1) + u]);
                from.slopes.push_back(0.0);
            }
            numbers.back() = 0.02;
            Point tried = other.point_at(numbers, &from);
            tried = other.search(tried, other.all_unknowns(numbers, {}));
            solved += other.solved();
            promised.emplace_back(gone(tried),
                                  fmt::format("{} ({:.2g} %", name, 100.0 * tried.numbers.back()));
        } catch (const UsageError&) {
        }
    }
    std::sort(promised.begin(), promised.end());
    if (promised.empty()) return "";
    if (!(promised[0].first < 0.8 * least))
        return fmt::format("no other paint of {}* helps much", set);
    std::string told = "missing: ";
    for (std::size_t i = 0; i < std::min<std::size_t>(2, promised.size()); ++i)
        if (promised[i].first < 0.8 * least)
            told += fmt::format("{}{}, dE {:.1f})", i > 0 ? ", or " : "", promised[i].second,
                                promised[i].first);
    return told + " would bring it nearer";
}

}  // namespace

MatchResult match(const MatchProblem& problem, const Control& control) {
    check_match(problem);
    Matcher matcher(problem, control);
    const auto tell = [&](std::size_t done) {
        if (control.progress) control.progress("recipes", done, problem.unknowns.size() + 1);
    };
    tell(0);
    MatchResult result{.notes = matcher.batch().notes()};
    Point best = matcher.point_at(matcher.start(), nullptr);
    std::vector<double> before;
    if (!problem.measured.empty()) {
        for (const auto& component : matcher.batch().components())
            if (component.kind && !component.unknown)
                throw UsageError(
                    fmt::format("the amount of {} is fixed, and what is added changes all shares; "
                                "make it an unknown",
                                component.name));
        if (matcher.batch().components().empty())
            throw UsageError("a correction adds grams; no amount of the scene is an unknown");
        before = matcher.batch().shares(matcher.start()).weight;
        matcher.set_offsets(best);
        const Moves moves = matcher.additions(before);
        best.objective = matcher.objective(best, best.numbers);
        best = matcher.search(std::move(best), moves);
    } else {
        best = matcher.search(std::move(best), matcher.all_unknowns(matcher.start(), {}));
        // Slopes of its own instead of secants, and a last step.
        best = matcher.point_at(best.numbers, nullptr);
        best = matcher.search(best, matcher.all_unknowns(best.numbers, {}));
    }
    result.recipes.push_back(recipe_of(problem, matcher, best, before, control));
    const Recipe first = result.recipes.front();
    result.reached = first.delta_e_2000 <= kMatched;
    if (before.empty()) {
        for (std::size_t u = 0; u < problem.unknowns.size(); ++u) {
            tell(u + 1);
            const Unknown& unknown = problem.unknowns[u];
            const bool is_part = std::any_of(
                matcher.batch().components().begin(), matcher.batch().components().end(),
                [&](const auto& component) { return component.unknown == u; });
            if (!is_part || unknown.low > 0.0 || problem.unknowns.size() < 2 ||
                !(best.numbers[u] > 1e-4 * unknown.high))
                continue;
            const Moves moves = matcher.all_unknowns(best.numbers, u);
            try {
                Point without = matcher.point_at(moves.numbers(moves.start), &best);
                without = matcher.search(std::move(without), moves);
                Recipe recipe = recipe_of(problem, matcher, without, {}, control);
                recipe.left_out = unknown.name;
                result.recipes.push_back(std::move(recipe));
            } catch (const UsageError&) {  // no such scene
            }
        }
        std::stable_sort(
            result.recipes.begin() + 1, result.recipes.end(),
            [](const Recipe& a, const Recipe& b) { return a.delta_e_2000 < b.delta_e_2000; });
    }
    std::vector<std::size_t> unused;
    for (const std::string& note : notes_of(spectra_of(problem, unused), best.numbers))
        result.notes.push_back(note);
    for (const RecipePart& part : first.parts)
        if (part.at_bound) result.notes.push_back(part.name + " is at its upper bound");
    result.solved_scenes = matcher.solved();
    if (result.reached) return result;
    const auto farthest = std::max_element(
        first.colours.begin(), first.colours.end(),
        [&](const auto& a, const auto& b) { return a.delta_e_2000 < b.delta_e_2000; });
    result.notes.push_back(fmt::format(
        "out of reach: the nearest colour is ({:.1f}, {:.1f}, {:.1f}), dE2000 {:.2f}; wanted is "
        "{}",
        farthest->lab.l, farthest->lab.a, farthest->lab.b, farthest->delta_e_2000,
        difference_in_words(farthest->lab, farthest->wanted)));
    if (before.empty())
        if (const std::string told = missing_pigment(problem, matcher, best, first.delta_e_2000,
                                                     control, result.solved_scenes);
            !told.empty())
            result.notes.push_back(told);
    return result;
}

}  // namespace miebrdf
