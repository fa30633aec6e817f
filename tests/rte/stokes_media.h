// Media whose scattering matrices are known, and ways to compare Mueller matrices.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "rte/math/quadrature.h"
#include "rte/math/wigner.h"
#include "rte/stack/layered_reflection.h"
#include "tests/support/reference_table.h"
#include "tools/bench/siewert_problem.h"

namespace miebrdf::support {

/// Problem IIA of Siewert 2000: a strong b2.
inline rte::Optics siewert_optics(bool with_b2) {
    return bench::siewert_optics(ReferenceTable("rte/stokes_siewert_2000.csv"), with_b2);
}

/// Henyey-Greenstein's peak, polarised as Rayleigh's light by half: a1 = a2 = P, b1 = -P/2 (1 -
/// x^2)/(1 + x^2), a3 = a4 = 2 P x/(1 + x^2), with its coefficients by quadrature.
inline rte::Optics polarised_peak_optics(double albedo, double asymmetry) {
    rte::Optics optics = rte::henyey_greenstein_optics(albedo, asymmetry);
    const auto matrix = [phase = optics.phase](double x) {
        const double P = phase(x);
        const double round = 2.0 * x / (1.0 + x * x);
        return rte::ScatteringMatrix{.a1 = P,
                                     .a2 = P,
                                     .a3 = P * round,
                                     .a4 = P * round,
                                     .b1 = -0.5 * P * (1.0 - x * x) / (1.0 + x * x)};
    };
    const int degrees = int(optics.chi.size());
    const auto rule = math::gauss_legendre(2 * degrees);
    const Eigen::Map<const Eigen::VectorXd> x(rule.nodes.data(), Eigen::Index(rule.nodes.size()));
    Eigen::MatrixXd circular, linear, plus, minus;
    math::wigner_functions(0, 0, degrees, x, circular);
    math::wigner_functions(0, 2, degrees, x, linear);
    math::wigner_functions(2, 2, degrees, x, plus);
    math::wigner_functions(2, -2, degrees, x, minus);
    rte::Polarisation p;
    p.a2.assign(std::size_t(degrees), 0.0);
    p.a3 = p.a4 = p.b1 = p.a2;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
        const rte::ScatteringMatrix F = matrix(x[k]);
        for (int l = 0; l < degrees; ++l) {
            const double weight = 0.5 * (2.0 * l + 1.0) * rule.weights[std::size_t(k)];
            p.a4[std::size_t(l)] += weight * F.a4 * circular(k, l);
            if (l < 2) continue;
            const double sum = weight * (F.a2 + F.a3) * plus(k, l - 2);
            const double rest = weight * (F.a2 - F.a3) * minus(k, l - 2);
            p.a2[std::size_t(l)] += 0.5 * (sum + rest);
            p.a3[std::size_t(l)] += 0.5 * (sum - rest);
            p.b1[std::size_t(l)] += weight * F.b1 * linear(k, l - 2);
        }
    }
    p.matrix = matrix;
    optics.polarisation = std::make_shared<const rte::Polarisation>(std::move(p));
    return optics;
}

/// Element of a table at positions in the three lists.
inline double element(const rte::ReflectionTable& table, const rte::Directions& directions,
                      std::size_t i, std::size_t o, std::size_t a, int row, int column) {
    const auto c = std::size_t(table.components);
    const std::size_t matrix =
        (i * directions.mu_out.size() + o) * directions.azimuth_deg.size() + a;
    return table.reflection[(matrix * c + std::size_t(row)) * c + std::size_t(column)];
}

/// Largest difference of two tables in units of R11.
inline double difference(const rte::ReflectionTable& one, const rte::ReflectionTable& other) {
    const auto elements = std::size_t(one.components * one.components);
    double largest = 0.0;
    for (std::size_t k = 0; k < one.reflection.size(); ++k) {
        const double R11 = one.reflection[k / elements * elements];
        const double apart = std::abs(one.reflection[k] - other.reflection[k]) / R11;
        if (!(apart <= largest)) largest = apart;
    }
    return largest;
}

/// Largest |R(mu_in, mu_out) - G R(mu_out, mu_in)^T G| / R11, for equal lists of cosines.
inline double reciprocity_error(const rte::ReflectionTable& table,
                                const rte::Directions& directions) {
    double largest = 0.0;
    for (std::size_t i = 0; i < directions.mu_in.size(); ++i)
        for (std::size_t o = 0; o < directions.mu_out.size(); ++o)
            for (std::size_t a = 0; a < directions.azimuth_deg.size(); ++a)
                for (int row = 0; row < table.components; ++row)
                    for (int column = 0; column < table.components; ++column) {
                        const double sign = (row == 3) == (column == 3) ? 1.0 : -1.0;
                        const double apart =
                            std::abs(element(table, directions, i, o, a, row, column) -
                                     sign * element(table, directions, o, i, a, column, row)) /
                            element(table, directions, i, o, a, 0, 0);
                        if (!(apart <= largest)) largest = apart;
                    }
    return largest;
}

/// From grazing to vertical, on both sides of the plane of incidence.
inline rte::Directions many_directions() {
    const std::vector<double> mu{1e-3, 0.1, 0.37, 0.8, 1.0};
    return {mu, mu, {0.0, 33.0, 120.0, 180.0, 250.0}};
}

}  // namespace miebrdf::support
