#include "pipeline/scene/matrix_on_angles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "rte/math/matrix_series.h"

namespace miebrdf {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// Coefficients until the terms (2l + 1) chi_l are small, at most this many.
constexpr int kFirstDegree = 64, kLastDegree = 1024;
constexpr double kSmallTerm = 1e-3;

/// Gauss rules between the angles, that resolve functions of this degree; nodes are cosines.
math::Quadrature rule_of(const std::vector<double>& angles_deg, int degree,
                         std::vector<double>& at_deg) {
    math::Quadrature rule;
    at_deg.clear();
    for (std::size_t i = 1; i < angles_deg.size(); ++i) {
        const double width = (angles_deg[i] - angles_deg[i - 1]) * kRadiansPerDegree;
        const int nodes = 4 + static_cast<int>(std::ceil(0.5 * degree * width));
        const auto piece = math::gauss_legendre(nodes, angles_deg[i - 1], angles_deg[i]);
        for (std::size_t n = 0; n < piece.nodes.size(); ++n) {
            const double theta = piece.nodes[n] * kRadiansPerDegree;
            at_deg.push_back(piece.nodes[n]);
            rule.nodes.push_back(std::cos(theta));
            rule.weights.push_back(piece.weights[n] * kRadiansPerDegree * std::sin(theta));
        }
    }
    return rule;
}

Eigen::MatrixXd series_of(const MatrixOnAngles& table, int degree) {
    std::vector<double> at_deg;
    const math::Quadrature rule = rule_of(table.angles_deg, degree, at_deg);
    Eigen::MatrixXd values(Eigen::Index(at_deg.size()), table.ratios.empty() ? 1 : 6);
    for (std::size_t i = 0; i < at_deg.size(); ++i) {
        const rte::ScatteringMatrix m = table.at(at_deg[i]);
        const auto row = Eigen::Index(i);
        values(row, 0) = m.a1;
        if (!table.ratios.empty())
            values.row(row).tail<5>() << m.a4, m.a2 + m.a3, m.a2 - m.a3, m.b1, m.b2;
    }
    return math::matrix_series(std::move(values), rule, degree);
}

}  // namespace

rte::ScatteringMatrix MatrixOnAngles::at(double angle_deg) const {
    const auto above = std::upper_bound(angles_deg.begin() + 1, angles_deg.end() - 1, angle_deg);
    const auto i = static_cast<std::size_t>(above - angles_deg.begin());
    const double t =
        std::clamp((angle_deg - angles_deg[i - 1]) / (angles_deg[i] - angles_deg[i - 1]), 0.0, 1.0);
    const double a = phase[i - 1], b = phase[i];
    rte::ScatteringMatrix m;
    m.a1 = a > 0.0 && b > 0.0 ? a * std::pow(b / a, t) : (1.0 - t) * a + t * b;
    if (ratios.empty()) return m;
    double* const elements[kRatios] = {&m.a2, &m.a3, &m.a4, &m.b1, &m.b2};
    for (std::size_t e = 0; e < kRatios; ++e) {
        const double* list = ratios.data() + e * angles_deg.size();
        *elements[e] = m.a1 * ((1.0 - t) * list[i - 1] + t * list[i]);
    }
    return m;
}

rte::Optics optics_of_table(MatrixOnAngles table, double albedo) {
    Eigen::MatrixXd series;
    bool has_more = true;
    for (int degree = kFirstDegree; has_more && degree <= kLastDegree; degree *= 2) {
        const MatrixOnAngles phase{table.angles_deg, table.phase, {}};
        series = series_of(phase, degree);
        double largest = 0.0;  // of the last quarter: odd and even ones alternate
        for (int l = degree - degree / 4; l <= degree; ++l)
            largest = std::max(largest, (2.0 * l + 1.0) * std::abs(series(l, 0) / series(0, 0)));
        has_more = largest > kSmallTerm;
    }
    const auto degrees = static_cast<int>(series.rows());
    if (!table.ratios.empty()) series = series_of(table, degrees - 1);
    const double mean = series(0, 0);
    series /= mean;
    for (double& value : table.phase) value /= mean;
    rte::Optics optics;
    optics.single_scattering_albedo = albedo;
    optics.one_minus_albedo = 1.0 - albedo;
    optics.chi.assign(series.col(0).begin(), series.col(0).end());
    optics.has_more_moments = has_more;
    const auto exact = [table = std::make_shared<const MatrixOnAngles>(table)](double cos_theta) {
        return table->at(std::acos(std::clamp(cos_theta, -1.0, 1.0)) / kRadiansPerDegree);
    };
    optics.phase = [exact](double cos_theta) { return exact(cos_theta).a1; };
    if (table.ratios.empty()) return optics;
    rte::Polarisation polarisation;
    polarisation.matrix = exact;
    int column = 0;
    for (auto* list : {&polarisation.a4, &polarisation.a2, &polarisation.a3, &polarisation.b1,
                       &polarisation.b2}) {
        ++column;
        for (int l = 0; l < degrees; ++l) list->push_back((2.0 * l + 1.0) * series(l, column));
    }
    optics.polarisation = std::make_shared<const rte::Polarisation>(std::move(polarisation));
    return optics;
}

double lowest_eigenvalue(const rte::ScatteringMatrix& m) {
    return 0.5 * std::min(m.a1 + m.a2 - std::hypot(2.0 * m.b1, 2.0 * m.b2, m.a3 + m.a4),
                          m.a1 - m.a2 - std::abs(m.a3 - m.a4));
}

std::string impossible_matrix(const rte::ScatteringMatrix& m, double angle_deg, double noise) {
    const double lowest = lowest_eigenvalue(m);
    if (lowest >= -noise) return {};
    return fmt::format(
        "the scattering matrix at {:.4g} degrees is of no particle: its coherency matrix has the "
        "eigenvalue {:.3g} (a1 {:.3g}, a2 {:.3g}, a3 {:.3g}, a4 {:.3g}, b1 {:.3g}, b2 {:.3g}); "
        "allowed: none below 0 (at the least |b1|, |b2| and the others up to a1)",
        angle_deg, lowest, m.a1, m.a2, m.a3, m.a4, m.b1, m.b2);
}

}  // namespace miebrdf
