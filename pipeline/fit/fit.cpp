// From a problem to a result: the search, wavelength by wavelength where it can
// be, then what is certain about it.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <miebrdf/error.h>
#include <miebrdf/fit.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "pipeline/fit/certainty.h"
#include "pipeline/fit/fitted_scene.h"
#include "pipeline/fit/minima.h"
#include "pipeline/fit/model.h"
#include "pipeline/fit/problem.h"
#include "pipeline/solve/parallel.h"

namespace miebrdf {
namespace {

using namespace fitting;

/// A problem that is searched on its own: all of it, or one wavelength.
struct Part {
    Part(FitProblem all, const Control& control)
        : problem(std::move(all)), model(problem, control), target(target_of(problem)) {}

    FitProblem problem;
    Model model;
    Target target;
    Search found = {};

    const std::vector<double>& numbers() const { return found.minima.front().values; }
    double sum_of_squares() const {
        double sum = 0.0;
        for (const double z : target.sigmas_off(found.values)) sum += z * z;
        return sum;
    }
};

void run(Part& part, const Control& control) {
    // Lost light and fit take turns until they agree; a loss changes the fit by a fraction of it.
    constexpr double kSteady = 2e-4;
    constexpr int kMostTraces = 8;
    int traces = 0;
    do {
        part.found = search(part.problem, part.model, part.target, control);
    } while (++traces <= kMostTraces && part.found.converged &&
             part.model.trace_lost_light(part.numbers()) > kSteady);
    part.problem.loss_width = part.found.loss_width;
}

std::vector<std::unique_ptr<Part>> parts_of(const FitProblem& problem, const Control& control) {
    std::vector<std::unique_ptr<Part>> parts;
    if (!is_separable(problem)) {
        parts.push_back(std::make_unique<Part>(problem, control));
        run(*parts.front(), control);
        return parts;
    }
    Control inner = control;
    inner.threads = 1;
    inner.progress = {};
    for (const double nm : wavelengths_of(problem))
        parts.push_back(std::make_unique<Part>(at_wavelength(problem, nm), inner));
    // Interrupted parts say so themselves: what the others have found is kept.
    Control outer = control;
    outer.is_cancelled = {};
    run_parallel("fit", parts.size(), outer, [&](std::size_t i) { run(*parts[i], inner); });
    return parts;
}

/// Of a part that was interrupted before its first derivatives nothing is certain.
Certainty certainty_of(const Part& part, double sigma, double quantile) {
    const std::size_t n = part.numbers().size();
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (part.found.derivatives.empty() || part.found.is_at_edge) {
        const std::vector<double> none(n, kNone);
        return {none, none, none, std::vector<bool>(n, false), std::vector<double>(n * n, kNone),
                {}};
    }
    return certainty_of(part.problem, part.model, part.target, part.numbers(), part.found.values,
                        part.found.derivatives, sigma, quantile);
}

/// In standard errors: the normal distribution's, or Student's where sigma
/// comes from residuals.
double quantile_of(bool sigma_known, int degrees_of_freedom) {
    if (sigma_known) return boost::math::quantile(boost::math::normal(), 0.975);
    return boost::math::quantile(boost::math::students_t(std::max(degrees_of_freedom, 1)), 0.975);
}

/// The ends of an interval with two digits of its width, and four of each at least.
std::string interval_of(double low, double high) {
    const double largest = std::max(std::abs(low), std::abs(high)), width = high - low;
    const int digits = width > 0.0 ? int(std::ceil(std::log10(largest / width))) + 2 : 4;
    return fmt::format("95 %: {:.{}g} to {:.{}g}", low, std::clamp(digits, 4, 15), high,
                       std::clamp(digits, 4, 15));
}

/// What is said about one value: its bound, or its interval.
std::string note_of(const FittedValue& value) {
    if (value.at_bound)
        return fmt::format("at its {} bound",
                           value.value - value.low < value.high - value.value ? "lower" : "upper");
    if (std::isnan(value.standard_error)) return "not determined";
    return interval_of(value.interval_low, value.interval_high);
}

/// Lines that differ in their wavelength alone are too many to read.
void add_lines(std::vector<std::string>& all, const std::vector<std::string>& lines,
               const std::string& what) {
    constexpr std::size_t kMost = 6;
    for (std::size_t i = 0; i < lines.size() && i < kMost; ++i) all.push_back(lines[i]);
    if (lines.size() > kMost) all.push_back(fmt::format("{} more {}", lines.size() - kMost, what));
}

/// Where a number at its bound leaves a residual of many sigma, the measurement
/// is out of reach.
void add_unreachable(const Part& part, const std::vector<bool>& at_bound, double sigma,
                     std::vector<std::string>& lines) {
    constexpr double kFar = 5.0;
    const auto bound = std::find(at_bound.begin(), at_bound.end(), true);
    if (bound == at_bound.end() || !(sigma > 0.0)) return;
    std::size_t i = 0;
    double worst = kFar;
    std::string line;
    for (const FitData& data : part.problem.data) {
        for (const MeasuredValue& value : data.values) {
            const double z =
                std::abs(part.found.values[i] - value.value) * part.target.weights[i] / sigma;
            if (z > worst && std::isfinite(z)) {
                worst = z;
                line = fmt::format(
                    "{}: {} was measured, and with {} at its bound the scene gives "
                    "{:.4g}, {:.0f} "
                    "sigma away; widen the bounds, or the scene lacks something",
                    describe(data, value), value.value,
                    name_of(part.problem, part.model, std::size_t(bound - at_bound.begin())),
                    part.found.values[i], z);
            }
            ++i;
        }
    }
    if (!line.empty()) lines.push_back(line);
}

void add_misfit(FitResult& result, double largest_noise) {
    const auto& values = result.values;
    const bool all_at_bounds =
        std::all_of(values.begin(), values.end(), [](const FittedValue& v) { return v.at_bound; });
    if (all_at_bounds && !result.sigma_known)
        result.notes.push_back(
            "every number is at a bound: these values are out of reach, or the bounds too narrow");
    if (!result.sigma_known) return;
    constexpr double kFar = 5.0;
    if (result.degrees_of_freedom < 1) {
        if (largest_noise > kFar)
            result.notes.push_back(fmt::format(
                "the scene misses a value by {:.2g} sigma, though there are as many unknowns as "
                "values: no such scene has them all",
                largest_noise));
        return;
    }
    const double per_degree = result.chi_squared / result.degrees_of_freedom;
    const boost::math::chi_squared law(result.degrees_of_freedom);
    if (!std::isfinite(per_degree) || per_degree < 1.5 ||
        boost::math::cdf(boost::math::complement(law, result.chi_squared)) > 1e-3)
        return;
    result.notes.push_back(
        fmt::format("chi_squared per degree of freedom is {:.3g}: the scene "
                    "misses the data by {:.2g} times "
                    "their sigmas (largest {:.2g} sigma); either are too small, "
                    "or the scene is too simple. "
                    "Standard errors count the sigmas alone",
                    per_degree, std::sqrt(per_degree), largest_noise));
}

}  // namespace

FitResult fit(const FitProblem& given, const Control& control) {
    const FitProblem problem = checked(given);
    const auto parts = parts_of(problem, control);
    FitResult result;
    result.sigma_known = has_sigmas(problem);
    result.converged = true;
    for (const FitData& data : problem.data) {
        add_lines(result.notes, data.doubts, "doubts");
        if (data.spheres && !data.spheres->lost_light)
            result.notes.push_back(data.name +
                                   ": light that leaves the sample beside the ports is not "
                                   "computed; lost_light = true traces it");
    }
    int values = 0, numbers = 0;
    std::size_t failed = 0;
    for (const auto& part : parts) {
        result.chi_squared += part->sum_of_squares();
        values += int(part->found.values.size());
        result.iterations += part->found.iterations;
        result.solved_scenes += part->model.solved_scenes();
        result.interrupted = result.interrupted || part->found.interrupted;
        if (const auto& shift = part->found.lattice_shift)
            result.interpolation_shift = std::max(result.interpolation_shift.value_or(0.0), *shift);
        if (part->found.converged) continue;
        result.converged = false;
        ++failed;
        if (result.reason.empty()) result.reason = part->found.reason;
        if (parts.size() > 1 && failed == 1)
            result.reason =
                fmt::format("{} nm: {}", part->model.wavelength_nm().front(), part->found.reason);
    }
    if (failed > 1) result.reason += fmt::format(" (and {} more wavelengths)", failed - 1);
    for (const auto& part : parts) numbers += int(part->numbers().size());
    result.degrees_of_freedom = values - numbers;
    const double spread = result.degrees_of_freedom > 0
                              ? std::sqrt(result.chi_squared / result.degrees_of_freedom)
                              : 0.0;
    const double sigma = result.sigma_known ? 1.0 : spread;
    const double quantile = quantile_of(result.sigma_known, result.degrees_of_freedom);
    if (!(sigma > 0.0))
        result.notes.push_back(
            "no standard errors: there are as many unknowns as "
            "values, or no residuals; give sigma "
            "or relative_sigma");
    std::vector<std::string> undetermined, unreachable, about_search;
    const std::size_t all = std::size_t(numbers);
    result.correlation.assign(all * all, std::nan(""));
    result.values.resize(all);
    // Parts hold a wavelength each: its place in the list of an unknown's values.
    std::vector<std::vector<std::size_t>> places(parts.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
        for (std::size_t s = 0; s < parts[p]->numbers().size(); ++s)
            places[p].push_back(parts.size() == 1 ? s : s * parts.size() + p);
    }
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Part& part = *parts[p];
        const Certainty certainty = certainty_of(part, sigma, quantile);
        const std::size_t slots = part.numbers().size();
        for (std::size_t s = 0; s < slots; ++s) {
            const Slot& slot = part.model.slots()[s];
            const Unknown& unknown = part.problem.unknowns[slot.unknown];
            FittedValue& value = result.values[places[p][s]];
            value.unknown = unknown.name;
            if (unknown.per_wavelength)
                value.wavelength_nm = part.model.wavelength_nm()[slot.wavelength];
            value.value = part.numbers()[s];
            value.standard_error = certainty.standard_error[s];
            value.interval_low = certainty.interval_low[s];
            value.interval_high = certainty.interval_high[s];
            value.start = unknown.start;
            value.low = unknown.low;
            value.high = unknown.high;
            value.at_bound = certainty.at_bound[s];
            value.note = part.found.is_at_edge ? "no interval: at the edge of what can be computed"
                         : sigma > 0.0 || value.at_bound ? note_of(value)
                                                         : "";
            for (std::size_t o = 0; o < slots; ++o)
                result.correlation[places[p][s] * all + places[p][o]] =
                    certainty.correlation[s * slots + o];
        }
        undetermined.insert(undetermined.end(), certainty.undetermined.begin(),
                            certainty.undetermined.end());
        add_unreachable(part, certainty.at_bound, sigma, unreachable);
        for (const std::string& note : part.found.notes)
            about_search.push_back(
                parts.size() > 1
                    ? fmt::format("{} nm: {}", part.model.wavelength_nm().front(), note)
                    : note);
    }
    add_lines(result.notes, about_search, "wavelengths likewise");
    add_lines(result.undetermined, undetermined, "directions are not determined");
    add_lines(result.notes, unreachable, "values are out of reach");
    if (parts.size() == 1) result.minima = parts.front()->found.minima;
    double largest = 0.0;
    for (std::size_t d = 0; d < problem.data.size(); ++d) {
        for (const auto& part : parts) {
            std::size_t i = 0;
            for (std::size_t before = 0; before < d; ++before)
                i += part->problem.data[before].values.size();
            for (const MeasuredValue& value : part->problem.data[d].values) {
                FitResidual residual{d, value, part->found.values[i++]};
                double& own = residual.measured.sigma;
                if (!(own > 0.0)) own = spread;
                if (own > 0.0)
                    largest = std::max(largest, std::abs(residual.model - value.value) / own);
                result.residuals.push_back(residual);
            }
        }
    }
    add_misfit(result, largest);
    result.scene_file = fitted_scene(problem, result);
    return result;
}

}  // namespace miebrdf
