#include "pipeline/fit/certainty.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Core>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>

namespace miebrdf::fitting {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A number this close to a bound, as a share of the range, is at it.
constexpr double kAtBound = 1e-6;

/// Numbers that take part in a direction by less than this (of a unit vector)
/// are not named.
constexpr double kTakesPart = 0.2;

/// Changes of the residuals below this, in sigmas, are rounding.
constexpr double kNothing = 1e-6;

/// What counts as known: a positive number to a factor of e, another one to its
/// own size, and none to more than half its range.
double unit_of(const Unknown& unknown, double x) {
    const Range range = fitted_range(unknown);
    const double half = 0.5 * (range.high - range.low);
    if (unknown.scale != Unknown::Scale::linear) return std::min(half, 1.0);
    return x == 0.0 ? half : std::min(half, std::abs(x));
}

/// The square root of the weight that the loss leaves a residual of z sigma.
double weight_of_loss(const FitProblem& problem, double z) {
    const double ratio = std::abs(z) / problem.loss_width;
    if (problem.loss == FitLoss::huber && ratio > 1.0) return std::sqrt(1.0 / ratio);
    if (problem.loss == FitLoss::cauchy) return std::sqrt(1.0 / (1.0 + ratio * ratio));
    return 1.0;
}

struct Component {
    std::size_t slot;
    double share;  ///< of the unit vector
    double step;   ///< of the fitted number
    double alone;  ///< by how many sigma its unit changes the residuals while all others stay
};

bool is_log(const Unknown& unknown) { return unknown.scale != Unknown::Scale::linear; }

/// Its name where it stands in a product.
std::string factor_of(const Unknown& unknown, const std::string& name) {
    return unknown.scale == Unknown::Scale::log_of_one_minus ? fmt::format("(1 - {})", name) : name;
}

/// What of two numbers is known where moving both by their steps changes
/// nothing.
std::string combination(const FitProblem& problem, const Model& model, Component a, Component b,
                        const std::vector<double>& numbers) {
    const auto unknown = [&](const Component& d) -> const Unknown& {
        return problem.unknowns[model.slots()[d.slot].unknown];
    };
    if (is_log(unknown(b)) && !is_log(unknown(a))) std::swap(a, b);
    const std::string first = name_of(problem, model, a.slot),
                      second = name_of(problem, model, b.slot);
    // t_a + beta t_b stays the same.
    const double beta = -a.step / b.step;
    if (is_log(unknown(b)))
        return fmt::format("{} x {}^{:.2g}", factor_of(unknown(a), first),
                           factor_of(unknown(b), second), beta);
    if (!is_log(unknown(a)))
        return fmt::format("{} {} {:.2g} {}", first, beta < 0.0 ? "-" : "+", std::abs(beta),
                           second);
    // ln a + beta b is ln(a (1 + slope b)) near b.
    const double left = 1.0 - beta * numbers[b.slot];
    if (left < 0.2)
        return fmt::format("{} x exp({:.2g} {})", factor_of(unknown(a), first), beta, second);
    return fmt::format("{} x (1 {} {:.2g} {})", factor_of(unknown(a), first),
                       beta < 0.0 ? "-" : "+", std::abs(beta / left), second);
}

/// A direction along which the residuals change by less than a sigma, in words.
/// @param singular  by how many sigma
std::string in_words(const FitProblem& problem, const Model& model, std::vector<Component> parts,
                     double singular, const std::vector<double>& numbers) {
    std::sort(parts.begin(), parts.end(), [](const Component& a, const Component& b) {
        return std::abs(a.share) > std::abs(b.share);
    });
    // A number that alone would be known has a partner, however little this one moves.
    const std::size_t least =
        parts.front().alone >= 1.0 ? std::min<std::size_t>(2, parts.size()) : 1;
    while (parts.size() > least && std::abs(parts.back().share) < kTakesPart) parts.pop_back();
    if (parts.size() == 1) {
        const Unknown& unknown = problem.unknowns[model.slots()[parts[0].slot].unknown];
        const double unit = unit_of(unknown, numbers[parts[0].slot]);
        const std::string move = is_log(unknown) ? fmt::format("a factor of {:.2g}", std::exp(unit))
                                                 : fmt::format("{:.2g} more", unit);
        return fmt::format(
            "{} is not determined: {} {}", name_of(problem, model, parts[0].slot), move,
            singular < kNothing
                ? std::string("leaves the residuals as they are")
                : fmt::format("changes the residuals by {:.2g} sigma in all", singular));
    }
    if (parts.size() == 2) {
        return fmt::format("{} and {} are determined only as {}",
                           name_of(problem, model, parts[0].slot),
                           name_of(problem, model, parts[1].slot),
                           combination(problem, model, parts[0], parts[1], numbers));
    }
    std::vector<std::string> moves;
    for (const Component& part : parts) {
        const Unknown& unknown = problem.unknowns[model.slots()[part.slot].unknown];
        const std::string name = name_of(problem, model, part.slot);
        // As shares of one common step, the first of which is a tenth of its unit.
        const double step =
            0.1 * part.step / std::abs(parts[0].step) *
            unit_of(problem.unknowns[model.slots()[parts[0].slot].unknown], numbers[parts[0].slot]);
        moves.push_back(is_log(unknown)
                            ? fmt::format("{} x {:.3g}", factor_of(unknown, name), std::exp(step))
                            : fmt::format("{} {:+.2g}", name, step));
    }
    return fmt::format(
        "{} numbers are not determined together: {} leaves the "
        "residuals as they are",
        parts.size(), fmt::join(moves, ", "));
}

}  // namespace

std::string name_of(const FitProblem& problem, const Model& model, std::size_t slot) {
    const Unknown& unknown = problem.unknowns[model.slots()[slot].unknown];
    if (!unknown.per_wavelength) return unknown.name;
    return fmt::format("{} at {} nm", unknown.name,
                       model.wavelength_nm()[model.slots()[slot].wavelength]);
}

Certainty certainty_of(const FitProblem& problem, const Model& model, const Target& target,
                       const std::vector<double>& numbers, const std::vector<double>& values,
                       const std::vector<double>& derivatives, double sigma, double quantile) {
    const std::size_t slots = model.slots().size(), rows = target.values.size();
    Certainty result;
    result.standard_error.assign(slots, kNone);
    result.interval_low = result.interval_high = result.standard_error;
    result.correlation.assign(slots * slots, kNone);
    result.at_bound.assign(slots, false);
    std::vector<std::size_t> free;
    std::vector<double> units;
    for (std::size_t s = 0; s < slots; ++s) {
        const Unknown& unknown = problem.unknowns[model.slots()[s].unknown];
        const Range range = fitted_range(unknown);
        const double t = fitted_of(unknown, numbers[s]);
        const double reach = kAtBound * (range.high - range.low);
        result.at_bound[s] = t <= range.low + reach || t >= range.high - reach;
        if (result.at_bound[s]) continue;
        free.push_back(s);
        units.push_back(unit_of(unknown, numbers[s]));
    }
    if (free.empty() || !(sigma > 0.0)) return result;
    // One row and column for each residual and free number, in sigmas by units.
    Eigen::MatrixXd scaled(std::max(rows, free.size()), free.size());
    scaled.setZero();
    const std::vector<double> z = target.sigmas_off(values);
    std::vector<double> slopes = derivatives;
    target.to_sigmas(slopes);
    for (std::size_t i = 0; i < rows; ++i) {
        const double weight = weight_of_loss(problem, z[i]) / sigma;
        for (std::size_t f = 0; f < free.size(); ++f)
            scaled(Eigen::Index(i), Eigen::Index(f)) =
                slopes[i * slots + free[f]] * weight * units[f];
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinV);
    const Eigen::VectorXd& singular = svd.singularValues();
    const Eigen::MatrixXd& V = svd.matrixV();
    // Beyond this many units nothing is known, whatever rounding leaves of a
    // zero.
    constexpr double kUnknown = 1e-8;
    const double least = std::max(kUnknown, 1e-12 * singular(0));
    const Eigen::VectorXd inverse = singular.cwiseMax(least).cwiseInverse();
    const Eigen::MatrixXd half = V * inverse.asDiagonal();
    const Eigen::MatrixXd covariance = half * half.transpose();
    for (std::size_t f = 0; f < free.size(); ++f) {
        const std::size_t s = free[f];
        const Unknown& unknown = problem.unknowns[model.slots()[s].unknown];
        const Range range = fitted_range(unknown);
        const double error = units[f] * std::sqrt(covariance(Eigen::Index(f), Eigen::Index(f)));
        const double t = fitted_of(unknown, numbers[s]);
        double low = number_of(unknown, std::max(t - quantile * error, range.low)),
               high = number_of(unknown, std::min(t + quantile * error, range.high));
        if (low > high) std::swap(low, high);
        result.interval_low[s] = low;
        result.interval_high[s] = high;
        if (error < range.high - range.low)
            result.standard_error[s] = error * std::abs(slope(unknown, numbers[s]));
        for (std::size_t g = 0; g < free.size(); ++g)
            result.correlation[s * slots + free[g]] =
                covariance(Eigen::Index(f), Eigen::Index(g)) /
                std::sqrt(covariance(Eigen::Index(f), Eigen::Index(f)) *
                          covariance(Eigen::Index(g), Eigen::Index(g)));
    }
    for (Eigen::Index k = 0; k < singular.size(); ++k) {
        if (!(singular(k) < 1.0)) continue;
        std::vector<Component> parts;
        for (std::size_t f = 0; f < free.size(); ++f) {
            const double share = V(Eigen::Index(f), k);
            parts.push_back({free[f], share, share * units[f] / std::max(singular(k), least),
                             scaled.col(Eigen::Index(f)).norm()});
        }
        result.undetermined.push_back(
            in_words(problem, model, std::move(parts), singular(k), numbers));
    }
    return result;
}

}  // namespace miebrdf::fitting
