#include "mie/ensemble/phase_panel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/phase_table.h"

namespace miebrdf::mie {
namespace {

// docs/maths-mie.md#phase-function and docs/internals/mie-log.md have the measurements.
// docs/internals/constants.md says what each constant does.
struct PanelRule {
    /// Widths grow by this share of the distance from the nearer end, up to the widest.
    static constexpr double kWidthGrowth = 0.4, kWidest = 6 * std::numbers::pi / 180;
};

double rms_of(const Eigen::VectorXd& at_nodes) {
    return at_nodes.norm() / std::sqrt(double(PhaseTable::kPanelNodes));
}

// Edges from 0 to pi/2, to be mirrored.
std::vector<double> graded_half(double narrowest) {
    std::vector<double> edges = {0};
    const double end = 0.5 * std::numbers::pi;
    while (edges.back() < end) {
        const double width =
            std::clamp(PanelRule::kWidthGrowth * edges.back(),
                       std::min(narrowest, PanelRule::kWidest), PanelRule::kWidest);
        const double next = edges.back() + width;
        edges.push_back(next > end - 0.5 * width ? end : next);
    }
    return edges;
}

// The sum of the last two coefficients, which bounds what the polynomial leaves out. By rays, where
// no noise hides it, they may be small by chance: the decay from the fourth pair to the third is
// taken to go on.
double last_two(const Eigen::VectorXd& values, bool by_rays) {
    const Eigen::VectorXd c = panel_coefficients(values);
    const auto pair = [&](int from_end) {
        const Eigen::Index last = PhaseTable::kPanelNodes - 1 - from_end;
        return std::abs(c[last]) + std::abs(c[last - 1]);
    };
    const double before = pair(2), start = pair(4);
    const double expected = start > before ? before * before / start : before;
    return by_rays ? std::max(pair(0), expected) : pair(0);
}

}  // namespace

std::vector<PhasePanel> graded_panels(double narrowest, double narrowest_backward) {
    const std::vector<double> forward = graded_half(narrowest);
    const std::vector<double> backward = graded_half(narrowest_backward);
    std::vector<PhasePanel> panels;
    for (std::size_t i = 0; i + 1 < forward.size(); ++i)
        panels.emplace_back(forward[i], forward[i + 1], 0);
    for (std::size_t i = backward.size() - 1; i > 0; --i)
        panels.emplace_back(std::numbers::pi - backward[i], std::numbers::pi - backward[i - 1], 0);
    return panels;
}

void PhasePanel::add_level(const std::vector<PairedIntensity>& parts,
                           const std::vector<int>& levels, const PairedSizeSamples& sizes,
                           const PhaseGoal& goal) {
    const Eigen::VectorXd before = level_ < 0 ? Eigen::VectorXd() : values();
    ++level_;
    parts_.resize(parts.size());
    part_levels_.resize(parts.size(), -1);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].intensity.size() == 0) continue;
        parts_[i] = part_levels_[i] < 0 ? parts[i] : sizes.with_level(parts_[i], parts[i]);
        part_levels_[i] = levels[i];
    }
    sums_ = parts_.front();
    for (std::size_t i = 1; i < parts_.size(); ++i) {
        sums_.intensity += parts_[i].intensity;
        for (const int sample : {0, 1}) sums_.scattered[sample] += parts_[i].scattered[sample];
    }
    // Parts are on levels of their own: what they scatter together would err as the coarsest.
    const bool by_rays = parts_.size() > 1 && goal.scattering_efficiency > 0;
    for (const int sample : {0, 1})
        whole_[sample] = by_rays ? goal.scattering_efficiency / 2 : sums_.scattered[sample];
    judge(sizes, goal, sizes.rippled() && level_ > 0 && parts_.size() == 1 ? before : values());
}

std::vector<int> PhasePanel::next_levels(const PairedSizeSamples& sizes, double tolerance) const {
    if (level_ < 0) {
        std::vector<int> missing(sizes.part_count(), 0);
        for (std::size_t i = 0; i < part_levels_.size(); ++i) {
            if (part_levels_[i] >= 0) missing[i] = -1;
        }
        return missing;
    }
    std::vector<int> levels(part_levels_.size(), -1);
    const auto noisiest = std::max_element(part_noise_.begin(), part_noise_.end());
    for (std::size_t i = 0; i < levels.size(); ++i) {
        if (part_noise_[i] > tolerance || part_noise_[i] == *noisiest)
            levels[i] = part_levels_[i] + 1;
    }
    return levels;
}

PhasePanel PhasePanel::half(double lower, double upper, double smooth) const {
    PhasePanel half(lower, upper, generation_ + 1);
    half.parts_.resize(parts_.size());
    half.part_levels_.assign(parts_.size(), -1);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (!(last_two(part_values(parts_[i]), true) <= smooth)) continue;
        half.part_levels_[i] = part_levels_[i];
        half.parts_[i] = parts_[i];
        Eigen::MatrixXd& intensity = half.parts_[i].intensity;
        for (const int sample : {0, 1}) {
            const Eigen::VectorXd coefficients =
                panel_coefficients(parts_[i].intensity.col(sample));
            Eigen::Index node = 0;
            for (const double theta : panel_nodes(lower, upper)) {
                const double t = (2 * theta - lower_ - upper_) / (upper_ - lower_);
                intensity(node++, sample) = panel_value(coefficients.data(), t);
            }
        }
    }
    return half;
}

Eigen::VectorXd PhasePanel::values() const { return part_values(sums_); }

Eigen::VectorXd PhasePanel::part_values(const PairedIntensity& part) const {
    return part.intensity.rowwise().sum() / (whole_[0] + whole_[1]);
}

Eigen::VectorXd PhasePanel::values_of(int sample) const {
    return sums_.intensity.col(sample) / sums_.scattered[sample];
}

// The mean of two samples errs by half their difference.
void PhasePanel::judge_parts(const PairedSizeSamples& sizes, const Eigen::VectorXd& scale) {
    const auto error_of = [&](const PairedIntensity& part) -> Eigen::VectorXd {
        return (0.5 * (part.intensity.col(0) / whole_[0] - part.intensity.col(1) / whole_[1]))
            .cwiseQuotient(scale);
    };
    const Eigen::VectorXd error = error_of(sums_);
    worst_ = error.cwiseAbs().maxCoeff();
    relative_ = rms_of(error);
    part_noise_.clear();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Eigen::VectorXd of_part = error_of(parts_[i]);
        part_noise_.push_back(rms_of(of_part));
        if (sizes.rays() == nullptr) continue;
        const Eigen::VectorXd value = part_values(parts_[i]).cwiseQuotient(scale);
        const auto with_floor = [&](double difference, double of) {
            return sizes.rays()->noise_floor_at_level(i, part_levels_[i], lower_, upper_,
                                                      difference, of);
        };
        part_noise_[i] = with_floor(part_noise_[i], rms_of(value));
        worst_ = std::max(worst_, with_floor(of_part.cwiseAbs().maxCoeff(), value.maxCoeff()));
        relative_ = std::max(relative_, part_noise_[i]);
    }
}

// Rays of one number of ways interfere as the sizes have it; what others leave at sharp ends goes
// with the root of the products of their intensities.
Eigen::VectorXd PhasePanel::bias_at_nodes(const PairedSizeSamples& sizes, const PhaseGoal& goal,
                                          const Eigen::VectorXd& scale) const {
    const Eigen::VectorXd P = values();
    Eigen::VectorXd mixed = P.cwiseAbs2();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (sizes.rays() != nullptr && sizes.rays()->is_one_ray(i))
            mixed -= part_values(parts_[i]).cwiseAbs2();
    }
    return (goal.ray_bias.ends * mixed.cwiseMax(0.0).cwiseSqrt() +
            goal.ray_bias.everywhere * P.cwiseMax(AverageLimits::kDim))
        .cwiseQuotient(scale);
}

void PhasePanel::judge(const PairedSizeSamples& sizes, const PhaseGoal& goal,
                       const Eigen::VectorXd& before) {
    const Eigen::VectorXd P = values(), scale = P.cwiseMax(goal.floor);
    const bool by_rays = sizes.rays() != nullptr;
    worst_ = relative_ = rms_ = 0;
    if (sums_.scattered[1] > 0) {
        judge_parts(sizes, scale);
        rms_ = rms_of(0.5 * (values_of(0) - values_of(1)));
    } else {
        part_noise_.assign(parts_.size(), 0.0);
    }
    largest_ = P.maxCoeff();
    // By rays P is relative to the efficiency itself.
    double missed = 0;
    if (!by_rays && goal.scattering_efficiency > 0)
        missed = std::abs((whole_[0] + whole_[1]) / goal.scattering_efficiency - 1);
    // The mean of two sums errs by half their difference: so does that of the last level and those
    // before it. Both samples may miss the same narrow resonance, which a new level meets.
    const Eigen::VectorXd changed = (P - before).cwiseQuotient(scale);
    const double worst_of_sizes = std::max({worst_, missed, changed.cwiseAbs().maxCoeff()});
    // Bows that few sizes see are narrower than a panel: by rays one node may have all of the
    // noise.
    const double of_sizes =
        by_rays ? worst_of_sizes : std::max({relative_, missed, rms_of(changed)});
    // Noise and bias are independent of each other, but glories have more of both than samples
    // tell.
    const Eigen::VectorXd bias = bias_at_nodes(sizes, goal, scale);
    bias_ = rms_of(bias);
    const auto together = [this](double sizes_part, double rays_part) {
        return is_backward() ? sizes_part + rays_part : std::hypot(sizes_part, rays_part);
    };
    noise_ = together(of_sizes, bias_);
    worst_noise_ = together(worst_of_sizes, bias.maxCoeff());
    tail_of_noise_ = rms_ / largest_;
    rms_ = std::max(rms_, missed * largest_);
    const double left_out = last_two(P, by_rays);
    tail_ = left_out / largest_;
}

// Share of the sphere, times |P_l| there.
double PhasePanel::solid_angle_of_moments(int first_moment) const {
    const double sine = std::min(std::sin(lower_), std::sin(upper_));
    const double damping = 2 / (std::numbers::pi * std::max(1, first_moment));
    const double legendre = damping < sine ? std::sqrt(damping / sine) : 1.0;
    return 0.5 * (std::cos(lower_) - std::cos(upper_)) * legendre;
}

bool PhasePanel::is_backward() const { return upper_ > AverageLimits::kBackward; }

double PhasePanel::moment_noise(int first_moment) const {
    return rms_ * solid_angle_of_moments(first_moment) / std::sqrt(double(PhaseTable::kPanelNodes));
}

double PhasePanel::moment_tail(int first_moment) const {
    return 0.5 * tail_ * largest_ * solid_angle_of_moments(first_moment);
}

}  // namespace miebrdf::mie
