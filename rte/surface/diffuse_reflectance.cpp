#include "rte/surface/diffuse_reflectance.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "rte/math/quadrature.h"

namespace miebrdf::rte {
namespace {

double mean_with(const std::function<double(double)>& rho, HemisphereMean mean, int nodes) {
    const math::Quadrature rule = math::gauss_legendre(nodes, 0.0, 1.0);
    double sum = 0;
    for (int i = 0; i < nodes; ++i) {
        const double t = rule.nodes[i];
        const double mu = t * t;
        const double weight = 2.0 * t * rule.weights[i];
        sum += weight * (mean == HemisphereMean::cosine ? 2.0 * mu : 1.0) * (1.0 - rho(mu));
    }
    return sum;
}

}  // namespace

IntegralResult mean_transmittance(const std::function<double(double mu)>& rho, HemisphereMean mean,
                                  double tolerance) {
    if (!(tolerance > 0)) {
        throw std::invalid_argument(fmt::format("tolerance {}; allowed: > 0", tolerance));
    }
    constexpr int kFewest = 8;
    constexpr int kMost = 256;
    IntegralResult result;
    result.value = mean_with(rho, mean, kFewest);
    for (int nodes = 2 * kFewest; nodes <= kMost && !result.converged; nodes *= 2) {
        const double before = result.value;
        result.value = mean_with(rho, mean, nodes);
        result.nodes = nodes;
        result.error_estimate = std::abs(result.value - before);
        result.converged = result.error_estimate <= tolerance;
    }
    return result;
}

}  // namespace miebrdf::rte
