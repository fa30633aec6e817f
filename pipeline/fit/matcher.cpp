#include "pipeline/fit/matcher.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <miebrdf/error.h>
#include "pipeline/fit/least_squares.h"
#include "pipeline/fit/match_problem.h"
#include "pipeline/fit/problem.h"
#include "pipeline/fit/start_advice.h"

namespace miebrdf::fitting {
namespace {

/// Weights of what comes second and third: where a second light disagrees by dE 5, the first loses
/// .1 at most; the whole cost counts as a dE of .005.
constexpr double kSecondLight = 0.02, kCost = 0.005;
/// A limit that is exceeded by a part in a thousand counts as a dE of 10.
constexpr double kLimit = 1e4;
/// The rest, or the host, of a paint.
constexpr double kMostAmounts = 0.999;
constexpr int kMostSteps = 12;

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

}  // namespace

Matcher::Matcher(const MatchProblem& problem, const Control& control)
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
    for (Wanted& colour : colours_) colour.meter = std::make_unique<Colorimeter>(nm, colour.eye);
    wavelengths_ = nm.size();
    for (const auto& component : batch_.components()) {
        const auto priced = std::find_if(
            problem.cost_per_kg.begin(), problem.cost_per_kg.end(), [&](const auto& cost) {
                return component.unknown && cost.first == problem.unknowns[*component.unknown].name;
            });
        cost_per_kg_.push_back(priced == problem.cost_per_kg.end() ? 0.0 : priced->second);
    }
    model_.prepare(start_);
    model_.choose_streams(start_);
}

Point Matcher::point_at(const std::vector<double>& numbers, const Point* from) {
    Point point{numbers, std::vector<double>(model_.values()), {}};
    std::vector<double> by_number;
    if (from == nullptr) by_number.resize(model_.values() * numbers.size());
    model_.evaluate(numbers, point.spectra, by_number);
    const std::size_t n = numbers.size();
    if (from == nullptr) {
        for (std::size_t i = 0; i < by_number.size(); ++i)
            by_number[i] *=
                absorbed_slope(point.spectra[i / n]) / slope(fit_.unknowns[i % n], numbers[i % n]);
        point.slopes = std::move(by_number);
    } else {
        point.slopes = secant(*from, point);
    }
    point.objective = objective(point, numbers);
    return point;
}

std::vector<Lab> Matcher::labs(const Point& point, const std::vector<double>& numbers) const {
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

void Matcher::set_offsets(const Point& made) {
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
            colours_[c].offset = {seen.l - model[of].l, seen.a - model[of].a, seen.b - model[of].b};
        }
    }
}

std::vector<double> Matcher::residuals(const Point& point,
                                       const std::vector<double>& numbers) const {
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

double Matcher::objective(const Point& point, const std::vector<double>& numbers) const {
    double sum = 0.0;
    for (const double r : residuals(point, numbers)) sum += r * r;
    return sum;
}

double Matcher::cost(const std::vector<double>& weights) const {
    double sum = 0.0;
    for (std::size_t c = 0; c < weights.size(); ++c)
        sum += weights[c] * problem_.batch_grams / 1e3 * cost_per_kg_[c];
    return sum;
}

Point Matcher::search(Point best, const Moves& moves) {
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
        trust = gain > 0.5 * (best.objective - expected) ? std::min(1.0, 2.0 * trust) : 0.4 * trust;
        if (gain > 0.0) {
            best = std::move(tried);
            at = next;
        } else {
            best.slopes = tried.slopes;
        }
    }
    return best;
}

Moves Matcher::all_unknowns(const std::vector<double>& from,
                            std::optional<std::size_t> fixed) const {
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

Moves Matcher::additions(const std::vector<double>& weights) {
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
    return {std::vector<double>(n, 0.0), std::vector<double>(n, whole), std::vector<double>(n, 0.0),
            [this, grams](const std::vector<double>& x) {
                return batch_.numbers_of(grams(x), start_);
            }};
}

double Matcher::addition(const std::vector<double>& from, const std::vector<double>& to) {
    double factor = 1.0;
    for (std::size_t c = 0; c < from.size(); ++c)
        if (to[c] > 0.0) factor = std::max(factor, from[c] / to[c]);
    return factor - 1.0;
}

std::vector<double> Matcher::predicted(const Point& point,
                                       const std::vector<double>& numbers) const {
    std::vector<double> spectra = point.spectra;
    const std::size_t n = numbers.size();
    for (std::size_t i = 0; i < spectra.size(); ++i) {
        double change = 0.0;
        for (std::size_t u = 0; u < n; ++u)
            change += point.slopes[i * n + u] * (numbers[u] - point.numbers[u]);
        if (change != 0.0) spectra[i] = reflectance_of(absorbed(spectra[i]), spectra[i], change);
    }
    return spectra;
}

std::vector<double> Matcher::starts_of(const MatchProblem& problem) {
    std::vector<double> numbers;
    for (const Unknown& unknown : problem.unknowns) numbers.push_back(unknown.start);
    return numbers;
}

std::size_t Matcher::first_colour(std::size_t target) const {
    std::size_t c = 0;
    for (std::size_t t = 0; t < target; ++t) c += problem_.targets[t].colours.size();
    return c;
}

double Matcher::largest_cost() const {
    if (cost_per_kg_.empty()) return 0.0;
    const double dearest = *std::max_element(cost_per_kg_.begin(), cost_per_kg_.end());
    return dearest * problem_.batch_grams / 1e3;
}

std::vector<double> Matcher::secant(const Point& from, const Point& to) const {
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

std::vector<double> Matcher::minimum(const Point& point, const Moves& moves,
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

}  // namespace miebrdf::fitting
