// P at single angles: each is judged by itself and two angles close by, so that its value and its
// error do not depend on which other angles are asked for.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "mie/ensemble/phase_tabulation.h"
#include "mie/ensemble/size_families.h"
#include "mie/sphere/radial_functions.h"

namespace miebrdf::mie {
namespace {

constexpr int kNodes = 3;  // the angle itself and one on each side
constexpr double kWidest = 0.5 * std::numbers::pi / 180;
// An rms of three nodes that see much the same spheres: twice that is exceeded by one in twenty.
constexpr double kDeviations = 2;
constexpr double kFewNodes = 1.5;  // three agree by chance more often than the eight of a panel
constexpr double kFinest = 1e-6;
constexpr double kSpheresAsAngles = 16;  // the partial waves themselves cost as much as so many
// Twice as many sizes leave 0.5 to 0.7 of the noise of ripple (phase_panel.cpp).
constexpr double kSlowestGain = 0.5;
constexpr double kRayGain = 0.2;                // times that: rays leave a tenth or less
constexpr double kLeastSingleTolerance = 1e-4;  // single precision errs by 1e-5

// Rays may differ at single angles by more than their bias, an rms over all.
constexpr double kRayDeviations = 2;
constexpr double kRayShare = 0.5;       // of what is allowed, for their bias
constexpr double kRayFloor = 0.5;       // the bias is relative to max(P, this)
constexpr double kRayPartShare = 0.25;  // of what is allowed, for one part of several

struct SingleAngle {
    std::size_t index = 0;  // in the list of angles
    double theta_deg = 0;
    std::vector<FamilyIntensity> parts = {};
    std::vector<double> part_noise = {};
    FamilyIntensity sums = {};  // over parts
    double noise = 0;           // rms
    double differed = 0;        // half of what the families differ by, rms

    double value() const { return sums.intensity.row(1).sum() / scattered(); }
    double scattered() const { return sums.scattered[0] + sums.scattered[1]; }

    void add_level(int level, const std::vector<FamilyIntensity>& added, const SizeFamilies& sizes,
                   double scattering_efficiency) {
        if (level == 0) {
            parts = added;
        } else {
            for (std::size_t i = 0; i < added.size(); ++i) {
                if (added[i].intensity.size() > 0) parts[i] = sizes.with_level(parts[i], added[i]);
            }
        }
        sums = parts.front();
        for (std::size_t i = 1; i < parts.size(); ++i) {
            sums.intensity += parts[i].intensity;
            for (const int f : {0, 1}) sums.scattered[f] += parts[i].scattered[f];
        }
        // Parts are on levels of their own: what they scatter together would err as the coarsest.
        if (parts.size() > 1 && scattering_efficiency > 0)
            sums.scattered[0] = sums.scattered[1] = scattering_efficiency / 2;
        double doubt = sizes.rippled() && level > 0 ? kSlowestGain : 0.0;
        if (parts.size() > 1) doubt *= kRayGain;
        // Parts err independently of each other; that of their sum may be small by chance.
        part_noise.resize(parts.size(), 0.0);
        double squares = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            if (added[i].intensity.size() > 0)
                part_noise[i] = std::max(difference(parts[i]), doubt * part_noise[i]);
            squares += part_noise[i] * part_noise[i];
        }
        double differs = difference(sums);
        if (parts.size() > 1) differs = std::max(differs, std::sqrt(squares));
        differs *= kFewNodes;
        double missed = 0;
        if (scattering_efficiency > 0)
            missed = std::abs(scattered() / scattering_efficiency - 1) * value();
        noise = std::max({differs, doubt * differed, missed});
        differed = differs;
    }

    // Half of what the families differ by.
    double difference(const FamilyIntensity& of) const {
        if (!(sums.scattered[1] > 0)) return 0;
        return 0.5 *
               (of.intensity.col(0) / sums.scattered[0] - of.intensity.col(1) / sums.scattered[1])
                   .norm() /
               std::sqrt(double(kNodes));
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
              (180 / std::numbers::pi)) {}

    /// Returns the angles that rays do not settle: for sizes.
    std::vector<SingleAngle> compute(std::vector<SingleAngle> active, const Executor& run) {
        std::vector<SingleAngle> unsettled;
        for (int level = 0; !active.empty(); ++level) {
            const std::vector<FamilyIntensity> all = intensities(active, level, run);
            std::vector<SingleAngle> left;
            for (std::size_t a = 0; a < active.size(); ++a) {
                SingleAngle& angle = active[a];
                std::vector<FamilyIntensity> own(all.size());
                for (std::size_t i = 0; i < all.size(); ++i) {
                    if (all[i].intensity.size() == 0) continue;
                    own[i] = {all[i].intensity.middleRows(Eigen::Index(a) * kNodes, kNodes),
                              {all[i].scattered[0], all[i].scattered[1]}};
                }
                angle.add_level(level, own, sizes_, options_.scattering_efficiency);
                switch (judge(angle, level)) {
                    case Verdict::more:
                        left.push_back(std::move(angle));
                        break;
                    case Verdict::not_by_rays:
                        unsettled.push_back(std::move(angle));
                        break;
                    case Verdict::done:
                        break;
                }
            }
            active = std::move(left);
            const double work = (double(active.size()) * kNodes + kSpheresAsAngles) * terms_;
            if (!options_.by_rays && work * sizes_.sizes_at(level + 1) > options_.most_work) break;
        }
        return unsettled;
    }

  private:
    enum class Verdict { done, more, not_by_rays };

    double enough(const SingleAngle& angle) const {
        return allowed_.empty() ? options_.size_tolerance * std::max(angle.value(), options_.floor)
                                : allowed_[angle.index];
    }

    Verdict judge(const SingleAngle& angle, int level) {
        double error = kDeviations * angle.noise;
        bool too_biased = false;
        if (options_.by_rays) {
            const double bias = kRayDeviations * angle.bias(options_.ray_bias);
            // No more than is worth having, in case that sizes do not do better.
            too_biased = !(bias <= kRayShare * enough(angle)) && error <= bias;
            error += bias;
        }
        result_.phase[angle.index] = angle.value();
        result_.error[angle.index] = error;
        if (too_biased) return Verdict::not_by_rays;
        const bool is_first = level == 0 && sizes_.rippled();
        if (sizes_.resolves(level) && !is_first && error <= enough(angle)) return Verdict::done;
        if (level < sizes_.last_level()) return Verdict::more;
        // Sizes that sample the ripple would take longer yet.
        return Verdict::done;
    }

    // The parts of P whose families differ too much, at all nodes.
    std::vector<FamilyIntensity> intensities(const std::vector<SingleAngle>& active, int level,
                                             const Executor& run) {
        std::vector<double> nodes_deg;
        for (const SingleAngle& angle : active) {
            for (const int node : {-1, 0, 1})
                nodes_deg.push_back(std::clamp(angle.theta_deg + node * aside_deg_, 0.0, 180.0));
        }
        if (!options_.by_rays) {
            if (options_.size_tolerance >= kLeastSingleTolerance && sizes_.count() == 2) {
                return {
                    sizes_.level(level, AngularFunctionsOf<float>(nodes_deg, terms_, run), run)};
            }
            return {sizes_.level(level, AngularFunctions(nodes_deg, terms_, run), run)};
        }
        // Three nodes see much the same: that two families agree says little before the next level.
        std::vector<int> wanted(sizes_.part_count(), level <= 1 ? level : -1);
        part_levels_.resize(wanted.size(), 0);
        for (const SingleAngle& angle : active) {
            if (level <= 1) break;
            const auto& noise = angle.part_noise;
            const double largest = *std::max_element(noise.begin(), noise.end());
            for (std::size_t i = 0; i < wanted.size(); ++i) {
                if (kDeviations * noise[i] > kRayPartShare * enough(angle) || noise[i] == largest)
                    wanted[i] = part_levels_[i] + 1;
            }
        }
        for (std::size_t i = 0; i < wanted.size(); ++i)
            part_levels_[i] = std::max(part_levels_[i], wanted[i]);
        return sizes_.levels(wanted, AngularFunctionsOf<float>(nodes_deg, terms_, run), run);
    }

    SizeFamilies sizes_;
    const PhaseTabulationOptions& options_;
    const std::vector<double>& allowed_;
    PhaseValues& result_;
    int terms_;
    double aside_deg_;
    std::vector<int> part_levels_;
};

}  // namespace

PhaseValues phase_at_angles(std::complex<double> relative_index,
                            const SizeDistribution& distribution, const RadiusRange& range,
                            double wave_number_per_um, const PhaseTabulationOptions& options,
                            const std::vector<double>& angles_deg,
                            const std::vector<double>& allowed, const Executor& run) {
    std::vector<SingleAngle> angles;
    for (std::size_t i = 0; i < angles_deg.size(); ++i) angles.push_back({i, angles_deg[i]});
    PhaseValues result;
    result.phase.resize(angles_deg.size());
    result.error.resize(angles_deg.size());
    const auto compute = [&](const PhaseTabulationOptions& by, std::vector<SingleAngle> some) {
        AngleSeries series(relative_index, distribution, range, wave_number_per_um, by, allowed,
                           result);
        return series.compute(std::move(some), run);
    };
    if (options.by_rays) angles = compute(options, std::move(angles));
    const PhaseValues of_rays = result;
    PhaseTabulationOptions by_sizes = options;
    by_sizes.by_rays = false;
    compute(by_sizes, std::move(angles));
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
        // A bounded number of sizes may do worse.
        if (!(of_rays.error[i] > 0 && of_rays.error[i] < result.error[i])) continue;
        result.phase[i] = of_rays.phase[i];
        result.error[i] = of_rays.error[i];
    }
    return result;
}

}  // namespace miebrdf::mie
