// P at single angles: each is judged by itself and an angle on each side, so that its value and its
// error do not depend on which other angles are asked for.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "mie/ensemble/phase_tabulation.h"
#include "mie/ensemble/size_families.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

// The angle itself and one on each side, in quarters of a period of the fastest wave in P. Not
// equally far: straight forward and back, where P is even, both sides would be one.
constexpr std::array kAside = {-3, 0, 4};
constexpr int kNodes = int(kAside.size());
constexpr int kMiddle = 1;
constexpr double kDarkest = 1e3;  // sides count as no darker than the angle itself over this
constexpr double kWidest = 0.5 * std::numbers::pi / 180;
// An rms of three nodes that see much the same spheres: twice that is exceeded by one in twenty.
constexpr double kDeviations = 2;
constexpr double kFewNodes = 1.5;  // three agree by chance more often than the eight of a panel
// Times the error that decides, as far as that is allowed: what is stated costs nothing. 5.8 rms of
// three independent differences (nodes, families, levels) are exceeded by one in a hundred.
constexpr double kStated = 5.8 / (kDeviations * kFewNodes);
constexpr double kJustAllowed = 1 - 1e-12;  // relative errors are rounded once more
constexpr double kFinest = 1e-6;
constexpr double kSpheresAsAngles = 16;  // the partial waves themselves cost as much as so many
// Twice as many sizes leave 0.5 to 0.7 of the noise of ripple (phase_panel.cpp).
constexpr double kSlowestGain = 0.5;
constexpr double kRayGain = 0.2;  // times that: rays leave a tenth or less
// Two families may agree by chance. What the new level changes, and what the families of its sizes
// alone differ by, err by themselves: these shares of them count as noise, too. Where sizes resolve
// what they sample they are far larger than the error, hence no more than shares; by rays, whose
// parts seldom agree by chance all together, the change is enough.
struct Shares {
    double of_change, of_added;
};
constexpr Shares kSharesBySizes = {0.5, 0.5}, kSharesByRays = {0.3, 0};
constexpr double kLeastSingleTolerance = 1e-4;  // single precision errs by 1e-5

// Rays may differ at single angles by more than their bias, an rms over all.
constexpr double kRayDeviations = 2;
constexpr double kRayShare = 0.5;       // of what is allowed, for their bias
constexpr double kRayFloor = 0.5;       // the bias is relative to max(P, this)
constexpr double kRayPartShare = 0.25;  // of what is allowed, for one part of several
// Three nodes may all agree by chance: no part is believed to be good before the second level.
constexpr double kFirstPartShare = 0.1;

struct SingleAngle {
    std::size_t index = 0;  // in the list of angles
    double theta_deg = 0;
    std::vector<FamilyIntensity> parts = {};
    std::vector<double> part_noise = {};
    std::vector<int> part_levels = {};
    int level = -1;             // calls of add_level(), from 0
    FamilyIntensity sums = {};  // over parts
    double noise = 0;           // rms
    double differed = 0;        // half of what the families differ by, rms

    double value() const { return sums.intensity.row(kMiddle).sum() / scattered(); }
    double scattered() const { return sums.scattered[0] + sums.scattered[1]; }

    void add_level(const std::vector<FamilyIntensity>& added, const std::vector<int>& levels,
                   const SizeFamilies& sizes, double scattering_efficiency) {
        const std::vector<FamilyIntensity> before = parts;
        if (++level == 0) {
            parts = added;
            part_levels.assign(parts.size(), 0);
        } else {
            for (std::size_t i = 0; i < added.size(); ++i) {
                if (added[i].intensity.size() == 0) continue;
                parts[i] = sizes.with_level(parts[i], added[i]);
                part_levels[i] = levels[i];
            }
        }
        sums = parts.front();
        for (std::size_t i = 1; i < parts.size(); ++i) {
            sums.intensity += parts[i].intensity;
            for (const int f : {0, 1}) sums.scattered[f] += parts[i].scattered[f];
        }
        // Parts are on levels of their own: what they scatter together would err as the coarsest.
        const bool by_rays = parts.size() > 1;
        if (by_rays && scattering_efficiency > 0)
            sums.scattered[0] = sums.scattered[1] = scattering_efficiency / 2;
        const bool is_nested = sizes.rippled() && level > 0;
        const double theta = theta_deg * std::numbers::pi / 180;
        const auto noise_of_part = [&](std::size_t i) {
            if (by_rays && part_levels[i] <= 1)
                return sizes.rays()->believed_of_few(
                    i, part_levels[i], theta, theta, difference(parts[i]),
                    parts[i].intensity.row(kMiddle).sum() / scattered());
            if (!is_nested || added[i].share == 1) return difference(parts[i]);
            const Shares& shares = by_rays ? kSharesByRays : kSharesBySizes;
            return std::max({difference(parts[i]), shares.of_change * change(before[i], parts[i]),
                             shares.of_added * difference(added[i])});
        };
        double doubt = is_nested ? kSlowestGain : 0.0;
        double differs = 0;
        part_noise.resize(parts.size(), 0.0);
        bool starts_anew = false;
        if (by_rays) {
            doubt *= kRayGain;
            // Parts err independently of each other; that of their sum may be small by chance.
            double squares = 0;
            for (std::size_t i = 0; i < parts.size(); ++i) {
                if (added[i].intensity.size() > 0) {
                    const double believed = added[i].share == 1 ? 0.0 : doubt * part_noise[i];
                    part_noise[i] = std::max(noise_of_part(i), believed);
                    starts_anew = starts_anew || added[i].share == 1;
                }
                squares += part_noise[i] * part_noise[i];
            }
            differs = std::max(difference(sums), std::sqrt(squares));
        } else {
            differs = noise_of_part(0);
        }
        differs *= kFewNodes;
        double missed = 0;
        if (!by_rays && scattering_efficiency > 0)
            missed = std::abs(scattered() / scattering_efficiency - 1) * value();
        noise = std::max({differs, starts_anew ? 0.0 : doubt * differed, missed});
        differed = differs;
    }

    // Half of what the families differ by.
    double difference(const FamilyIntensity& of) const {
        if (!(sums.scattered[1] > 0)) return 0;
        const auto family = [&](int f) -> Eigen::VectorXd {
            return of.intensity.col(f) / scattered_with(of, f);
        };
        return 0.5 * rms(family(0) - family(1));
    }

    // By one more level.
    double change(const FamilyIntensity& before, const FamilyIntensity& after) const {
        const auto mean = [&](const FamilyIntensity& of) -> Eigen::VectorXd {
            return of.intensity.rowwise().sum() / (scattered_with(of, 0) + scattered_with(of, 1));
        };
        return rms(mean(after) - mean(before));
    }

    // A part alone is relative to what all scatter.
    double scattered_with(const FamilyIntensity& of, int family) const {
        return (parts.size() > 1 ? sums : of).scattered[family];
    }

    // Over the nodes. The sides of a glory are dark beside its middle, and err by as much less.
    double rms(const Eigen::VectorXd& differences) const {
        const Eigen::VectorXd bright = sums.intensity.rowwise().sum();
        const double here = bright[kMiddle];
        double squares = 0;
        for (Eigen::Index i = 0; i < differences.size(); ++i) {
            const double darker = here > 0 ? std::clamp(here / bright[i], 1.0, kDarkest) : 1.0;
            squares += std::pow(darker * differences[i], 2);
        }
        return std::sqrt(squares / kNodes);
    }

    // rms, by rays
    double bias(double ray_bias) const { return ray_bias * std::max(value(), kRayFloor); }
};

// All angles take their levels together.
class AngleSeries {
  public:
    AngleSeries(std::complex<double> relative_index, const SizeDistribution& distribution,
                const RadiusRange& range, double wave_number_per_um,
                const PhaseTabulationOptions& options, const std::vector<double>& allowed,
                PhaseValues& result)
        // Single angles may go to the finest level of all: most_work is their bound.
        : sizes_(relative_index, distribution, range, wave_number_per_um, kFinest,
                 options.by_rays ? SizeFamilies::Method::exact_rays : SizeFamilies::Method::sizes),
          options_(options),
          allowed_(allowed),
          result_(result),
          terms_(number_of_terms(wave_number_per_um * range.largest_um)),
          // A quarter of a period of the fastest wave in P.
          aside_deg_(
              std::min(kWidest, 0.25 * std::numbers::pi / (wave_number_per_um * range.largest_um)) *
              (180 / std::numbers::pi)) {
        if (options.by_rays) sizes_.keep_waves();
    }

    /// Returns the angles that rays do not settle: for sizes.
    std::vector<SingleAngle> compute(std::vector<SingleAngle> active, const Executor& run) {
        std::vector<SingleAngle> unsettled;
        while (!active.empty()) {
            std::vector<SingleAngle> others;
            std::vector<SingleAngle> next = those_next(std::move(active), others);
            const std::vector<int> levels = wanted_by(next.front());
            const std::vector<FamilyIntensity> all = intensities(next, levels, run);
            active = std::move(others);
            for (std::size_t a = 0; a < next.size(); ++a) {
                SingleAngle& angle = next[a];
                angle.add_level(at_some_angles(all, Eigen::Index(a) * kNodes, kNodes), levels,
                                sizes_, options_.scattering_efficiency);
                switch (judge(angle)) {
                    case Verdict::more:
                        active.push_back(std::move(angle));
                        break;
                    case Verdict::not_by_rays:
                        unsettled.push_back(std::move(angle));
                        break;
                    case Verdict::done:
                        break;
                }
            }
            if (active.empty()) break;
            const double work = (double(active.size()) * kNodes + kSpheresAsAngles) * terms_;
            if (!options_.by_rays &&
                work * sizes_.sizes_at(active.front().level + 1) > options_.most_work)
                break;
        }
        return unsettled;
    }

  private:
    enum class Verdict { done, more, not_by_rays };

    double enough(const SingleAngle& angle) const {
        return allowed_.empty() ? options_.size_tolerance * std::max(angle.value(), options_.floor)
                                : allowed_[angle.index];
    }

    Verdict judge(const SingleAngle& angle) {
        const int level = angle.level;
        double error = kDeviations * angle.noise;
        bool too_biased = false;
        if (options_.by_rays) {
            const double bias = kRayDeviations * angle.bias(options_.ray_bias.everywhere);
            // No more than is worth having, in case that sizes do not do better.
            too_biased = !(bias <= kRayShare * enough(angle)) && error <= bias;
            error += bias;
        }
        result_.phase[angle.index] = angle.value();
        result_.error[angle.index] = error;
        // Who says what is allowed adds up errors of several points, by their rms.
        if (allowed_.empty())
            result_.error[angle.index] =
                std::max(error, std::min(kStated * error, kJustAllowed * enough(angle)));
        if (too_biased) return Verdict::not_by_rays;
        const bool is_first = level == 0 && sizes_.rippled();
        if (sizes_.resolves(level) && !is_first && error <= enough(angle)) return Verdict::done;
        if (level < sizes_.last_level()) return Verdict::more;
        // Sizes that sample the ripple would take longer yet.
        return Verdict::done;
    }

    // The angles that want the same levels of sizes next, and the rest of them.
    std::vector<SingleAngle> those_next(std::vector<SingleAngle> active,
                                        std::vector<SingleAngle>& others) const {
        const auto order = [this](const SingleAngle& angle) {
            return std::pair(angle.level, wanted_by(angle));
        };
        auto first = order(active.front());
        for (const SingleAngle& angle : active) first = std::min(first, order(angle));
        std::vector<SingleAngle> next;
        for (SingleAngle& angle : active)
            (order(angle) == first ? next : others).push_back(std::move(angle));
        return next;
    }

    // Of the parts of P whose families differ too much.
    std::vector<int> wanted_by(const SingleAngle& angle) const {
        if (angle.level < 0) return std::vector<int>(sizes_.part_count(), 0);
        std::vector<int> wanted(sizes_.part_count(), -1);
        const double share = angle.level == 0 ? kFirstPartShare : kRayPartShare;
        const auto& noise = angle.part_noise;
        const double largest = *std::max_element(noise.begin(), noise.end());
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            if (kDeviations * noise[i] > share * enough(angle) || noise[i] == largest)
                wanted[i] = angle.part_levels[i] + 1;
        }
        return wanted;
    }

    // At all nodes.
    std::vector<FamilyIntensity> intensities(const std::vector<SingleAngle>& angles,
                                             const std::vector<int>& levels, const Executor& run) {
        std::vector<double> nodes_deg;
        for (const SingleAngle& angle : angles) {
            for (const int node : kAside) {
                const double theta_deg = std::abs(angle.theta_deg + node * aside_deg_);
                nodes_deg.push_back(theta_deg > 180 ? 360 - theta_deg : theta_deg);
            }
        }
        if (options_.by_rays)
            return sizes_.levels(levels, AngularFunctionsOf<float>(nodes_deg, terms_, run), run);
        const int level = angles.front().level + 1;
        if (options_.size_tolerance >= kLeastSingleTolerance && sizes_.count() == 2)
            return {sizes_.level(level, AngularFunctionsOf<float>(nodes_deg, terms_, run), run)};
        return {sizes_.level(level, AngularFunctions(nodes_deg, terms_, run), run)};
    }

    SizeFamilies sizes_;
    const PhaseTabulationOptions& options_;
    const std::vector<double>& allowed_;
    PhaseValues& result_;
    int terms_;
    double aside_deg_;
};

}  // namespace

PhaseValues phase_at_angles(std::complex<double> relative_index,
                            const SizeDistribution& distribution, const RadiusRange& range,
                            double wave_number_per_um, const PhaseTabulationOptions& options,
                            const std::vector<double>& angles_deg,
                            const std::vector<double>& allowed, const Executor& run) {
    PhaseValues result;
    result.phase.resize(angles_deg.size());
    result.error.resize(angles_deg.size());
    std::vector<std::size_t> single(angles_deg.size());
    std::iota(single.begin(), single.end(), std::size_t(0));
    // Who says what is allowed knows of all the angles.
    if (!allowed.empty())
        single = phase_on_panels(relative_index, distribution, range, wave_number_per_um, options,
                                 angles_deg, allowed, run, result);
    std::vector<SingleAngle> angles;
    angles.reserve(single.size());
    for (const std::size_t i : single) angles.push_back({i, angles_deg[i]});
    const auto compute = [&](const PhaseTabulationOptions& by, std::vector<SingleAngle> some) {
        AngleSeries series(relative_index, distribution, range, wave_number_per_um, by, allowed,
                           result);
        return series.compute(std::move(some), run);
    };
    if (options.by_rays) angles = compute(options, std::move(angles));
    const PhaseValues of_rays = result;
    for (SingleAngle& angle : angles) angle = {angle.index, angle.theta_deg};
    const std::vector<SingleAngle> unsettled = angles;
    PhaseTabulationOptions by_sizes = options;
    by_sizes.by_rays = false;
    compute(by_sizes, std::move(angles));
    for (const SingleAngle& angle : unsettled) {
        const std::size_t i = angle.index;
        // A bounded number of sizes may do worse.
        if (!(of_rays.error[i] > 0 && of_rays.error[i] < result.error[i])) continue;
        result.phase[i] = of_rays.phase[i];
        result.error[i] = of_rays.error[i];
    }
    return result;
}

}  // namespace miebrdf::mie
