#include "mie/ensemble/phase_panel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mie/ensemble/phase_table.h"

namespace miebrdf::mie {
namespace {

// Widths grow by this share of the distance from the nearer end, up to the widest.
constexpr double kWidthGrowth = 0.4;
constexpr double kWidestPanel = 6 * std::numbers::pi / 180;

// Twice as many sizes leave 0.5 to 0.7 of the noise of ripple: a level that agrees with those
// before better than that does so by chance.
constexpr double kSlowestGain = 0.5;

// Towards the back all nodes of a panel see the same narrow resonances, and where both families
// miss one of them they agree everywhere. This share of what a new level changes counts as noise,
// too.
constexpr double kShareOfChange = 0.5;

// By rays bows that few sizes see are narrower than a panel: one node may have all of the noise.
constexpr double kShareOfWorst = 0.8;

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

// The last two coefficients. They may be small by chance, which noise hides where P is not by rays:
// no less than those before them fall short of the ones before these.
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

void PhasePanel::add_level(const std::vector<FamilyIntensity>& parts,
                           const std::vector<int>& levels, const SizeFamilies& sizes,
                           const PhaseTabulationOptions& options) {
    const Eigen::VectorXd before = level_ < 0 ? Eigen::VectorXd() : values();
    starts_anew_ = std::any_of(parts.begin(), parts.end(),
                               [](const FamilyIntensity& part) { return part.share == 1; });
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
        for (const int family : {0, 1}) sums_.scattered[family] += parts_[i].scattered[family];
    }
    // Parts are on levels of their own: what they scatter together would err as the coarsest.
    const bool by_rays = parts_.size() > 1 && options.scattering_efficiency > 0;
    for (const int family : {0, 1})
        whole_[family] = by_rays ? options.scattering_efficiency / 2 : sums_.scattered[family];
    const bool may_agree = sizes.rippled() && level_ > 0 && parts_.size() == 1 && is_backward();
    judge(sizes, options, may_agree ? before : values());
}

std::vector<int> PhasePanel::next_levels(const SizeFamilies& sizes, double tolerance) const {
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
        for (const int family : {0, 1}) {
            const Eigen::VectorXd coefficients =
                panel_coefficients(parts_[i].intensity.col(family));
            Eigen::Index node = 0;
            for (const double theta : panel_nodes(lower, upper)) {
                const double t = (2 * theta - lower_ - upper_) / (upper_ - lower_);
                intensity(node++, family) = panel_value(coefficients.data(), t);
            }
        }
    }
    return half;
}

Eigen::VectorXd PhasePanel::values() const { return part_values(sums_); }

Eigen::VectorXd PhasePanel::part_values(const FamilyIntensity& part) const {
    return part.intensity.rowwise().sum() / (whole_[0] + whole_[1]);
}

Eigen::VectorXd PhasePanel::values_of(int family) const {
    return sums_.intensity.col(family) / sums_.scattered[family];
}

void PhasePanel::judge(const SizeFamilies& sizes, const PhaseTabulationOptions& options,
                       const Eigen::VectorXd& before) {
    const double scattering_efficiency = options.scattering_efficiency, floor = options.floor;
    const Eigen::VectorXd P = values();
    const double largest = P.maxCoeff();
    const double worst_before = worst_, relative_before = relative_;
    worst_ = relative_ = 0;
    const bool by_rays = parts_.size() > 1;
    double rms = 0;
    if (sums_.scattered[1] > 0) {
        // The mean of two families errs by half their difference.
        const Eigen::VectorXd error =
            0.5 * (sums_.intensity.col(0) / whole_[0] - sums_.intensity.col(1) / whole_[1]);
        const Eigen::VectorXd relative = error.cwiseQuotient(P.cwiseMax(floor));
        const double root = std::sqrt(double(PhaseTable::kPanelNodes));
        worst_ = relative.cwiseAbs().maxCoeff();
        relative_ = relative.norm() / root;
        rms = 0.5 * (values_of(0) - values_of(1)).norm() / root;
        part_noise_.clear();
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            const Eigen::MatrixXd& intensity = parts_[i].intensity;
            const Eigen::VectorXd of_part =
                (0.5 * (intensity.col(0) / whole_[0] - intensity.col(1) / whole_[1]))
                    .cwiseQuotient(P.cwiseMax(floor));
            part_noise_.push_back(of_part.norm() / root);
            if (!by_rays) continue;
            const Eigen::VectorXd value = part_values(parts_[i]).cwiseQuotient(P.cwiseMax(floor));
            const auto believed = [&](double difference, double of) {
                return sizes.rays()->believed_of_few(i, part_levels_[i], lower_, upper_, difference,
                                                     of);
            };
            part_noise_[i] = believed(part_noise_[i], value.norm() / root);
            worst_ = std::max(worst_, believed(of_part.cwiseAbs().maxCoeff(), value.maxCoeff()));
            relative_ = std::max(relative_, part_noise_[i]);
        }
    } else {
        part_noise_.assign(parts_.size(), 0.0);
    }
    const double doubt = sizes.rippled() && level_ > 0 && !starts_anew_ ? kSlowestGain : 0.0;
    // By rays P is relative to the efficiency itself.
    double missed = 0;
    if (!by_rays && scattering_efficiency > 0) {
        const double sampled = whole_[0] + whole_[1];
        missed = std::abs(sampled / scattering_efficiency - 1);
    }
    const Eigen::VectorXd changed = kShareOfChange * (P - before).cwiseQuotient(P.cwiseMax(floor));
    const double by_level = changed.norm() / std::sqrt(double(PhaseTable::kPanelNodes));
    // Rays of one number of ways interfere as the sizes have it.
    Eigen::VectorXd mixed = P.cwiseAbs2();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (sizes.rays() != nullptr && sizes.rays()->is_one_ray(i))
            mixed -= part_values(parts_[i]).cwiseAbs2();
    }
    const Eigen::VectorXd bias =
        (options.ray_bias.ends * mixed.cwiseMax(0.0).cwiseSqrt().cwiseQuotient(P.cwiseMax(floor)))
            .array() +
        options.ray_bias.everywhere;
    // They are independent of each other, but glories have more of both than families tell.
    const auto together = [this](double of_sizes, double of_rays) {
        return is_backward() ? of_sizes + of_rays : std::hypot(of_sizes, of_rays);
    };
    noise_ = together(std::max({relative_, by_rays ? kShareOfWorst * worst_ : 0.0,
                                doubt * relative_before, missed, by_level}),
                      bias.norm() / std::sqrt(double(PhaseTable::kPanelNodes)));
    worst_noise_ =
        together(std::max({worst_, doubt * worst_before, missed, changed.cwiseAbs().maxCoeff()}),
                 bias.maxCoeff());
    rms_ = std::max(rms, missed * largest);
    largest_ = largest;
    tail_of_noise_ = rms / largest;
    const double left_out = last_two(P, by_rays);
    tail_ = left_out / largest;
    // Where rays have little noise, what is too fine for the polynomial is more than that.
    stated_noise_ = by_rays ? std::max(noise_, left_out / P.cwiseMax(floor).mean()) : noise_;
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
