#include "pipeline/solve/weighted_optics.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace miebrdf {
namespace {

template <typename Number>
double weighted_sum(const std::vector<WeightedOptics>& nodes, const Number& number) {
    double sum = 0.0;
    for (const WeightedOptics& node : nodes) sum += node.weight * number(node);
    return sum;
}

/// exp of the sum of logarithms; the sum itself where a number is not positive.
template <typename Number>
double product_of(const std::vector<WeightedOptics>& nodes, const Number& number) {
    const bool all_positive = std::all_of(
        nodes.begin(), nodes.end(), [&](const WeightedOptics& node) { return number(node) > 0.0; });
    if (!all_positive) return weighted_sum(nodes, number);
    return std::exp(
        weighted_sum(nodes, [&](const WeightedOptics& node) { return std::log(number(node)); }));
}

/// Number by number; shorter lists go on with zeros.
template <typename List>
std::vector<double> weighted_lists(const std::vector<WeightedOptics>& nodes, const List& list) {
    std::vector<double> sum;
    for (const WeightedOptics& node : nodes) {
        const std::vector<double>& numbers = list(node);
        sum.resize(std::max(sum.size(), numbers.size()), 0.0);
        for (std::size_t k = 0; k < numbers.size(); ++k) sum[k] += node.weight * numbers[k];
    }
    return sum;
}

}  // namespace

MediumOptics sum_of(const std::vector<WeightedOptics>& nodes, double absorption) {
    MediumOptics result;
    rte::Optics& o = result.optics;
    o.one_minus_albedo = std::clamp(
        absorption * product_of(nodes,
                                [](const WeightedOptics& node) {
                                    return node.optics.optics.one_minus_albedo / node.absorption;
                                }),
        0.0, 1.0);
    o.single_scattering_albedo = 1.0 - o.one_minus_albedo;
    o.chi = weighted_lists(
        nodes, [](const WeightedOptics& m) -> auto& { return m.optics.optics.chi; });
    for (double& chi : o.chi) chi = std::clamp(chi, -1.0, 1.0);
    if (!o.chi.empty()) o.chi.front() = 1.0;
    result.phase = weighted_lists(
        nodes, [](const WeightedOptics& m) -> auto& { return m.optics.phase; });
    result.phase_error = weighted_lists(
        nodes, [](const WeightedOptics& m) -> auto& { return m.optics.phase_error; });
    result.asymmetry =
        weighted_sum(nodes, [](const WeightedOptics& m) { return m.optics.asymmetry; });
    result.q_ext =
        product_of(nodes, [](const WeightedOptics& m) { return m.optics.q_ext.value_or(0.0); });
    std::vector<std::pair<double, std::function<double(double)>>> phases;
    for (const WeightedOptics& node : nodes) {
        o.has_more_moments = o.has_more_moments || node.optics.optics.has_more_moments;
        result.error_estimate = std::max(result.error_estimate, node.optics.error_estimate);
        result.converged = result.converged && node.optics.converged;
        if (node.optics.optics.phase) phases.emplace_back(node.weight, node.optics.optics.phase);
    }
    if (phases.size() == nodes.size()) {
        o.phase = [phases = std::move(phases)](double cos_theta) {
            double sum = 0.0;
            for (const auto& [weight, phase] : phases) sum += weight * phase(cos_theta);
            return std::max(sum, 0.0);
        };
    }
    return result;
}

}  // namespace miebrdf
