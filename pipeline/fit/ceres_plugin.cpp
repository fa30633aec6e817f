// The plug-in around Ceres: Levenberg-Marquardt within bounds, with a dense
// factorisation.
#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <memory>

#include "pipeline/fit/least_squares.h"

namespace miebrdf::fitting {
namespace {

/// Below this root mean square in sigmas nothing is left to fit: data without
/// noise.
constexpr double kExact = 1e-5;

ceres::LossFunction* make_loss(const LeastSquares& problem) {
    switch (problem.loss) {
        case FitLoss::squares:
            return nullptr;
        case FitLoss::huber:
            return new ceres::HuberLoss(problem.loss_width);
        case FitLoss::cauchy:
            return new ceres::CauchyLoss(problem.loss_width);
    }
    return nullptr;
}

/// All residuals and derivatives at once, before Ceres asks for them one by one: robust losses act
/// on each residual alone.
///
/// Ceres cuts its steps at the bounds, so that near one all other unknowns move as if the cut one
/// had moved too, and the search crawls. Unknowns that are at a bound and are pushed out are
/// therefore held: their derivatives are zero until the push turns.
class Evaluation : public ceres::EvaluationCallback {
  public:
    explicit Evaluation(const LeastSquares& problem)
        : x(problem.start),
          residuals(problem.residuals),
          loss(make_loss(problem)),
          held(problem.start.size(), false),
          should_hold(held),
          best{.x = problem.start},
          problem_(problem),
          slopes_(problem.residuals * problem.start.size()) {}

    /// Derivatives come with every point: they share its solution, and few steps are refused.
    void PrepareForEvaluation(bool, bool) override {
        if (x != asked_) {
            asked_ = x;
            is_good = problem_.evaluate(x, residuals, slopes_);
            if (is_good) keep_if_best();
        }
        if (!is_good) return;
        jacobian = slopes_;
        for (std::size_t i = 0; i < jacobian.size(); ++i) {
            if (held[i % x.size()]) jacobian[i] = 0.0;
        }
    }

    /// Of a squared residual: the loss and its derivative.
    std::array<double, 3> loss_of(double square) const {
        std::array<double, 3> rho = {square, 1.0, 0.0};
        if (loss != nullptr) loss->Evaluate(square, rho.data());
        return rho;
    }

    std::vector<double> x, residuals, jacobian;
    std::unique_ptr<ceres::LossFunction> loss;
    std::vector<bool> held, should_hold;  ///< the latter at the best point
    Minimum best;
    bool is_good = false;

  private:
    void keep_if_best() {
        double sum = 0.0;
        for (const double r : residuals) sum += loss_of(r * r)[0];
        if (!(sum < best.sum_of_squares)) return;
        best.sum_of_squares = sum;
        best.x = x;
        best.residuals = residuals;
        best.jacobian = slopes_;
        const std::size_t n = x.size();
        std::vector<double> gradient(n, 0.0);
        for (std::size_t i = 0; i < residuals.size(); ++i) {
            const double weighted = loss_of(residuals[i] * residuals[i])[1] * residuals[i];
            for (std::size_t j = 0; j < n; ++j) gradient[j] += weighted * slopes_[i * n + j];
        }
        for (std::size_t j = 0; j < n; ++j)
            should_hold[j] = (x[j] <= problem_.low[j] && gradient[j] > 0.0) ||
                             (x[j] >= problem_.high[j] && gradient[j] < 0.0);
    }

    const LeastSquares& problem_;
    std::vector<double> asked_ = {}, slopes_;  ///< of no number held
};

class OneResidual : public ceres::CostFunction {
  public:
    OneResidual(const Evaluation& all, std::size_t index) : all_(all), index_(index) {
        set_num_residuals(1);
        mutable_parameter_block_sizes()->push_back(int(all.x.size()));
    }
    bool Evaluate(double const* const*, double* residual, double** jacobian) const override {
        if (!all_.is_good) return false;
        *residual = all_.residuals[index_];
        if (jacobian != nullptr && jacobian[0] != nullptr) {
            const std::size_t n = all_.x.size();
            std::copy_n(all_.jacobian.begin() + std::ptrdiff_t(index_ * n), n, jacobian[0]);
        }
        return true;
    }

  private:
    const Evaluation& all_;
    std::size_t index_;
};

class Watch : public ceres::IterationCallback {
  public:
    Watch(const LeastSquares& problem, const Evaluation& evaluation)
        : problem_(problem), evaluation_(evaluation) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& step) override {
        if (problem_.is_enough && problem_.is_enough(step.iteration)) {
            was_ended = true;
            return ceres::SOLVER_ABORT;
        }
        const double exact = 0.5 * double(problem_.residuals) * kExact * kExact;
        bool hits_bound = false;
        for (std::size_t j = 0; j < evaluation_.held.size(); ++j)
            hits_bound = hits_bound || (evaluation_.should_hold[j] && !evaluation_.held[j]);
        return step.cost <= exact || hits_bound ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                                                : ceres::SOLVER_CONTINUE;
    }
    bool was_ended = false;

  private:
    const LeastSquares& problem_;
    const Evaluation& evaluation_;
};

Minimum solve(const LeastSquares& problem) {
    FLAGS_minloglevel =
        google::GLOG_FATAL;  // Ceres logs steps that fail; the library prints nothing
    Evaluation evaluation(problem);
    Watch watch(problem, evaluation);
    int left = problem.most_iterations;
    // Each round holds other unknowns at their bounds; as many as there are unknowns, and back.
    const int most_rounds = 2 * int(problem.start.size()) + 2;
    for (int round = 0; round < most_rounds && left > 0 && !watch.was_ended; ++round) {
        const double before = evaluation.best.sum_of_squares;
        ceres::Problem::Options ownership;
        ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        ownership.evaluation_callback = &evaluation;
        ceres::Problem sum(ownership);
        double* const x = evaluation.x.data();
        for (std::size_t i = 0; i < problem.residuals; ++i)
            sum.AddResidualBlock(new OneResidual(evaluation, i), evaluation.loss.get(), x);
        for (std::size_t j = 0; j < problem.start.size(); ++j) {
            sum.SetParameterLowerBound(x, int(j), problem.low[j]);
            sum.SetParameterUpperBound(x, int(j), problem.high[j]);
        }
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_QR;
        options.max_num_iterations = left;
        options.function_tolerance = problem.least_gain;
        options.parameter_tolerance = 1e-8;
        options.logging_type = ceres::SILENT;
        options.callbacks.push_back(&watch);
        ceres::Solver::Summary summary;
        ceres::Solve(options, &sum, &summary);
        const int iterations = std::max(int(summary.iterations.size()) - 1, 0);
        evaluation.best.iterations += iterations;
        evaluation.best.message = summary.message;
        evaluation.best.converged = summary.termination_type == ceres::CONVERGENCE ||
                                    summary.termination_type == ceres::USER_SUCCESS;
        left -= std::max(iterations, 1);
        if (!evaluation.best.converged || evaluation.should_hold == evaluation.held) break;
        // At a bound, rounding turns the push of a number that nothing depends on.
        const bool gains =
            evaluation.best.sum_of_squares < (1.0 - options.function_tolerance) * before;
        if (round > 0 && !gains) break;
        evaluation.best.converged = false;  // until the next round says so
        evaluation.held = evaluation.should_hold;
    }
    return evaluation.best;
}

}  // namespace
}  // namespace miebrdf::fitting

extern "C" __attribute__((visibility("default"))) void miebrdf_minimise(
    const miebrdf::fitting::LeastSquares& problem, miebrdf::fitting::Minimum& minimum) {
    minimum = miebrdf::fitting::solve(problem);
}
