#include "mie/ensemble/phase_panel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mie/ensemble/phase_table.h"

namespace miebrdf::mie {
namespace {

// Widths grow by this share of the distance from the nearer end, up to the widest.
constexpr double kWidthGrowth = 1 / 3.0;
constexpr double kWidestPanel = 6 * std::numbers::pi / 180;

// Twice as many sizes leave 0.5 to 0.7 of the noise of ripple: a level that agrees with those
// before better than that does so by chance.
constexpr double kSlowestGain = 0.5;

// Towards the back all nodes of a panel see the same narrow resonances, and where both families
// miss one of them they agree everywhere. This share of what a new level changes counts as noise,
// too.
constexpr double kShareOfChange = 0.5;

// Where glories are.
constexpr double kBackward = 165 * std::numbers::pi / 180;

// Edges from 0 to pi/2, to be mirrored.
std::vector<double> graded_half(double narrowest) {
    std::vector<double> edges = {0};
    const double end = 0.5 * std::numbers::pi;
    while (edges.back() < end) {
        const double width = std::clamp(kWidthGrowth * edges.back(),
                                        std::min(narrowest, kWidestPanel), kWidestPanel);
        const double next = edges.back() + width;
        edges.push_back(next > end - 0.5 * width ? end : next);
    }
    return edges;
}

double last_two(const Eigen::VectorXd& values) {
    const Eigen::VectorXd c = panel_coefficients(values);
    return std::abs(c[PhaseTable::kPanelNodes - 1]) + std::abs(c[PhaseTable::kPanelNodes - 2]);
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

void PhasePanel::add_level(const std::vector<FamilyIntensity>& parts, const SizeFamilies& sizes,
                           const PhaseTabulationOptions& options) {
    const Eigen::VectorXd before = level_ < 0 ? Eigen::VectorXd() : values();
    if (++level_ == 0) {
        parts_ = parts;
        part_levels_.assign(parts.size(), 0);
    } else {
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (parts[i].intensity.size() == 0) continue;
            parts_[i] = sizes.with_level(parts_[i], parts[i]);
            ++part_levels_[i];
        }
    }
    sums_ = parts_.front();
    for (std::size_t i = 1; i < parts_.size(); ++i) {
        sums_.intensity += parts_[i].intensity;
        for (const int family : {0, 1}) sums_.scattered[family] += parts_[i].scattered[family];
    }
    const bool may_agree = sizes.rippled() && level_ > 0 && parts_.size() == 1 && is_backward();
    judge(sizes.rippled(), options, may_agree ? before : values());
}

std::vector<int> PhasePanel::next_levels(const SizeFamilies& sizes, double tolerance) const {
    if (level_ < 0) return std::vector<int>(sizes.part_count(), 0);
    std::vector<int> levels(part_levels_.size(), -1);
    const auto noisiest = std::max_element(part_noise_.begin(), part_noise_.end());
    for (std::size_t i = 0; i < levels.size(); ++i) {
        if (part_noise_[i] > tolerance || part_noise_[i] == *noisiest) {
            levels[i] = part_levels_[i] + 1;
        }
    }
    return levels;
}

Eigen::VectorXd PhasePanel::values() const {
    return sums_.intensity.rowwise().sum() / (sums_.scattered[0] + sums_.scattered[1]);
}

Eigen::VectorXd PhasePanel::values_of(int family) const {
    return sums_.intensity.col(family) / sums_.scattered[family];
}

void PhasePanel::judge(bool rippled, const PhaseTabulationOptions& options,
                       const Eigen::VectorXd& before) {
    const double scattering_efficiency = options.scattering_efficiency, floor = options.floor;
    const Eigen::VectorXd P = values();
    const double largest = P.maxCoeff();
    const double worst_before = worst_, relative_before = relative_;
    worst_ = relative_ = 0;
    double rms = 0;
    if (sums_.scattered[1] > 0) {
        // The mean of two families errs by half their difference.
        const Eigen::VectorXd error = 0.5 * (values_of(0) - values_of(1));
        const Eigen::VectorXd relative = error.cwiseQuotient(P.cwiseMax(floor));
        const double root = std::sqrt(double(PhaseTable::kPanelNodes));
        worst_ = relative.cwiseAbs().maxCoeff();
        relative_ = relative.norm() / root;
        rms = error.norm() / root;
        part_noise_.clear();
        for (const FamilyIntensity& part : parts_) {
            const Eigen::VectorXd of_part = 0.5 * (part.intensity.col(0) / sums_.scattered[0] -
                                                   part.intensity.col(1) / sums_.scattered[1]);
            part_noise_.push_back(of_part.cwiseQuotient(P.cwiseMax(floor)).norm() / root);
        }
    } else {
        part_noise_.assign(parts_.size(), 0.0);
    }
    const double doubt = rippled && level_ > 0 ? kSlowestGain : 0.0;
    double missed = 0;
    if (scattering_efficiency > 0) {
        const double sampled = sums_.scattered[0] + sums_.scattered[1];
        missed = std::abs(sampled / scattering_efficiency - 1);
    }
    const Eigen::VectorXd changed = kShareOfChange * (P - before).cwiseQuotient(P.cwiseMax(floor));
    const double by_level = changed.norm() / std::sqrt(double(PhaseTable::kPanelNodes));
    const double bias = options.ray_bias;
    noise_ = std::max({relative_, doubt * relative_before, missed, by_level}) + bias;
    worst_noise_ =
        std::max({worst_, doubt * worst_before, missed, changed.cwiseAbs().maxCoeff()}) + bias;
    // What parts on coarser levels miss, more sizes of the noisy ones do not mend.
    rms_ = parts_.size() > 1 ? rms : std::max(rms, missed * largest);
    largest_ = largest;
    tail_of_noise_ = rms / largest;
    tail_ = last_two(P) / largest;
}

// Share of the sphere, times |P_l| there.
double PhasePanel::solid_angle_of_moments(int first_moment) const {
    const double sine = std::min(std::sin(lower_), std::sin(upper_));
    const double damping = 2 / (std::numbers::pi * std::max(1, first_moment));
    const double legendre = damping < sine ? std::sqrt(damping / sine) : 1.0;
    return 0.5 * (std::cos(lower_) - std::cos(upper_)) * legendre;
}

bool PhasePanel::is_backward() const { return upper_ > kBackward; }

double PhasePanel::moment_noise(int first_moment) const {
    return rms_ * solid_angle_of_moments(first_moment) / std::sqrt(double(PhaseTable::kPanelNodes));
}

double PhasePanel::moment_tail(int first_moment) const {
    return 0.5 * tail_ * largest_ * solid_angle_of_moments(first_moment);
}

}  // namespace miebrdf::mie
