// Errors of averages over sizes in classes of random ensembles, against brute sums of 46,508 single
// spheres each: how often, and by how much, they exceed what is stated. It judges the numbers of
// mie/ensemble/size_refinement.h: change one there, compile, and run.
//
//     size_battery SEED COUNT [CLASS...]
//
// CLASS: common, clear (nearly), narrow, metals, small (absorbing), coated, large, matrices, faint
// (four media at 21 wavelengths, for every seed).
#include <miebrdf/ensemble.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <string>
#include <vector>

#include "mie/ensemble/moment_transform.h"
#include "mie/ensemble/particle_ensemble.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sizes/size_nodes.h"
#include "tools/stress/dice.h"

namespace {

using namespace miebrdf;
using stress::Dice;
using Kind = mie::SizeDistributionKind;

constexpr int kMoments = 64;
constexpr double kWaveNumberPerUm = 2 * std::numbers::pi / 0.55;

mie::EnsembleRequest random_request(const std::string& name, int number, Dice& dice) {
    mie::EnsembleRequest request;
    const auto of_size_parameter = [&](double low, double high) {
        return dice.logarithmic(low, high) / kWaveNumberPerUm;
    };
    request.sizes.kind = std::vector{Kind::power_law, Kind::gamma, Kind::log_normal}[number % 3];
    double n = dice.uniform(1.1, 2.7), k = 0, radius = dice.logarithmic(0.05, 10);
    double variance = dice.logarithmic(0.03, 0.4);
    if (name == "common") {
        n = dice.uniform(1.1, 3.3);
        const int kind = dice.integer(0, 2);
        k = kind == 0 ? 0 : kind == 1 ? dice.logarithmic(1e-4, 0.3) : dice.uniform(0, 0.3);
    } else if (name == "clear") {
        k = dice.logarithmic(1e-7, 1e-2);
        radius = of_size_parameter(0.5, 50);
    } else if (name == "narrow") {
        k = dice.integer(0, 1) == 0 ? 0 : dice.logarithmic(1e-5, 0.1);
        variance = dice.logarithmic(0.001, 0.02);
    } else if (name == "metals") {
        n = dice.logarithmic(0.05, 4);
        k = dice.logarithmic(1, 8);
        radius = dice.logarithmic(0.01, 5);
    } else if (name == "small") {
        k = dice.logarithmic(1e-4, 0.5);
        radius = of_size_parameter(0.05, 3);
    } else if (name == "coated") {
        k = dice.integer(0, 1) == 0 ? 0 : dice.logarithmic(1e-5, 1e-2);
        radius = of_size_parameter(1, 40);
        const double shell_k = dice.integer(0, 1) == 0 ? 0 : dice.logarithmic(1e-5, 1e-2);
        request.coatings = {{{dice.uniform(1.1, 2.4), shell_k}, 0, dice.logarithmic(0.02, 0.5)}};
    } else if (name == "large") {
        k = dice.integer(0, 2) == 0 ? 0 : dice.logarithmic(1e-6, 1e-3);
        radius = of_size_parameter(100, 400);
        variance = dice.uniform(0.05, 0.3);
    } else if (name == "matrices") {
        k = dice.integer(0, 1) == 0 ? 0 : dice.logarithmic(1e-4, 0.03);
        radius = of_size_parameter(0.5, 15);
    } else {  // faint
        const int medium = number % 4;
        request.wavelength_nm = 500 + 5 * (number / 4 % 21);
        n = std::vector{1.31, 1.33, 1.5, 1.31}[medium];
        k = medium < 2 ? 1e-6 : 1e-5;
        radius = std::vector{10.0, 8.0, 5.0, 10.0}[medium];
        variance = medium == 1 ? 0.1 : 0.2;
        request.sizes.kind = medium < 2 ? Kind::power_law : Kind::gamma;
    }
    request.refractive_index = {n, k};
    request.sizes.effective_radius_um = radius;
    request.sizes.effective_variance = variance;
    request.highest_moment = kMoments;
    return request;
}

/// ln q_ext, ln(1 - albedo), 1 - albedo, g and the moments.
using Values = std::vector<double>;

Values values_of(double q_ext, double one_minus_albedo, double asymmetry,
                 const std::vector<double>& chi) {
    Values values = {std::log(q_ext), one_minus_albedo > 0 ? std::log(one_minus_albedo) : 0.0,
                     one_minus_albedo, asymmetry};
    for (std::size_t l = 1; l <= kMoments; ++l) values.push_back(l < chi.size() ? chi[l] : 0.0);
    return values;
}

Values brute_sum(const mie::EnsembleRequest& request, int count, mie::SizeSpacing spacing) {
    mie::EnsembleRequest whole = request;
    whole.tolerance = 1e-7;
    const mie::Ensemble ensemble = mie::ensemble_of(whole);
    mie::SizeSumOptions options;
    options.terms = ensemble.terms();
    options.band_width = kMoments;
    const mie::SizeSums sums = mie::sum_over_sizes(
        ensemble.scatterer,
        mie::WeightedSizes(mie::even_size_nodes(request.sizes, ensemble.range, count, 0.5, spacing),
                           ensemble.wave_number_per_um),
        options, mie::run_in_order);
    std::vector<double> chi = mie::moments_from_covariance(sums.covariance);
    const double whole_chi = chi[0];
    for (double& one : chi) one /= whole_chi;
    const mie::SphereSums& s = sums.spheres;
    return values_of(2 * (s.scattered + s.absorbed) / ensemble.share,
                     s.absorbed / (s.scattered + s.absorbed), 2 * s.asymmetric / s.scattered, chi);
}

/// The largest difference, in what counts as a relative change of q_ext.
double distance(const Values& a, const Values& truth) {
    mie::EnsembleOptics optics;
    optics.one_minus_albedo = truth[2];
    optics.single_scattering_albedo = 1 - truth[2];
    optics.asymmetry = truth[3];
    const double absorption = std::min(0.15, 0.5 * std::sqrt(6 * similar_absorption(optics)));
    double largest = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double weight = i == 1   ? absorption
                              : i == 2 ? 1 / std::max(1 - truth[2], 1e-30)
                              : i == 3 ? 1 / std::clamp(1 - truth[3], 1e-6, 1.0)
                                       : 1.0;
        largest = std::max(largest, weight * std::abs(a[i] - truth[i]));
    }
    return largest;
}

struct Tally {
    int values = 0, beyond = 0, beyond_tolerance = 0, unfinished = 0;
    double worst = 0, milliseconds = 0;
    int worst_number = -1;
};

}  // namespace

int main(int count, char** arguments) {
    if (count < 3) {
        std::fputs("size_battery SEED COUNT [CLASS...]\n", stderr);
        return 2;
    }
    const auto seed = unsigned(std::atoi(arguments[1]));
    std::vector<std::string> classes(arguments + 3, arguments + count);
    if (classes.empty())
        classes = {"common", "clear", "narrow",   "metals", "small",
                   "coated", "large", "matrices", "faint"};
    std::puts(
        "class,tolerance,values,beyond_stated,worst_over_stated,number,beyond_tolerance,"
        "not_converged,ms_each");
    for (const std::string& name : classes) {
        Dice dice(seed);
        Tally tallies[3];
        for (int i = 0; i < std::atoi(arguments[2]); ++i) {
            mie::EnsembleRequest request = random_request(name, i, dice);
            const Values one = brute_sum(request, 20011, mie::SizeSpacing::equal);
            const Values other = brute_sum(request, 26497, mie::SizeSpacing::geometric);
            Values truth = one;
            for (std::size_t v = 0; v < truth.size(); ++v) truth[v] = 0.5 * (one[v] + other[v]);
            const double doubt = distance(one, other);
            for (int t = 0; t < 3; ++t) {
                request.tolerance = std::pow(10.0, -2 - t);
                const std::clock_t began = std::clock();
                const mie::EnsembleOptics optics = name == "matrices"
                                                       ? mie::average_matrix(request).optics
                                                       : mie::average_over_sizes(request);
                const double seconds = double(std::clock() - began) / CLOCKS_PER_SEC;
                const double error =
                    std::max(0.0, distance(values_of(optics.q_ext, optics.one_minus_albedo,
                                                     optics.asymmetry, optics.chi),
                                           truth) -
                                      doubt);
                Tally& tally = tallies[t];
                ++tally.values;
                tally.milliseconds += 1e3 * seconds;
                tally.unfinished += optics.converged ? 0 : 1;
                tally.beyond += error <= optics.error_estimate ? 0 : 1;
                tally.beyond_tolerance += optics.converged && !(error <= request.tolerance) ? 1 : 0;
                if (!(error / optics.error_estimate <= tally.worst)) {
                    tally.worst = error / optics.error_estimate;
                    tally.worst_number = i;
                }
                if (std::getenv("VERBOSE") && !(error <= optics.error_estimate))
                    std::printf(
                        "# %s %d tol %g m %g %g r %g v %g %s err %.2e stated %.2e doubt %.1e sizes "
                        "%d\n",
                        name.c_str(), i, request.tolerance, request.refractive_index.real(),
                        request.refractive_index.imag(), request.sizes.effective_radius_um,
                        request.sizes.effective_variance, name_of(request.sizes.kind).c_str(),
                        error, optics.error_estimate, doubt, optics.size_nodes);
            }
        }
        for (int t = 0; t < 3; ++t) {
            const Tally& tally = tallies[t];
            std::printf("%s,1e-%d,%d,%d,%.2f,%d,%d,%d,%.3f\n", name.c_str(), t + 2, tally.values,
                        tally.beyond, tally.worst, tally.worst_number, tally.beyond_tolerance,
                        tally.unfinished, tally.milliseconds / tally.values);
        }
        std::fflush(stdout);
    }
    return 0;
}
