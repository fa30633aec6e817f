#include "pipeline/fit/polish.h"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "pipeline/fit/problem.h"

namespace miebrdf::fitting {
namespace {

/// How far values that differ by `difference` move the numbers of a minimum, or any combination of
/// them, in its own standard errors: what of the difference lies in the directions of the Jacobian.
double shift_of(std::vector<double> difference, std::vector<double> derivatives,
                const Target& target, double sigma) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    target.to_sigmas(difference);
    target.to_sigmas(derivatives);
    const auto rows = Eigen::Index(difference.size());
    const auto columns = Eigen::Index(derivatives.size()) / rows;
    const Eigen::MatrixXd J = Eigen::Map<const RowMajor>(derivatives.data(), rows, columns);
    const auto d = Eigen::Map<const Eigen::VectorXd>(difference.data(), rows);
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J);
    return (qr.householderQ().adjoint() * d).head(qr.rank()).norm() / sigma;
}

/// One sigma of residuals: 1, or as they scatter where sigmas are not known.
double sigma_of(const FitProblem& problem, const Minimum& best) {
    if (has_sigmas(problem)) return 1.0;
    const double freedom = double(best.residuals.size()) - double(best.x.size());
    return std::sqrt(best.sum_of_squares / std::max(freedom, 1.0));
}

/// The largest over the smallest singular value of a Jacobian with columns of length 1.
double condition_of(const Minimum& best) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = Eigen::Index(best.residuals.size()), columns = Eigen::Index(best.x.size());
    const Eigen::MatrixXd J =
        Eigen::Map<const RowMajor>(best.jacobian.data(), rows, columns).colwise().normalized();
    const Eigen::VectorXd squares =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(J.transpose() * J, Eigen::EigenvaluesOnly)
            .eigenvalues();
    return std::sqrt(squares.maxCoeff() / std::max(squares.minCoeff(), 1e-15));
}

/// The step to the least sum of squares of the linear model, within the bounds: unknowns that it
/// would take beyond one stay there.
std::vector<double> linear_step(const FitProblem& problem, const Model& model,
                                const Minimum& best) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = Eigen::Index(best.residuals.size()), columns = Eigen::Index(best.x.size());
    const Eigen::Map<const RowMajor> J(best.jacobian.data(), rows, columns);
    Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(best.residuals.data(), rows);
    std::vector<double> step(best.x.size(), 0.0);
    std::vector<Eigen::Index> free(best.x.size());
    std::iota(free.begin(), free.end(), Eigen::Index(0));
    while (!free.empty()) {
        const Eigen::VectorXd wanted =
            Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(J(Eigen::all, free)).solve(-r);
        std::vector<Eigen::Index> within;
        for (std::size_t k = 0; k < free.size(); ++k) {
            const auto s = std::size_t(free[k]);
            const Range range = fitted_range(problem.unknowns[model.slots()[s].unknown]);
            const double to =
                std::clamp(best.x[s] + wanted[Eigen::Index(k)], range.low, range.high);
            step[s] = to - best.x[s];
            if (to == best.x[s] + wanted[Eigen::Index(k)]) within.push_back(free[k]);
        }
        if (within.size() == free.size()) break;
        for (const Eigen::Index s : free) {
            if (std::find(within.begin(), within.end(), s) == within.end())
                r += J.col(s) * step[std::size_t(s)];
        }
        free = within;
    }
    return step;
}

/// The length of a step: how far it moves values, over sigma.
double standard_errors_of(const std::vector<double>& step, const Minimum& at, double sigma) {
    double squares = 0.0;
    for (std::size_t i = 0; i < at.residuals.size(); ++i) {
        double change = 0.0;
        for (std::size_t s = 0; s < step.size(); ++s)
            change += at.jacobian[i * step.size() + s] * step[s];
        squares += change * change;
    }
    return std::sqrt(squares) / sigma;
}

void set_residuals(std::vector<double> residuals, Minimum& at) {
    at.residuals = std::move(residuals);
    at.sum_of_squares =
        std::inner_product(at.residuals.begin(), at.residuals.end(), at.residuals.begin(), 0.0);
}

}  // namespace

std::vector<double> numbers_of(const FitProblem& problem, const Model& model,
                               std::span<const double> t) {
    std::vector<double> numbers;
    for (std::size_t s = 0; s < t.size(); ++s)
        numbers.push_back(number_of(problem.unknowns[model.slots()[s].unknown], t[s]));
    return numbers;
}

void keep_known(const Minimum& best, const Target& target, Search& found) {
    const std::size_t count = target.values.size();
    found.values.assign(count, std::numeric_limits<double>::quiet_NaN());
    if (!best.residuals.empty()) {
        found.values = best.residuals;
        target.from_sigmas(found.values);
        for (std::size_t i = 0; i < count; ++i) found.values[i] += target.values[i];
    }
    found.derivatives = best.jacobian;
    target.from_sigmas(found.derivatives);
}

double lattice_shift(const FitProblem& problem, Model& model, const Target& target,
                     const Minimum& best) {
    Search known;
    keep_known(best, target, known);
    std::vector<double> difference(known.values.size());
    model.evaluate_exactly(numbers_of(problem, model, best.x), difference);
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= known.values[i];
    return shift_of(difference, known.derivatives, target, sigma_of(problem, best));
}

bool may_be_polished(const FitProblem& problem) {
    return problem.loss == FitLoss::squares &&
           std::none_of(problem.data.begin(), problem.data.end(), [](const FitData& data) {
               return data.spheres && data.spheres->lost_light;
           });
}

std::optional<double> polish(const FitProblem& problem, Model& model, const Target& target,
                             Minimum& best, const std::function<bool()>& is_cancelled) {
    constexpr int kMostSteps = 5;
    const double of_derivatives = kSearchTolerance * condition_of(best);
    if (!(of_derivatives <= kMostShift)) return std::nullopt;
    Minimum at = best;
    for (int k = 0; k < kMostSteps && !is_cancelled(); ++k) {
        std::vector<double> searched = at.residuals;
        model.evaluate_exactly(numbers_of(problem, model, at.x), at.residuals);
        set_residuals(target.sigmas_off(at.residuals), at);
        const std::vector<double> step = linear_step(problem, model, at);
        const double shift = standard_errors_of(step, at, sigma_of(problem, at));
        double left = shift + of_derivatives;
        if (!std::isfinite(shift)) break;
        if (left > kMostShift) {
            // Along the step exact values change as those of the search do.
            std::vector<double> offset = at.residuals;
            for (std::size_t i = 0; i < offset.size(); ++i) offset[i] -= searched[i];
            for (std::size_t s = 0; s < step.size(); ++s) at.x[s] += step[s];
            model.evaluate(numbers_of(problem, model, at.x), searched, at.jacobian);
            searched = target.sigmas_off(searched);
            target.to_sigmas(at.jacobian);
            for (std::size_t i = 0; i < offset.size(); ++i) offset[i] += searched[i];
            set_residuals(std::move(offset), at);
            left = standard_errors_of(linear_step(problem, model, at), at, sigma_of(problem, at)) +
                   (1.0 + shift) * of_derivatives;
        }
        if (left <= kMostShift) {
            best = at;
            return left;
        }
        at.residuals = searched;
    }
    return std::nullopt;
}

}  // namespace miebrdf::fitting
