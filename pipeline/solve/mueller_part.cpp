#include "pipeline/solve/mueller_part.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace miebrdf {
namespace {

/// sum of a_m sin(m azimuth).
double sine_sum(const std::vector<double>& a, double cosine, double sine) {
    double before = 0.0, here = sine, sum = 0.0;
    for (std::size_t m = 1; m < a.size(); ++m) {
        sum += a[m] * here;
        const double next = 2.0 * cosine * here - before;
        before = here;
        here = next;
    }
    return sum;
}

}  // namespace

SmoothPart smooth_element(const rte::TabulatedOrders& table, int components, int row, int column) {
    const std::vector<double>& nodes = SmoothPart::nodes();
    if (!table.physical || table.orders.empty()) {
        const std::vector<double> none(nodes.size() * nodes.size(),
                                       std::numeric_limits<double>::quiet_NaN());
        return {none, 1};
    }
    const double sign = rte::stokes_harmonic(row, column).sign;
    const std::size_t orders = table.orders.size();
    std::vector<double> modes(nodes.size() * nodes.size() * orders);
    for (std::size_t m = 0; m < orders; ++m) {
        const double factor = sign * (m == 0 ? 1.0 : 2.0);
        for (std::size_t in = 0; in < nodes.size(); ++in) {
            for (std::size_t out = 0; out < nodes.size(); ++out) {
                const double value = table.orders[m](Eigen::Index(out) * components + row,
                                                     Eigen::Index(in) * components + column);
                modes[(in * nodes.size() + out) * orders + m] =
                    factor * (nodes[in] + nodes[out]) * value;
            }
        }
    }
    return {modes, orders};
}

MuellerPart::MuellerPart(const rte::TabulatedOrders& table, int components)
    : components_(components) {
    for (int element = 0; element < components * components; ++element) {
        elements_.push_back(
            smooth_element(table, components, element / components, element % components));
    }
}

void MuellerPart::evaluate(const rte::FirstOrder& first_order,
                           std::span<const Direction> directions, std::span<const double> first,
                           double* matrix, std::size_t stride) const {
    const double mu_in = directions[0].mu_in, mu_out = directions[0].mu_out;
    for (std::size_t d = 0; d < directions.size(); ++d) {
        Eigen::Matrix4d once =
            first_order.matrix(mu_in, mu_out, directions[d].azimuth_deg) / std::numbers::pi;
        if (once(0, 0) > 0.0) once *= first[d] / once(0, 0);
        for (int row = 0; row < components_; ++row) {
            for (int column = 0; column < components_; ++column)
                matrix[d * stride + std::size_t(row * components_ + column)] = once(row, column);
        }
    }
    const SixNodes in = SmoothPart::place_of(mu_in), out = SmoothPart::place_of(mu_out);
    std::vector<double> series;
    for (int element = 0; element < components_ * components_; ++element) {
        elements_[std::size_t(element)].series_at(in, out, mu_in + mu_out, series);
        const bool is_sine =
            rte::stokes_harmonic(element / components_, element % components_).is_sine;
        for (std::size_t d = 0; d < directions.size(); ++d) {
            const double azimuth = directions[d].azimuth_deg * (std::numbers::pi / 180.0);
            const double sum = is_sine ? sine_sum(series, std::cos(azimuth), std::sin(azimuth))
                                       : math::cosine_sum(series, std::cos(azimuth));
            matrix[d * stride + std::size_t(element)] += sum / std::numbers::pi;
        }
    }
}

}  // namespace miebrdf
