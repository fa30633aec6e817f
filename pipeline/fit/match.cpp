// Recipes: the search over amounts, what is told of each recipe, and what is missing where a colour
// is out of reach.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/fit.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <span>

#include <miebrdf/error.h>
#include "pipeline/fit/batch.h"
#include "pipeline/fit/least_squares.h"
#include "pipeline/fit/match_problem.h"
#include "pipeline/fit/model.h"
#include "pipeline/fit/problem.h"
#include "pipeline/fit/start_advice.h"
#include "pipeline/scene/turbid_medium.h"

namespace miebrdf {
namespace {

using namespace fitting;

/// Weights of what comes second and third: where a second light disagrees by dE 5, the first loses
/// .1 at most; the whole cost counts as a dE of .005.
constexpr double kSecondLight = 0.02, kCost = 0.005;
/// A limit that is exceeded by a part in a thousand counts as a dE of 10.
constexpr double kLimit = 1e4;
/// The rest, or the host, of a paint.
constexpr double kMostAmounts = 0.999;
constexpr int kMostSteps = 12;
constexpr double kNone = std::numeric_limits<double>::infinity();

/// A spectrum is nearly a linear function of amounts in Kubelka and Munk's (1 - R)^2 / (2 R).
double absorbed(double r) {
    const double at = std::clamp(r, 1e-4, 2.0);
    return (1.0 - at) * (1.0 - at) / (2.0 * at) + (at > 1.0 ? 2.0 * (1.0 - at) : 0.0);
}
double absorbed_slope(double r) {
    const double at = std::clamp(r, 1e-4, 1.0);
    return std::min(-1e-3, 0.5 * (1.0 - 1.0 / (at * at)));
}
/// The R of a linear course from `r`, which is as steep as the curve there.
double reflectance_of(double f, double r, double change) {
    if (r >= 0.98) return r + change / absorbed_slope(r);
    const double at = f + change, least = 1e-4;
    const double positive = at > least ? at : least * std::exp(at / least - 1.0);
    return 1.0 + positive - std::sqrt(positive * (positive + 2.0));
}

/// What is known of the spectra about one set of numbers.
struct Point {
    std::vector<double> numbers;
    std::vector<double> spectra;  ///< of all data, one after the other
    std::vector<double> slopes;   ///< of absorbed() by each unknown, row = value
    double objective = kNone;
};

/// Which numbers are searched, and how they make those of the unknowns.
struct Moves {
    std::vector<double> low, high, start;
    std::function<std::vector<double>(const std::vector<double>&)> numbers;
};

class Matcher {
  public:
    Matcher(const MatchProblem& problem, const Control& control)
        : problem_(problem),
          fit_(checked(spectra_of(problem, data_of_))),
          start_(starts_of(problem)),
          batch_(fit_, start_),
          model_(fit_, control) {
        for (const MatchTarget& target : problem.targets)
            for (const MatchColour& colour : target.colours)
                colours_.push_back({colour.lab, viewing(colour.light), {}});
        std::vector<double> nm;
        for (const MeasuredValue& value : fit_.data[0].values) nm.push_back(value.wavelength_nm);
        for (Wanted& colour : colours_)
            colour.meter = std::make_unique<Colorimeter>(nm, colour.eye);
        wavelengths_ = nm.size();
        for (const auto& component : batch_.components()) {
            const auto priced = std::find_if(
                problem.cost_per_kg.begin(), problem.cost_per_kg.end(), [&](const auto& cost) {
                    return component.unknown &&
                           cost.first == problem.unknowns[*component.unknown].name;
                });
            cost_per_kg_.push_back(priced == problem.cost_per_kg.end() ? 0.0 : priced->second);
        }
        model_.prepare(start_);
        model_.choose_streams(start_);
    }

    const Batch& batch() const { return batch_; }
    const FitProblem& fit() const { return fit_; }
    const std::vector<double>& start() const { return start_; }
    int solved() const { return model_.solved_scenes(); }

    /// Solved at these numbers; without derivatives where `from` has slopes to go on with.
    Point point_at(const std::vector<double>& numbers, const Point* from) {
        Point point{numbers, std::vector<double>(model_.values()), {}};
        std::vector<double> by_number;
        if (from == nullptr) by_number.resize(model_.values() * numbers.size());
        model_.evaluate(numbers, point.spectra, by_number);
        const std::size_t n = numbers.size();
        if (from == nullptr) {
            for (std::size_t i = 0; i < by_number.size(); ++i)
                by_number[i] *= absorbed_slope(point.spectra[i / n]) /
                                slope(fit_.unknowns[i % n], numbers[i % n]);
            point.slopes = std::move(by_number);
        } else {
            point.slopes = secant(*from, point);
        }
        point.objective = objective(point, numbers);
        return point;
    }

    std::vector<Lab> labs(const Point& point, const std::vector<double>& numbers) const {
        const std::vector<double> spectra = predicted(point, numbers);
        std::vector<Lab> all;
        std::size_t c = 0;
        for (std::size_t t = 0; t < problem_.targets.size(); ++t) {
            const auto first = spectra.begin() + std::ptrdiff_t(data_of_[t] * wavelengths_);
            const std::vector<double> one(first, first + std::ptrdiff_t(wavelengths_));
            for (std::size_t k = 0; k < problem_.targets[t].colours.size(); ++k, ++c) {
                Lab lab = (*colours_[c].meter)(one).lab;
                lab = {lab.l + colours_[c].offset.l, lab.a + colours_[c].offset.a,
                       lab.b + colours_[c].offset.b};
                all.push_back(lab);
            }
        }
        return all;
    }

    /// What the model misses of a measured batch is carried over to other batches, as Lab.
    void set_offsets(const Point& made) {
        const std::vector<Lab> model = labs(made, made.numbers);
        std::size_t c = 0;
        for (std::size_t t = 0; t < problem_.targets.size(); ++t) {
            std::size_t m = 0;
            while (m < problem_.measured.size() && data_of_[m] != data_of_[t]) ++m;
            if (t < problem_.measured.size()) m = t;
            for (std::size_t k = 0; k < problem_.targets[t].colours.size(); ++k, ++c) {
                if (m == problem_.measured.size()) continue;
                const bool is_lab =
                    problem_.measured[m].values.front().quantity >= MeasuredQuantity::lab_l;
                // A measured Lab is of the first light of its own target.
                const std::size_t of = is_lab ? first_colour(m) : c;
                const Lab seen = colour_of(problem_.measured[m], colours_[of].eye);
                colours_[c].offset = {seen.l - model[of].l, seen.a - model[of].a,
                                      seen.b - model[of].b};
            }
        }
    }

    /// Weighted differences; root sum of squares of the first is the first light's dE.
    std::vector<double> residuals(const Point& point, const std::vector<double>& numbers) const {
        std::vector<double> all;
        const std::vector<Lab> seen = labs(point, numbers);
        for (std::size_t c = 0; c < seen.size(); ++c)
            for (const double part : delta_e_2000_parts(colours_[c].lab, seen[c]))
                all.push_back(part * (is_first(c) ? 1.0 : kSecondLight));
        const Batch::Shares shares = batch_.shares(numbers);
        const auto limit = [&](double value, const std::optional<double>& most) {
            if (most) all.push_back(kLimit * std::max(0.0, value / *most - 1.0 + 1e-6));
        };
        limit(shares.coloured_volume, problem_.most_volume);
        limit(batch_.thickness_um(numbers), problem_.most_thickness_um);
        limit(shares.most_amount, kMostAmounts);
        if (added_) {
            const double mass = added_(numbers);
            all.push_back(kCost * mass / problem_.batch_grams);
        } else if (const double whole = largest_cost(); whole > 0.0) {
            all.push_back(kCost * cost(shares.weight) / whole);
        }
        return all;
    }

    double objective(const Point& point, const std::vector<double>& numbers) const {
        double sum = 0.0;
        for (const double r : residuals(point, numbers)) sum += r * r;
        return sum;
    }

    /// Of the batch.
    double cost(const std::vector<double>& weights) const {
        double sum = 0.0;
        for (std::size_t c = 0; c < weights.size(); ++c)
            sum += weights[c] * problem_.batch_grams / 1e3 * cost_per_kg_[c];
        return sum;
    }
    double cost_per_gram(std::size_t component) const { return cost_per_kg_[component] / 1e3; }

    bool is_first(std::size_t colour) const { return colours_[colour].eye == colours_[0].eye; }
    const Lab& wanted(std::size_t colour) const { return colours_[colour].lab; }

    /// From a solved point to the best that these moves reach.
    Point search(Point best, const Moves& moves) {
        double trust = 1.0;
        std::vector<double> at = moves.start;
        for (int step = 0; step < kMostSteps && trust > 1e-4; ++step) {
            const std::vector<double> next = minimum(best, moves, at, trust);
            const std::vector<double> numbers = moves.numbers(next);
            const double expected = objective(best, numbers);
            if (!(best.objective - expected > 1e-4 * best.objective + 1e-7)) break;
            Point tried;
            try {
                tried = point_at(numbers, &best);
            } catch (const UsageError&) {  // no such scene
                trust *= 0.25;
                continue;
            }
            const double gain = best.objective - tried.objective;
            trust =
                gain > 0.5 * (best.objective - expected) ? std::min(1.0, 2.0 * trust) : 0.4 * trust;
            if (gain > 0.0) {
                best = std::move(tried);
                at = next;
            } else {
                best.slopes = tried.slopes;
            }
        }
        return best;
    }

    /// The unknowns themselves, but for one that is fixed at 0. @param fixed  none: of all
    Moves all_unknowns(const std::vector<double>& from, std::optional<std::size_t> fixed) const {
        Moves moves;
        std::vector<std::size_t> free;
        for (std::size_t u = 0; u < from.size(); ++u) {
            if (fixed && *fixed == u) continue;
            free.push_back(u);
            moves.low.push_back(fit_.unknowns[u].low);
            moves.high.push_back(fit_.unknowns[u].high);
            moves.start.push_back(from[u]);
        }
        std::vector<double> base = from;
        if (fixed) base[*fixed] = 0.0;
        moves.numbers = [free, base](const std::vector<double>& x) {
            std::vector<double> numbers = base;
            for (std::size_t i = 0; i < free.size(); ++i) numbers[free[i]] = x[i];
            return numbers;
        };
        return moves;
    }

    /// Grams that are added to the batch of the starts.
    Moves additions(const std::vector<double>& weights) {
        const std::size_t n = weights.size();
        const double whole = problem_.batch_grams;
        const auto grams = [weights, whole](const std::vector<double>& x) {
            std::vector<double> all = weights;
            for (std::size_t c = 0; c < all.size(); ++c) all[c] = all[c] * whole + x[c];
            return all;
        };
        added_ = [this, weights, whole](const std::vector<double>& numbers) {
            return addition(weights, batch_.shares(numbers).weight) * whole;
        };
        return {std::vector<double>(n, 0.0), std::vector<double>(n, whole),
                std::vector<double>(n, 0.0), [this, grams](const std::vector<double>& x) {
                    return batch_.numbers_of(grams(x), start_);
                }};
    }

    /// What is added at least to a batch of weight 1 until it has other shares.
    static double addition(const std::vector<double>& from, const std::vector<double>& to) {
        double factor = 1.0;
        for (std::size_t c = 0; c < from.size(); ++c)
            if (to[c] > 0.0) factor = std::max(factor, from[c] / to[c]);
        return factor - 1.0;
    }

    /// The spectra about a point, by its slopes.
    std::vector<double> predicted(const Point& point, const std::vector<double>& numbers) const {
        std::vector<double> spectra = point.spectra;
        const std::size_t n = numbers.size();
        for (std::size_t i = 0; i < spectra.size(); ++i) {
            double change = 0.0;
            for (std::size_t u = 0; u < n; ++u)
                change += point.slopes[i * n + u] * (numbers[u] - point.numbers[u]);
            if (change != 0.0)
                spectra[i] = reflectance_of(absorbed(spectra[i]), spectra[i], change);
        }
        return spectra;
    }

  private:
    struct Wanted {
        Lab lab;
        Viewing eye;
        Lab offset;
        std::unique_ptr<Colorimeter> meter = {};
    };

    static std::vector<double> starts_of(const MatchProblem& problem) {
        std::vector<double> numbers;
        for (const Unknown& unknown : problem.unknowns) numbers.push_back(unknown.start);
        return numbers;
    }

    std::size_t first_colour(std::size_t target) const {
        std::size_t c = 0;
        for (std::size_t t = 0; t < target; ++t) c += problem_.targets[t].colours.size();
        return c;
    }

    double largest_cost() const {
        if (cost_per_kg_.empty()) return 0.0;
        const double dearest = *std::max_element(cost_per_kg_.begin(), cost_per_kg_.end());
        return dearest * problem_.batch_grams / 1e3;
    }

    /// Slopes that lead from one point to the other (Broyden 1965), steps in shares of the bounds.
    std::vector<double> secant(const Point& from, const Point& to) const {
        std::vector<double> slopes = from.slopes, step(to.numbers.size());
        const std::size_t n = step.size();
        double squares = 0.0;
        std::vector<double> weight(n);
        for (std::size_t u = 0; u < n; ++u) {
            const double width = fit_.unknowns[u].high - fit_.unknowns[u].low;
            step[u] = to.numbers[u] - from.numbers[u];
            weight[u] = step[u] / (width * width);
            squares += step[u] * weight[u];
        }
        if (!(squares > 0.0)) return slopes;
        for (std::size_t i = 0; i < to.spectra.size(); ++i) {
            double missed = absorbed(to.spectra[i]) - absorbed(from.spectra[i]);
            for (std::size_t u = 0; u < n; ++u) missed -= slopes[i * n + u] * step[u];
            for (std::size_t u = 0; u < n; ++u) slopes[i * n + u] += missed * weight[u] / squares;
        }
        return slopes;
    }

    /// Of the predicted colours, within a share of the bounds around `at`; from there and from
    /// points that fill them.
    std::vector<double> minimum(const Point& point, const Moves& moves,
                                const std::vector<double>& at, double trust) const {
        const std::size_t n = at.size();
        LeastSquares ls;
        ls.low.assign(n, 0.0);
        ls.high.assign(n, 1.0);
        std::vector<double> low(n), width(n);
        for (std::size_t i = 0; i < n; ++i) {
            const double range = trust * (moves.high[i] - moves.low[i]);
            low[i] = std::max(moves.low[i], at[i] - range);
            width[i] = std::min(moves.high[i], at[i] + range) - low[i];
        }
        const auto numbers_at = [&](std::span<const double> x) {
            std::vector<double> own(n);
            for (std::size_t i = 0; i < n; ++i)
                own[i] = std::clamp(low[i] + x[i] * width[i], moves.low[i], moves.high[i]);
            return own;
        };
        const auto residuals_at = [&](std::span<const double> x) {
            return residuals(point, moves.numbers(numbers_at(x)));
        };
        ls.evaluate = [&](std::span<const double> x, std::span<double> r, std::span<double> j) {
            const std::vector<double> middle = residuals_at(x);
            std::copy(middle.begin(), middle.end(), r.begin());
            std::vector<double> moved(x.begin(), x.end());
            constexpr double kStep = 1e-5;  // half the digits of a smooth formula
            for (std::size_t i = 0; i < n && !j.empty(); ++i) {
                const double step = x[i] < 0.5 ? kStep : -kStep;
                moved[i] = x[i] + step;
                const std::vector<double> beside = residuals_at(moved);
                moved[i] = x[i];
                for (std::size_t k = 0; k < middle.size(); ++k)
                    j[k * n + i] = (beside[k] - middle[k]) / step;
            }
            return true;
        };
        constexpr int kStarts = 5;
        std::vector<Unknown> unit(n, {.low = 0.0, .high = 1.0});
        Minimum best;
        for (int k = 0; k < kStarts; ++k) {
            ls.start.resize(n);
            for (std::size_t i = 0; i < n; ++i)
                ls.start[i] = k > 0 ? spread_number(unit, i, k)
                                    : std::clamp((at[i] - low[i]) / width[i], 0.0, 1.0);
            if (k == 0) ls.residuals = residuals_at(ls.start).size();
            const Minimum found = minimise(ls);
            // The course is known near the point alone: elsewhere it must promise more.
            if (found.sum_of_squares < best.sum_of_squares - (k > 0 ? 0.01 : 0.0)) best = found;
        }
        return numbers_at(best.x);
    }

    const MatchProblem& problem_;
    std::vector<std::size_t> data_of_;
    FitProblem fit_;
    std::vector<double> start_;
    Batch batch_;
    Model model_;
    std::vector<Wanted> colours_;
    std::size_t wavelengths_ = 0;
    std::vector<double> cost_per_kg_;                          ///< of components
    std::function<double(const std::vector<double>&)> added_;  ///< grams; a correction's
};

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
    const std::string set = text.find("paste:acrylic_") != std::string::npos ? "acrylic_"
                            : text.find("paste:oil_") != std::string::npos   ? "oil_"
                                                                             : "";
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
    if (promised.empty() || !(promised[0].first < 0.8 * least))
        return set.empty() ? "" : fmt::format("no other paint of {}* helps much", set);
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
