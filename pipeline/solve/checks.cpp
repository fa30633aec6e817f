#include "pipeline/solve/checks.h"

#include <algorithm>
#include <cmath>

#include "rte/math/tolerance_budget.h"

namespace miebrdf {
namespace {

/// Where each value is in a list, if it is there.
std::vector<std::optional<std::size_t>> places_of(const std::vector<double>& values,
                                                  const std::vector<double>& list) {
    std::vector<std::optional<std::size_t>> places;
    for (const double value : values) {
        const auto found = std::find(list.begin(), list.end(), value);
        auto& place = places.emplace_back();
        if (found != list.end()) place = static_cast<std::size_t>(found - list.begin());
    }
    return places;
}

}  // namespace

PhysicsReport physics_of(const std::vector<double>& values, const Directions& directions) {
    const auto& [mu_in, mu_out, azimuth] = directions;
    PhysicsReport report;
    report.least_value = *std::min_element(values.begin(), values.end());
    const double largest = *std::max_element(values.begin(), values.end());
    const auto swapped_in = places_of(mu_out, mu_in), swapped_out = places_of(mu_in, mu_out);
    for (std::size_t i = 0; i < mu_in.size(); ++i) {
        for (std::size_t o = 0; o < mu_out.size(); ++o) {
            const auto back_in = swapped_in[o], back_out = swapped_out[i];
            if (!back_in || !back_out) continue;
            for (std::size_t a = 0; a < azimuth.size(); ++a) {
                const double there = values[(i * mu_out.size() + o) * azimuth.size() + a];
                const double back =
                    values[(*back_in * mu_out.size() + *back_out) * azimuth.size() + a];
                const double defect = there == back ? 0.0 : std::abs(there - back) / largest;
                report.reciprocity_defect =
                    std::max(report.reciprocity_defect.value_or(0.0), defect);
            }
        }
    }
    return report;
}

double tolerance_for_transfer(double tolerance, double mie_error_estimate) {
    return std::max(tolerance - mie_error_estimate, kLeastTransferShare * tolerance);
}

std::vector<double> rest_for_phase(double tolerance, double mie_error_estimate,
                                   const std::vector<double>& transfer_errors) {
    std::vector<double> rest;
    rest.reserve(transfer_errors.size());
    for (const double error : transfer_errors) {
        // Where transfer alone errs by more than the tolerance, points do not bring it below.
        const double least = kPhaseShare * std::max(tolerance, error);
        rest.push_back(
            std::max(least, kShareOfPoints * (tolerance - (mie_error_estimate + error))));
    }
    return rest;
}

void judge(WavelengthReport& report, double with_transfer, double mie_error_estimate,
           double tolerance) {
    report.mie_error_estimate = mie_error_estimate;
    report.error_estimate = with_transfer + mie_error_estimate;
    report.converged = has_converged(report.error_estimate, tolerance, report.solver.converged);
}

void judge(WavelengthReport& report, double mie_error_estimate, double tolerance) {
    judge(report, report.solver.error_estimate, mie_error_estimate, tolerance);
}

}  // namespace miebrdf
