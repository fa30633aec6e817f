#include "pipeline/fit/minima.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/fit/least_squares.h"
#include "pipeline/fit/polish.h"
#include "pipeline/fit/problem.h"
#include "pipeline/fit/start_advice.h"

namespace miebrdf::fitting {
namespace {

/// Numbers closer than this share of their range are the same minimum.
constexpr double kSameMinimum = 0.01;

/// Analytic media: from so many starts. Of twelve starts of BRDFs of two lobes below a rough
/// surface (sintered PTFE) 4, 2 and 4 reached the best minimum at 351, 532 and 633 nm, without the
/// steps of redrawn(). How often six with them miss it was not measured.
constexpr int kStartsOfAnalytic = 6;

/// Minima are as good as the best where the data cannot tell them apart at 95 %.
constexpr double kAsGood = 0.95;

double at(const Range& range, double share) { return range.low + share * (range.high - range.low); }

/// Fitted numbers of start `index`: the first is the given one, the others fill the bounds.
std::vector<double> start_of(const FitProblem& problem, const Model& model, int index) {
    std::vector<double> t;
    for (const Slot& slot : model.slots()) {
        const Unknown& unknown = problem.unknowns[slot.unknown];
        t.push_back(index == 0 ? fitted_of(unknown, unknown.start)
                               : spread_number(problem.unknowns, slot.unknown, index));
    }
    return t;
}

class Searcher {
  public:
    Searcher(const FitProblem& problem, Model& model, const Target& target, const Control& control)
        : problem_(problem), model_(model), target_(target), control_(control) {
        for (const Slot& slot : model.slots()) {
            const Range range = fitted_range(problem.unknowns[slot.unknown]);
            squares_.low.push_back(range.low);
            squares_.high.push_back(range.high);
        }
        squares_.residuals = target.values.size();
        squares_.loss = problem.loss;
        squares_.loss_width = problem.loss_width;
        squares_.most_iterations = problem.most_iterations;
        squares_.evaluate = [this](std::span<const double> t, std::span<double> residuals,
                                   std::span<double> jacobian) {
            return evaluate(t, residuals, jacobian);
        };
        squares_.is_enough = [this](int iteration) {
            if (control_.progress)
                control_.progress("fit", std::size_t(iteration),
                                  std::size_t(problem_.most_iterations));
            return cancelled_ || (control_.is_cancelled && control_.is_cancelled());
        };
    }

    /// Robust losses have minima of their own far away: they start where squares end.
    Minimum from(std::vector<double> t) {
        squares_.start = std::move(t);
        squares_.loss = FitLoss::squares;
        // The sum is about a sigma squared for each residual: polish() goes on from a step of
        // kMostShift.
        squares_.least_gain = model_.is_coarse()
                                  ? kMostShift * kMostShift / double(squares_.residuals)
                                  : LeastSquares().least_gain;
        Minimum plain = minimise(squares_);
        if (problem_.loss == FitLoss::squares || !plain.converged) return plain;
        squares_.start = plain.x;
        squares_.loss = problem_.loss;
        squares_.loss_width = problem_.loss_width * spread_of(plain.residuals);
        Minimum robust = minimise(squares_);
        robust.iterations += plain.iterations;
        return robust;
    }

    double loss_width() const { return squares_.loss_width; }

    bool cancelled() const {
        return cancelled_ || (control_.is_cancelled && control_.is_cancelled());
    }
    /// Of scenes that could not be computed since forget_refusals(): how many, the last one's
    /// numbers and why.
    int refusals() const { return refusals_; }
    const std::vector<double>& refused() const { return refused_; }
    const std::string& refusal() const { return refusal_; }
    void forget_refusals() { refusals_ = 0; }

    /// What the sum of squares would be after one step of the linear model within the bounds:
    /// which of many points is worth a search. Infinite where no scene is.
    double promise_of(std::span<const double> t) {
        std::vector<double> residuals(squares_.residuals), jacobian(residuals.size() * t.size());
        const int before = refusals_;
        const bool is_good = evaluate(t, residuals, jacobian);
        refusals_ = before;
        if (!is_good) return std::numeric_limits<double>::infinity();
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const auto rows = Eigen::Index(residuals.size()), columns = Eigen::Index(t.size());
        const Eigen::Map<const RowMajor> J(jacobian.data(), rows, columns);
        const Eigen::MatrixXd A = J.transpose() * J;
        Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(residuals.data(), rows);
        Eigen::VectorXd step = Eigen::VectorXd::Zero(columns), slope = J.transpose() * r;
        constexpr int kSweeps = 100;  // of coordinate descent: screening needs no digits
        for (int sweep = 0; sweep < kSweeps; ++sweep) {
            for (Eigen::Index j = 0; j < columns; ++j) {
                if (!(A(j, j) > 0.0)) continue;
                const double to = std::clamp(step[j] - slope[j] / A(j, j),
                                             squares_.low[std::size_t(j)] - t[std::size_t(j)],
                                             squares_.high[std::size_t(j)] - t[std::size_t(j)]);
                slope += (to - step[j]) * A.col(j);
                step[j] = to;
            }
        }
        r += J * step;
        return r.squaredNorm();
    }

  private:
    /// One sigma in units of the residuals: 1, or from the median where sigmas are not known.
    double spread_of(std::vector<double> residuals) const {
        if (has_sigmas(problem_)) return 1.0;
        for (double& r : residuals) r = std::abs(r);
        const auto middle = residuals.begin() + std::ptrdiff_t(residuals.size() / 2);
        std::nth_element(residuals.begin(), middle, residuals.end());
        constexpr double kOfNormal = 1.4826;  // sigma over the median of |residual|
        return *middle > 0.0 ? kOfNormal * *middle : 1.0;
    }

    bool evaluate(std::span<const double> t, std::span<double> residuals,
                  std::span<double> jacobian) {
        try {
            model_.evaluate(numbers_of(problem_, model_, t), residuals, jacobian);
        } catch (const Cancelled&) {
            cancelled_ = true;
            return false;
        } catch (const UsageError& error) {
            return refuse(t, error.what());
        }
        for (std::size_t i = 0; i < residuals.size(); ++i) residuals[i] -= target_.values[i];
        target_.to_sigmas(residuals);
        target_.to_sigmas(jacobian);
        const auto is_finite = [](double x) { return std::isfinite(x); };
        if (!std::all_of(residuals.begin(), residuals.end(), is_finite) ||
            !std::all_of(jacobian.begin(), jacobian.end(), is_finite))
            return refuse(t, "its values are no finite numbers");
        return true;
    }

    bool refuse(std::span<const double> t, const std::string& why) {
        ++refusals_;
        refusal_ = why;
        refused_ = numbers_of(problem_, model_, t);
        return false;
    }

    const FitProblem& problem_;
    Model& model_;
    const Target& target_;
    const Control& control_;
    LeastSquares squares_;
    bool cancelled_ = false;
    int refusals_ = 0;
    std::string refusal_;
    std::vector<double> refused_;
};

bool are_of_one_spectrum(const MeasuredValue& a, const MeasuredValue& b) {
    const auto is_same = [](double x, double y) { return x == y || std::isnan(x + y); };
    return a.quantity == b.quantity && a.geometry == b.geometry && a.sample == b.sample &&
           is_same(a.mu_in, b.mu_in) && is_same(a.mu_out, b.mu_out) &&
           is_same(a.azimuth_deg, b.azimuth_deg);
}

bool are_same(const FitProblem& problem, const Model& model, const std::vector<double>& a,
              const std::vector<double>& b) {
    for (std::size_t s = 0; s < a.size(); ++s) {
        const Unknown& unknown = problem.unknowns[model.slots()[s].unknown];
        const Range range = fitted_range(unknown);
        const double apart = std::abs(fitted_of(unknown, a[s]) - fitted_of(unknown, b[s]));
        if (!(apart <= kSameMinimum * (range.high - range.low))) return false;
    }
    return true;
}

/// "r = 1210, v = 0.2", of numbers that all wavelengths share and of the first wavelength.
std::string in_words(const FitProblem& problem, const Model& model,
                     const std::vector<double>& numbers) {
    std::vector<std::string> words;
    for (std::size_t s = 0; s < numbers.size(); ++s) {
        if (model.slots()[s].wavelength == 0)
            words.push_back(fmt::format(
                "{} = {:.5g}", problem.unknowns[model.slots()[s].unknown].name, numbers[s]));
    }
    return fmt::format("{}", fmt::join(words, ", "));
}

/// One sigma of the weighted residuals, squared, as their sum says where it is larger than what
/// the data say.
double noise_of(const FitProblem& problem, const Minimum& best) {
    const double freedom = std::max(double(best.residuals.size()) - double(best.x.size()), 1.0);
    const double noise = best.sum_of_squares / freedom;
    return has_sigmas(problem) ? std::max(noise, 1.0) : noise;
}

/// A number that the best point holds at a bound, or does not determine, has other places from
/// where the others may find a better minimum (the asymmetry of a lobe whose share is 0): the most
/// promising of them. Empty: there is none.
std::vector<double> redrawn(const FitProblem& problem, const Model& model, const Minimum& best,
                            Searcher& searcher) {
    constexpr int kPlaces = 8;
    constexpr double kUndetermined = 0.1;  // of a range that changes the residuals by less than 1
    const double sigma = std::sqrt(noise_of(problem, best));
    const std::size_t n = best.x.size();
    std::vector<double> most_promising;
    double least = best.sum_of_squares - 0.1 * sigma * sigma;
    for (std::size_t s = 0; s < n; ++s) {
        const Unknown& unknown = problem.unknowns[model.slots()[s].unknown];
        if (unknown.per_wavelength && !is_separable(problem)) continue;
        const Range range = fitted_range(unknown);
        double squares = 0.0;
        for (std::size_t i = s; i < best.jacobian.size(); i += n)
            squares += best.jacobian[i] * best.jacobian[i];
        const double width = range.high - range.low;
        const bool is_at_bound =
            std::min(best.x[s] - range.low, range.high - best.x[s]) <= 1e-6 * width;
        if (!is_at_bound && std::sqrt(squares) * kUndetermined * width >= sigma) continue;
        for (int place = 0; place < kPlaces && !searcher.cancelled(); ++place) {
            std::vector<double> t = best.x;
            t[s] = at(range, (place + 0.5) / kPlaces);
            const double promise = searcher.promise_of(t);
            if (!(promise < least)) continue;
            least = promise;
            most_promising = std::move(t);
        }
    }
    return most_promising;
}

/// What minima that are as good as the best disagree about.
void add_disagreements(const FitProblem& problem, const Model& model, const Minimum& best,
                       Search& found) {
    const double noise = noise_of(problem, best);
    if (found.minima.size() < 2 || !(noise > 0.0)) return;
    const double as_good = boost::math::quantile(
        boost::math::chi_squared(double(found.minima.front().values.size())), kAsGood);
    std::vector<const FitMinimum*> good;
    for (const FitMinimum& minimum : found.minima) {
        if (minimum.chi_squared - found.minima.front().chi_squared <= as_good * noise)
            good.push_back(&minimum);
    }
    if (good.size() < 2) return;
    std::vector<std::string> words;
    for (std::size_t s = 0; s < model.slots().size(); ++s) {
        const Unknown& unknown = problem.unknowns[model.slots()[s].unknown];
        const auto [low, high] = std::minmax_element(
            good.begin(), good.end(),
            [&](const auto* a, const auto* b) { return a->values[s] < b->values[s]; });
        const Range range = fitted_range(unknown);
        const double apart = std::abs(fitted_of(unknown, (*high)->values[s]) -
                                      fitted_of(unknown, (*low)->values[s]));
        if (apart > kSameMinimum * (range.high - range.low))
            words.push_back(fmt::format("{} ({:.4g} to {:.4g})", unknown.name, (*low)->values[s],
                                        (*high)->values[s]));
    }
    constexpr std::size_t kMostWords = 8;
    if (words.size() > kMostWords) words.resize(kMostWords);
    found.notes.push_back(
        fmt::format("{} minima are as good as the data can tell and disagree about {}; intervals "
                    "are of the first alone",
                    good.size(), fmt::join(words, ", ")));
}

}  // namespace

void Target::to_sigmas(std::span<double> rows) const {
    const std::size_t columns = rows.size() / values.size();
    for (std::size_t i = values.size(); i-- > 0;) {
        const double r = correlation[i], own = weights[i] / std::sqrt(1.0 - r * r),
                     of_last = r == 0.0 ? 0.0 : r * weights[i - 1] / std::sqrt(1.0 - r * r);
        for (std::size_t j = i * columns; j < (i + 1) * columns; ++j)
            rows[j] = own * rows[j] - (r == 0.0 ? 0.0 : of_last * rows[j - columns]);
    }
}

void Target::from_sigmas(std::span<double> rows) const {
    const std::size_t columns = rows.size() / values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double r = correlation[i];
        for (std::size_t j = i * columns; j < (i + 1) * columns; ++j) {
            const double last = r == 0.0 ? 0.0 : r * weights[i - 1] * rows[j - columns];
            rows[j] = (std::sqrt(1.0 - r * r) * rows[j] + last) / weights[i];
        }
    }
}

std::vector<double> Target::sigmas_off(const std::vector<double>& model) const {
    std::vector<double> off = model;
    for (std::size_t i = 0; i < off.size(); ++i) off[i] -= values[i];
    to_sigmas(off);
    return off;
}

Target target_of(const FitProblem& problem) {
    Target target;
    for (const FitData& data : problem.data) {
        const MeasuredValue* last = nullptr;
        for (const MeasuredValue& value : data.values) {
            target.values.push_back(value.value);
            target.weights.push_back(value.sigma > 0.0 ? 1.0 / value.sigma : 1.0);
            const bool is_next = last != nullptr && data.correlation_length_nm > 0.0 &&
                                 are_of_one_spectrum(*last, value) &&
                                 value.wavelength_nm > last->wavelength_nm;
            target.correlation.push_back(
                is_next ? std::exp((last->wavelength_nm - value.wavelength_nm) /
                                   data.correlation_length_nm)
                        : 0.0);
            last = &value;
        }
    }
    return target;
}

Search search(const FitProblem& problem, Model& model, const Target& target,
              const Control& control) {
    Search found;
    Searcher searcher(problem, model, target, control);
    Minimum best;
    best.x = start_of(problem, model, 0);
    if (control.progress) control.progress("fit", 0, std::size_t(problem.most_iterations));
    try {
        model.prepare(numbers_of(problem, model, best.x));
        model.search_coarsely(model.uses_lattice() && may_be_polished(problem));
        model.choose_streams(numbers_of(problem, model, best.x));
    } catch (const Cancelled&) {
        found.interrupted = true;
    } catch (const UsageError& error) {
        const auto can_be = [&](const std::vector<double>& of_unknowns) {
            std::vector<double> numbers, values(model.values());
            for (const Slot& slot : model.slots()) numbers.push_back(of_unknowns[slot.unknown]);
            try {
                model.evaluate(numbers, values, {});
                return true;
            } catch (const UsageError&) {
                return false;
            }
        };
        throw UsageError(error.what() + start_that_works(problem.unknowns, can_be));
    }
    const auto keep = [&](const Minimum& minimum) {
        found.iterations += minimum.iterations;
        const std::vector<double> numbers = numbers_of(problem, model, minimum.x);
        const auto known = std::find_if(
            found.minima.begin(), found.minima.end(),
            [&](const FitMinimum& m) { return are_same(problem, model, m.values, numbers); });
        if (known == found.minima.end()) {
            found.minima.push_back({minimum.sum_of_squares, 1, numbers});
        } else {
            ++known->starts;
        }
        if (minimum.sum_of_squares < best.sum_of_squares) best = minimum;
    };
    const int starts = problem.starts > 0    ? problem.starts
                       : model.is_analytic() ? kStartsOfAnalytic
                                             : 1;
    // As good as can be: one value for each number, and met.
    const auto is_exact = [&] {
        return problem.starts == 0 && target.values.size() <= best.x.size() &&
               best.sum_of_squares <= 1e-6;
    };
    int refusals = 0;
    std::string refused;
    const auto try_from = [&](std::vector<double> t) {
        searcher.forget_refusals();
        const Minimum minimum = searcher.from(std::move(t));
        // A start that no scene can have leads nowhere.
        if (!std::isfinite(minimum.sum_of_squares)) return;
        keep(minimum);
        refusals += searcher.refusals();
        if (searcher.refusals() > 0)
            refused = fmt::format("{}: {}", in_words(problem, model, searcher.refused()),
                                  searcher.refusal());
    };
    for (int start = 0; start < starts && !found.interrupted && !is_exact(); ++start) {
        try_from(start_of(problem, model, start));
        found.interrupted = searcher.cancelled();
    }
    for (std::size_t round = 0;
         starts > 1 && round < best.x.size() && best.converged && !searcher.cancelled(); ++round) {
        const std::vector<double> t = redrawn(problem, model, best, searcher);
        if (t.empty()) break;
        const double before = best.sum_of_squares;
        try_from(t);
        if (!(best.sum_of_squares < before)) break;
    }
    found.interrupted = found.interrupted || searcher.cancelled();
    const auto sort_minima = [&] {
        std::sort(found.minima.begin(), found.minima.end(),
                  [](const auto& a, const auto& b) { return a.chi_squared < b.chi_squared; });
    };
    sort_minima();
    const auto go_on = [&] {
        searcher.forget_refusals();
        const Minimum again = searcher.from(best.x);
        found.is_at_edge = searcher.refusals() > 0;
        found.iterations += again.iterations;
        found.interrupted = searcher.cancelled();
        if (!again.converged) return false;
        best = again;
        found.minima.front() = {best.sum_of_squares, found.minima.front().starts,
                                numbers_of(problem, model, best.x)};
        return true;
    };
    bool is_current = true;  // what is known at the best point is of the model as it is now
    try {
        // From a minimum that lies within what can be computed no step leads out of it.
        if (refusals > 0 && !found.interrupted && std::isfinite(best.sum_of_squares)) {
            go_on();
            best.converged = best.converged && !found.is_at_edge;
        }
        // Nodes that were enough at the start may be too few here.
        for (int round = 0; round < 2 && !model.is_coarse() && !found.interrupted && best.converged;
             ++round) {
            if (!model.choose_streams(numbers_of(problem, model, best.x))) break;
            is_current = go_on();
            if (!is_current) break;
        }
        if (model.is_coarse() && !found.interrupted && best.converged) {
            found.lattice_shift =
                polish(problem, model, target, best, [&] { return searcher.cancelled(); });
            found.minima.front() = {best.sum_of_squares, found.minima.front().starts,
                                    numbers_of(problem, model, best.x)};
            if (!found.lattice_shift) {
                model.search_coarsely(false);
                model.choose_streams(numbers_of(problem, model, best.x));
                is_current = go_on();
            }
        }
        while (is_current && !found.lattice_shift && model.uses_lattice() && !found.interrupted &&
               best.converged) {
            found.lattice_shift = lattice_shift(problem, model, target, best);
            if (*found.lattice_shift <= kMostShift) break;
            found.lattice_shift.reset();
            model.refine_lattice();
            is_current = go_on();
            if (!is_current) break;
        }
    } catch (const Cancelled&) {
        found.interrupted = true;
    } catch (const UsageError& error) {
        found.is_at_edge = true;
        refused = error.what();
    }
    if (found.minima.empty())
        found.minima.push_back({best.sum_of_squares, 0, numbers_of(problem, model, best.x)});
    sort_minima();
    found.converged = best.converged && !found.interrupted && !found.is_at_edge;
    keep_known(best, target, found);
    if (!is_current && !found.interrupted) {
        try {
            model.evaluate(found.minima.front().values, found.values, found.derivatives);
        } catch (const Cancelled&) {
            found.interrupted = true;
            found.converged = false;
        }
    }
    found.loss_width = searcher.loss_width();
    if (found.interrupted) {
        found.reason = best.residuals.empty() ? "interrupted before the first solution"
                                              : "interrupted: the best so far";
    } else if (found.is_at_edge) {
        found.reason = fmt::format(
            "the search ends at {}, at the edge of what can be computed: better values may lie "
            "beyond, so no interval is given. Give narrower bounds or other words. {}",
            in_words(problem, model, found.minima.front().values), refused);
    } else if (!found.converged) {
        found.reason = fmt::format(
            "no minimum within {} iterations; give more "
            "(iterations in [fit]), another start, or "
            "narrower bounds",
            problem.most_iterations);
    }
    if (refusals > 0 && !found.is_at_edge)
        found.notes.push_back(
            fmt::format("{} of the scenes that were tried cannot be computed, and are left out of "
                        "the search; the last: {}",
                        refusals, refused));
    if (found.converged) add_disagreements(problem, model, best, found);
    return found;
}

}  // namespace miebrdf::fitting
