#include "pipeline/fit/minima.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

#include <miebrdf/error.h>
#include "pipeline/fit/least_squares.h"
#include "pipeline/fit/problem.h"

namespace miebrdf::fitting {
namespace {

/// Numbers closer than this share of their range are the same minimum.
constexpr double kSameMinimum = 0.01;

/// Averages from a lattice that move a number by more of its standard error than this are replaced
/// by those of a finer one, or by averages of their own, from their minimum on.
constexpr double kMostShift = 0.1;

double at(const Range& range, double share) { return range.low + share * (range.high - range.low); }

/// Fitted numbers of start `index`: the first is the given one, the others fill
/// the bounds evenly (the additive recurrence of the root of x^(d + 1) = x + 1,
/// Roberts 2018).
std::vector<double> start_of(const FitProblem& problem, const Model& model, int index) {
    double root = 1.5;
    for (int i = 0; i < 50; ++i)
        root = std::pow(1.0 + root, 1.0 / (double(problem.unknowns.size()) + 1.0));
    std::vector<double> t;
    for (const Slot& slot : model.slots()) {
        const Unknown& unknown = problem.unknowns[slot.unknown];
        const double step = std::pow(root, -double(slot.unknown + 1));
        const double share = 0.5 + index * step - std::floor(0.5 + index * step);
        t.push_back(index == 0 ? fitted_of(unknown, unknown.start)
                               : at(fitted_range(unknown), share));
    }
    return t;
}

std::vector<double> numbers_of(const FitProblem& problem, const Model& model,
                               std::span<const double> t) {
    std::vector<double> numbers;
    for (std::size_t s = 0; s < t.size(); ++s)
        numbers.push_back(number_of(problem.unknowns[model.slots()[s].unknown], t[s]));
    return numbers;
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
    const std::string& refusal() const { return refusal_; }

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
            refusal_ = error.what();
            return false;
        }
        const std::size_t columns = t.size();
        for (std::size_t i = 0; i < residuals.size(); ++i) {
            residuals[i] = (residuals[i] - target_.values[i]) * target_.weights[i];
            if (!std::isfinite(residuals[i])) return false;
            for (double& slope : jacobian.subspan(i * columns, columns)) {
                slope *= target_.weights[i];
                if (!std::isfinite(slope)) return false;
            }
        }
        return true;
    }

    const FitProblem& problem_;
    Model& model_;
    const Target& target_;
    const Control& control_;
    LeastSquares squares_;
    bool cancelled_ = false;
    std::string refusal_;
};

/// How far values that differ by `difference` move the numbers of a minimum, or any combination of
/// them, in its own standard errors: what of the difference lies in the directions of the Jacobian.
double shift_of(const std::vector<double>& difference, const std::vector<double>& derivatives,
                const Target& target, double sigma) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = Eigen::Index(difference.size());
    const auto weights = Eigen::Map<const Eigen::VectorXd>(target.weights.data(), rows);
    const auto columns = Eigen::Index(derivatives.size()) / rows;
    const Eigen::MatrixXd J =
        weights.asDiagonal() * Eigen::Map<const RowMajor>(derivatives.data(), rows, columns);
    const Eigen::VectorXd d =
        weights.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(difference.data(), rows));
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J);
    return (qr.householderQ().adjoint() * d).head(qr.rank()).norm() / sigma;
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

/// The values and derivatives that residuals and Jacobian were made of.
void keep_known(const Minimum& best, const Target& target, Search& found) {
    const std::size_t count = target.values.size();
    found.values.assign(count, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < best.residuals.size(); ++i)
        found.values[i] = target.values[i] + best.residuals[i] / target.weights[i];
    found.derivatives = best.jacobian;
    const std::size_t columns = best.jacobian.size() / count;
    for (std::size_t i = 0; i < best.jacobian.size(); ++i)
        found.derivatives[i] /= target.weights[i / columns];
}

/// The same of averages in place of those from the lattice of sizes.
double lattice_shift(const FitProblem& problem, Model& model, const Target& target,
                     const Minimum& best) {
    Search known;
    keep_known(best, target, known);
    std::vector<double> difference(known.values.size());
    model.evaluate_exactly(numbers_of(problem, model, best.x), difference);
    double squares = 0.0;
    for (std::size_t i = 0; i < difference.size(); ++i) {
        squares += std::pow(best.residuals[i], 2);
        difference[i] -= known.values[i];
    }
    const double freedom = double(difference.size()) - double(best.x.size());
    const double sigma = has_sigmas(problem) ? 1.0 : std::sqrt(squares / std::max(freedom, 1.0));
    return shift_of(difference, known.derivatives, target, sigma);
}

}  // namespace

Target target_of(const FitProblem& problem) {
    Target target;
    for (const FitData& data : problem.data) {
        for (const MeasuredValue& value : data.values) {
            target.values.push_back(value.value);
            target.weights.push_back(value.sigma > 0.0 ? 1.0 / value.sigma : 1.0);
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
        model.choose_streams(numbers_of(problem, model, best.x));
    } catch (const Cancelled&) {
        found.interrupted = true;
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
    for (int start = 0; start < problem.starts && !found.interrupted; ++start) {
        Minimum minimum = searcher.from(start_of(problem, model, start));
        // A start that no scene can have leads nowhere.
        if (std::isfinite(minimum.sum_of_squares)) keep(minimum);
        found.interrupted = searcher.cancelled();
    }
    const auto sort_minima = [&] {
        std::sort(found.minima.begin(), found.minima.end(),
                  [](const auto& a, const auto& b) { return a.chi_squared < b.chi_squared; });
    };
    sort_minima();
    const auto go_on = [&] {
        const Minimum again = searcher.from(best.x);
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
        // Nodes that were enough at the start may be too few here.
        for (int round = 0; round < 2 && !found.interrupted && best.converged; ++round) {
            if (!model.choose_streams(numbers_of(problem, model, best.x))) break;
            is_current = go_on();
            if (!is_current) break;
        }
        while (model.uses_lattice() && !found.interrupted && best.converged) {
            found.lattice_shift = lattice_shift(problem, model, target, best);
            if (*found.lattice_shift <= kMostShift) break;
            found.lattice_shift.reset();
            model.refine_lattice();
            is_current = go_on();
            if (!is_current) break;
        }
    } catch (const Cancelled&) {
        found.interrupted = true;
    }
    if (found.minima.empty())
        found.minima.push_back({best.sum_of_squares, 0, numbers_of(problem, model, best.x)});
    sort_minima();
    found.converged = best.converged && !found.interrupted;
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
    } else if (!found.converged) {
        found.reason = fmt::format(
            "no minimum within {} iterations; give more "
            "(iterations in [fit]), another start, or "
            "narrower bounds",
            problem.most_iterations);
        if (!searcher.refusal().empty())
            found.reason += fmt::format("; some scenes cannot be: {}", searcher.refusal());
    }
    return found;
}

}  // namespace miebrdf::fitting
