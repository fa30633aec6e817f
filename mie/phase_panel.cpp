#include "mie/phase_panel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mie/phase_table.h"

namespace miebrdf::mie {
namespace {

// Widths grow by this share of the distance from the nearer end, up to the widest.
constexpr double growth = 0.5;
constexpr double widest = 6 * std::numbers::pi / 180;

// Twice as many sizes leave 0.5 to 0.7 of the noise of ripple: a level that agrees with those
// before better than that does so by chance.
constexpr double slowest_gain = 0.5;

// Edges from 0 to pi/2, to be mirrored.
std::vector<double> graded_half(double narrowest) {
    std::vector<double> edges = {0};
    const double end = 0.5 * std::numbers::pi;
    while (edges.back() < end) {
        const double width = std::clamp(growth * edges.back(), std::min(narrowest, widest), widest);
        const double next = edges.back() + width;
        edges.push_back(next > end - 0.5 * width ? end : next);
    }
    return edges;
}

double last_two(const Eigen::VectorXd& values) {
    const Eigen::VectorXd c = PhaseTable::coefficients_of(values);
    return std::abs(c[PhaseTable::panel_nodes - 1]) + std::abs(c[PhaseTable::panel_nodes - 2]);
}

}  // namespace

std::vector<PhasePanel> graded_panels(double narrowest) {
    const std::vector<double> half = graded_half(narrowest);
    std::vector<PhasePanel> panels;
    for (std::size_t i = 0; i + 1 < half.size(); ++i) panels.emplace_back(half[i], half[i + 1], 0);
    for (std::size_t i = half.size() - 1; i > 0; --i) {
        panels.emplace_back(std::numbers::pi - half[i], std::numbers::pi - half[i - 1], 0);
    }
    return panels;
}

// Two halves that err independently: of the first level the spheres at even and at odd places, then
// all levels before and the new one.
void PhasePanel::add_level(const Eigen::MatrixXd& intensity, const double (&scattered)[2],
                           bool rippled, double scattering_efficiency, double floor) {
    HalvedIntensity halves{intensity, {scattered[0], scattered[1]}};
    if (++level_ > 0) {
        halves.intensity.col(0) = 0.5 * halves_.intensity.rowwise().sum();
        halves.intensity.col(1) = 0.5 * intensity.rowwise().sum();
        halves.scattered[0] = 0.5 * (halves_.scattered[0] + halves_.scattered[1]);
        halves.scattered[1] = 0.5 * (scattered[0] + scattered[1]);
    }
    halves_ = std::move(halves);
    judge(rippled, scattering_efficiency, floor);
}

Eigen::VectorXd PhasePanel::values() const {
    return halves_.intensity.rowwise().sum() / (halves_.scattered[0] + halves_.scattered[1]);
}

void PhasePanel::judge(bool rippled, double scattering_efficiency, double floor) {
    const Eigen::VectorXd P = values();
    const double largest = P.maxCoeff();
    const double worst_before = worst_, relative_before = relative_;
    worst_ = relative_ = 0;
    double rms = 0;
    if (halves_.scattered[1] > 0) {
        // The mean of two halves errs by half their difference.
        const Eigen::VectorXd error = 0.5 * (halves_.intensity.col(0) / halves_.scattered[0] -
                                             halves_.intensity.col(1) / halves_.scattered[1]);
        const Eigen::VectorXd relative = error.cwiseQuotient(P.cwiseMax(floor));
        const double root = std::sqrt(double(PhaseTable::panel_nodes));
        worst_ = relative.cwiseAbs().maxCoeff();
        relative_ = relative.norm() / root;
        rms = error.norm() / root;
    }
    const double doubt = rippled && level_ > 0 ? slowest_gain : 0.0;
    double missed = 0;
    if (scattering_efficiency > 0) {
        const double sampled = halves_.scattered[0] + halves_.scattered[1];
        missed = std::abs(sampled / scattering_efficiency - 1);
    }
    noise_ = std::max({relative_, doubt * relative_before, missed});
    worst_noise_ = std::max({worst_, doubt * worst_before, missed});
    moment_noise_ = std::max(rms, missed * largest) * 0.5 * (std::cos(lower_) - std::cos(upper_));
    tail_of_noise_ = rms / largest;
    tail_ = last_two(P) / largest;
}

double PhasePanel::moment_error(int first_moment) const {
    const double sine = std::min(std::sin(lower_), std::sin(upper_));
    const double damping = 2 / (std::numbers::pi * std::max(1, first_moment));
    const double legendre = damping < sine ? std::sqrt(damping / sine) : 1.0;
    return moment_noise_ * legendre / std::sqrt(double(PhaseTable::panel_nodes));
}

}  // namespace miebrdf::mie
