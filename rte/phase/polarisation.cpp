#include "rte/phase/polarisation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <miebrdf/error.h>
#include "rte/math/legendre.h"
#include "rte/math/wigner.h"

namespace miebrdf::rte {
namespace {

void require_coefficients(const std::vector<double>& list, const char* name, int first_degree) {
    // Noise that quadratures over noisy matrices leave.
    constexpr double noise = 1e-6;
    for (std::size_t l = 0; l < list.size(); ++l) {
        const bool exists = l >= std::size_t(first_degree);
        const double most = exists ? (2.0 * double(l) + 1.0) * (1.0 + noise) : noise;
        if (std::abs(list[l]) <= most) continue;
        throw UsageError(fmt::format("polarisation.{}[{}]", name, l), list[l],
                         exists ? fmt::format("-{0} to {0} (2l + 1)", 2 * l + 1)
                                : std::string("0 (there is no such degree)"));
    }
}

// sum (p_l + sign q_l) d^l_2,2sign of two lists of any lengths.
double sum_of_pair(const std::vector<double>& p, const std::vector<double>& q, int sign, double x) {
    return math::wigner_series(2, 2 * sign, p, x) + sign * math::wigner_series(2, 2 * sign, q, x);
}

double phase_at(const Optics& optics, double x) {
    return optics.phase ? optics.phase(x) : math::legendre_series(optics.chi, x);
}

void add(std::vector<double>& sum, double factor, const std::vector<double>& list) {
    sum.resize(std::max(sum.size(), list.size()), 0.0);
    for (std::size_t l = 0; l < list.size(); ++l) sum[l] += factor * list[l];
}

}  // namespace

void validate(const Polarisation& polarisation) {
    for (const auto& [name, list] : kMatrixLists) {
        const int first_degree = list == &MatrixExpansion::a4 ? 0 : 2;
        require_coefficients(polarisation.*list, name, first_degree);
    }
}

ScatteringMatrix exact_matrix(const Optics& optics, double cos_theta) {
    if (!optics.polarisation) return {.a1 = phase_at(optics, cos_theta)};
    const Polarisation& p = *optics.polarisation;
    if (p.matrix) return p.matrix(cos_theta);
    const double sum = sum_of_pair(p.a2, p.a3, 1, cos_theta);
    const double difference = sum_of_pair(p.a2, p.a3, -1, cos_theta);
    return {.a1 = phase_at(optics, cos_theta),
            .a2 = 0.5 * (sum + difference),
            .a3 = 0.5 * (sum - difference),
            .a4 = math::wigner_series(0, 0, p.a4, cos_theta),
            .b1 = math::wigner_series(0, 2, p.b1, cos_theta),
            .b2 = math::wigner_series(0, 2, p.b2, cos_theta)};
}

std::shared_ptr<const Polarisation> rayleigh_polarisation(double depolarisation_factor) {
    // Hansen & Travis 1974, eq. 2.15-2.16, expanded: b1 = -3/4 D sin^2, a2 = 3/4 D (1 + cos^2),
    // a3 = 3/2 D cos, a4 = 3/2 D D' cos.
    const double rho = depolarisation_factor;
    const double strength = (1.0 - rho) / (1.0 + 0.5 * rho);
    const double circular = (1.0 - 2.0 * rho) / (1.0 - rho);
    Polarisation rayleigh;
    rayleigh.a2 = {0.0, 0.0, 3.0 * strength};
    rayleigh.a4 = {0.0, 1.5 * strength * circular};
    rayleigh.b1 = {0.0, 0.0, -std::sqrt(1.5) * strength};
    return std::make_shared<const Polarisation>(std::move(rayleigh));
}

std::shared_ptr<const Polarisation> mix_polarisation(std::span<const Optics> components,
                                                     std::span<const double> share) {
    Polarisation mixture;
    bool any = false;
    bool any_matrix = false;
    for (std::size_t c = 0; c < components.size(); ++c) {
        const Polarisation* one = components[c].polarisation.get();
        if (one == nullptr) continue;
        any = true;
        any_matrix = any_matrix || one->matrix;
        for (const auto& [name, list] : kMatrixLists) add(mixture.*list, share[c], one->*list);
    }
    if (!any) return {};
    if (any_matrix) {
        mixture.matrix = [parts = std::vector<Optics>(components.begin(), components.end()),
                          shares = std::vector<double>(share.begin(), share.end())](double cosine) {
            ScatteringMatrix sum;
            for (std::size_t c = 0; c < parts.size(); ++c) {
                const ScatteringMatrix one = exact_matrix(parts[c], cosine);
                sum.a1 += shares[c] * one.a1;
                sum.a2 += shares[c] * one.a2;
                sum.a3 += shares[c] * one.a3;
                sum.a4 += shares[c] * one.a4;
                sum.b1 += shares[c] * one.b1;
                sum.b2 += shares[c] * one.b2;
            }
            return sum;
        };
    }
    return std::make_shared<const Polarisation>(std::move(mixture));
}

}  // namespace miebrdf::rte
