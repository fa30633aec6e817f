// P at single angles: each is judged by itself and two angles close by, so that its value and its
// error do not depend on which other angles are asked for.
#include <algorithm>
#include <cmath>
#include <numbers>
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
constexpr double kLeastSingleTolerance = 1e-4;  // single precision errs by 1e-5

struct SingleAngle {
    std::size_t index = 0;  // in the list of angles
    double theta_deg = 0;
    FamilyIntensity sums = {};
    double noise = 0;     // rms
    double differed = 0;  // half of what the families differ by, rms

    double value() const { return sums.intensity.row(1).sum() / scattered(); }
    double scattered() const { return sums.scattered[0] + sums.scattered[1]; }

    void add_level(int level, const FamilyIntensity& added, const SizeFamilies& sizes,
                   double scattering_efficiency) {
        sums = level == 0 ? added : sizes.with_level(sums, added);
        double differs = 0;
        if (sums.scattered[1] > 0) {
            differs = 0.5 *
                      (sums.intensity.col(0) / sums.scattered[0] -
                       sums.intensity.col(1) / sums.scattered[1])
                          .norm() /
                      std::sqrt(double(kNodes));
        }
        double missed = 0;
        if (scattering_efficiency > 0)
            missed = std::abs(scattered() / scattering_efficiency - 1) * value();
        const double doubt = sizes.rippled() && level > 0 ? kSlowestGain : 0.0;
        differs *= kFewNodes;
        noise = std::max({differs, doubt * differed, missed});
        differed = differs;
    }
};

}  // namespace

PhaseValues phase_at_angles(std::complex<double> relative_index,
                            const SizeDistribution& distribution, const RadiusRange& range,
                            double wave_number_per_um, const PhaseTabulationOptions& options,
                            const std::vector<double>& angles_deg,
                            const std::vector<double>& allowed, const Executor& run) {
    // Single angles may go to the finest level of all: most_work is their bound.
    const SizeFamilies sizes(relative_index, distribution, range, wave_number_per_um, kFinest);
    const int terms = number_of_terms(wave_number_per_um * range.largest_um);
    // A quarter of a period of the fastest wave in P.
    const double aside =
        std::min(kWidest, 0.25 * std::numbers::pi / (wave_number_per_um * range.largest_um)) *
        (180 / std::numbers::pi);
    std::vector<SingleAngle> active;
    for (std::size_t i = 0; i < angles_deg.size(); ++i) active.push_back({i, angles_deg[i]});
    PhaseValues result;
    result.phase.resize(angles_deg.size());
    result.error.resize(angles_deg.size());
    for (int level = 0; !active.empty(); ++level) {
        std::vector<double> nodes_deg;
        for (const SingleAngle& angle : active) {
            for (const int node : {-1, 0, 1})
                nodes_deg.push_back(std::clamp(angle.theta_deg + node * aside, 0.0, 180.0));
        }
        const FamilyIntensity all =
            options.size_tolerance >= kLeastSingleTolerance && sizes.count() == 2
                ? sizes.level(level, AngularFunctionsOf<float>(nodes_deg, terms, run), run)
                : sizes.level(level, AngularFunctions(nodes_deg, terms, run), run);
        std::vector<SingleAngle> left;
        for (std::size_t a = 0; a < active.size(); ++a) {
            SingleAngle& angle = active[a];
            angle.add_level(level,
                            {all.intensity.middleRows(Eigen::Index(a) * kNodes, kNodes),
                             {all.scattered[0], all.scattered[1]}},
                            sizes, options.scattering_efficiency);
            const double value = angle.value();
            const double error = kDeviations * angle.noise;
            result.phase[angle.index] = value;
            result.error[angle.index] = error;
            const double enough = allowed.empty()
                                      ? options.size_tolerance * std::max(value, options.floor)
                                      : allowed[angle.index];
            const bool is_done =
                sizes.resolves(level) && (level > 0 || !sizes.rippled()) && error <= enough;
            if (!is_done && level < sizes.last_level()) left.push_back(std::move(angle));
        }
        active = std::move(left);
        const double work = (double(active.size()) * kNodes + kSpheresAsAngles) * terms;
        if (work * sizes.sizes_at(level + 1) > options.most_work) break;
    }
    return result;
}

}  // namespace miebrdf::mie
