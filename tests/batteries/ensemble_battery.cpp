// Errors of averages over sizes, against sums over single spheres: the errors themselves, in
// tolerances, and how often they exceed what is stated.
//
//     ensemble_battery TRUTH [PART...]     PART: averages, points, tables, matrices; each with
//                                          rare- before it for cases that constants were made for
//
// MIEBRDF_SEED in the environment: other random cases than those of seed 0, with a TRUTH of their
// own. TRUTH and TRUTH.rare are files that hold the sums; they are made if they are not there
// (minutes).
#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "mie/ensemble/size_sums.h"
#include "mie/sphere/sphere_block.h"
#include "tests/batteries/tally.h"
#include "tools/stress/random_media.h"

namespace {

using namespace miebrdf;
using constants::Tally;
using stress::Dice;
using Kind = mie::SizeDistributionKind;

constexpr double kWaveNumberPerUm = 2 * std::numbers::pi / 0.55;

struct Spheres {
    std::complex<double> index;
    mie::SizeDistribution sizes;
    std::vector<double> angles_deg = {};
    std::vector<mie::ParticleCoating> coatings = {};
};

void put_angles(Dice& dice, Spheres& s) {
    for (const double low : {0.0, 30.0, 60.0, 90.0, 120.0, 150.0})
        s.angles_deg.push_back(dice.uniform(low, low + 30));
    for (const double angle : {0.2, 2.0, 171.0, 177.5, 179.3, 180.0}) s.angles_deg.push_back(angle);
}

// Rippling spheres of every size, by rays and by sizes, and some that absorb.
std::vector<Spheres> random_spheres() {
    Dice dice(7 + 1000 * constants::seed_of_run());
    std::vector<Spheres> all;
    for (int i = 0; i < 36; ++i) {
        Spheres s;
        const double damping[] = {0, dice.logarithmic(1e-6, 1e-3), dice.logarithmic(1e-3, 0.3)};
        s.index = {dice.uniform(1.1, 3.3), damping[i % 3 == 2 ? 2 : dice.integer(0, 1)]};
        s.sizes.kind = i % 4 == 1 ? Kind::gamma : (i % 4 == 2 ? Kind::log_normal : Kind::power_law);
        s.sizes.effective_radius_um =
            i % 2 == 0 ? dice.logarithmic(8, 50) : dice.logarithmic(0.1, 8);
        s.sizes.effective_variance = dice.uniform(0.05, 0.25);
        put_angles(dice, s);
        all.push_back(s);
    }
    return all;
}

// Five of each: huge and clear, narrow in size, metals, faint ones of many rays that cross, coated,
// broad.
std::vector<Spheres> rare_spheres() {
    Dice dice(11 + 1000 * constants::seed_of_run());
    std::vector<Spheres> all;
    const auto add = [&](Kind kind, std::complex<double> index, double radius_um, double variance) {
        Spheres s{index, {}};
        s.sizes.kind = kind;
        s.sizes.effective_radius_um = radius_um;
        s.sizes.effective_variance = variance;
        put_angles(dice, s);
        all.push_back(s);
    };
    for (int i = 0; i < 5; ++i) {
        const Kind kind = i % 2 == 0 ? Kind::power_law : Kind::gamma;
        const double damping = i < 2 ? 0 : dice.logarithmic(1e-6, 1e-3);
        add(kind, {dice.uniform(1.2, 2.6), damping}, dice.logarithmic(60, 160), 0.15);
        add(kind, {dice.uniform(1.2, 2.6), damping}, dice.logarithmic(0.5, 15),
            dice.logarithmic(1e-3, 0.02));
        add(kind, {dice.uniform(0.2, 3), dice.logarithmic(0.3, 6)}, dice.logarithmic(0.05, 15),
            0.1);
        add(kind, {dice.uniform(1.03, 1.38), damping}, dice.logarithmic(6, 60), 0.2);
        add(kind, {dice.uniform(1.3, 2), damping}, dice.logarithmic(0.1, 12), 0.15);
        all.back().coatings = {
            {{dice.uniform(1.2, 2.4), i == 4 ? 0.01 : 0}, 0, dice.uniform(0.02, 0.3)}};
        add(Kind::log_normal, {dice.uniform(1.2, 2.6), damping}, dice.logarithmic(0.5, 12),
            dice.uniform(0.4, 1));
    }
    return all;
}

struct Truth {
    double q_ext = 0, one_minus_albedo = 0, asymmetry = 0;
    std::vector<double> phase, phase_noise, noise = std::vector<double>(3);
};

// n(r) r^3 over its value at r = a, of which the sum over equal steps of ln r has the area. As the
// exponential of a sum, because exp(-1 / b) alone is 0 at small variances.
double area_density(const mie::SizeDistribution& sizes, double r) {
    const double a = sizes.effective_radius_um, b = sizes.effective_variance;
    if (sizes.kind == Kind::gamma) return std::exp(std::log(r / a) / b - (r - a) / (a * b));
    if (sizes.kind == Kind::log_normal) {
        const double variance = std::log(1 + b), median = a * std::pow(1 + b, -2.5);
        return r * r * std::exp(-std::pow(std::log(r / median), 2) / (2 * variance));
    }
    return 1;  // n(r) ~ r^-3
}

mie::Scatterer scatterer_of(const Spheres& spheres) {
    mie::Scatterer scatterer = spheres.index;
    for (const mie::ParticleCoating& of : spheres.coatings)
        scatterer.coatings.push_back(
            {of.refractive_index, kWaveNumberPerUm * of.thickness_um, of.share_of_radius});
    return scatterer;
}

// Four rounds of one grid each, at shifts of their own: their scatter is the noise of their mean.
Truth truth_of(const Spheres& spheres) {
    constexpr int kRounds = 4;
    constexpr double kSpacing = 0.05;  // of all rounds together, in x
    const mie::RadiusRange range = mie::radius_range(spheres.sizes);
    const double ratio = range.largest_um / range.smallest_um;
    const int count = std::clamp(
        int(kWaveNumberPerUm * range.largest_um * std::log(ratio) / (kSpacing * kRounds)), 500,
        12000);
    const double step = std::log(ratio) / count;
    const mie::Scatterer scatterer = scatterer_of(spheres);
    const int terms = scatterer.terms(kWaveNumberPerUm * range.largest_um);
    const mie::AngularFunctions angular(spheres.angles_deg, terms);
    Eigen::ArrayXXd rounds(spheres.angles_deg.size(), kRounds), rest(3, kRounds);
    const double shifts[kRounds] = {0.137, 0.412, 0.633, 0.902};
    for (int round = 0; round < kRounds; ++round) {
        Eigen::VectorXd intensity = Eigen::VectorXd::Zero(rounds.rows());
        double area = 0, scattered = 0, absorbed = 0, asymmetric = 0;
        mie::SphereBlock block;
        block.make_room(terms, mie::kMostSizesPerBlock);
        for (int i = 0; i < count;) {
            std::vector<double> x, number;
            for (; i < count && int(x.size()) < mie::kMostSizesPerBlock; ++i) {
                const double r = range.smallest_um * std::exp(step * (i + shifts[round]));
                const double weight = area_density(spheres.sizes, r);
                x.push_back(kWaveNumberPerUm * r);
                number.push_back(weight / (x.back() * x.back()));
                area += weight;
            }
            const auto sums = mie::compute_spheres(scatterer, x, number, &block);
            scattered += 2 * sums.scattered;
            absorbed += 2 * sums.absorbed;
            asymmetric += 2 * sums.asymmetric;
            angular.add_intensity(block, intensity);
        }
        rounds.col(round) = intensity.array() / scattered;
        rest.col(round) << (scattered + absorbed) / area, absorbed / (scattered + absorbed),
            2 * asymmetric / scattered;
    }
    const auto noise = [](const auto& row) {
        return std::sqrt((row - row.mean()).square().sum() / (kRounds * (kRounds - 1)));
    };
    Truth truth{rest.row(0).mean(), rest.row(1).mean(), rest.row(2).mean(), {}, {}};
    truth.noise = {noise(rest.row(0)), noise(rest.row(1)), noise(rest.row(2))};
    for (const auto& at : rounds.rowwise()) {
        truth.phase.push_back(at.mean());
        truth.phase_noise.push_back(noise(at));
    }
    return truth;
}

void store(const std::string& file, const std::vector<Truth>& all) {
    std::ofstream out(file);
    out.precision(17);
    for (const Truth& t : all) {
        out << t.q_ext << ' ' << t.one_minus_albedo << ' ' << t.asymmetry;
        for (const auto* list : {&t.noise, &t.phase, &t.phase_noise})
            for (const double v : *list) out << ' ' << v;
        out << '\n';
    }
}

bool load(const std::string& file, const std::vector<Spheres>& spheres, std::vector<Truth>& all) {
    std::ifstream in(file);
    for (const Spheres& s : spheres) {
        Truth t;
        in >> t.q_ext >> t.one_minus_albedo >> t.asymmetry;
        t.phase.resize(s.angles_deg.size());
        t.phase_noise.resize(s.angles_deg.size());
        for (auto* list : {&t.noise, &t.phase, &t.phase_noise})
            for (double& v : *list) in >> v;
        all.push_back(std::move(t));
    }
    return bool(in);
}

// The error beyond the noise of the truth.
double beyond(double value, double truth, double noise) {
    return std::max(0.0, std::abs(value - truth) - 2 * noise);
}

mie::EnsembleRequest request_of(const Spheres& spheres) {
    mie::EnsembleRequest request;
    request.sizes = spheres.sizes;
    request.refractive_index = spheres.index;
    request.coatings = spheres.coatings;
    return request;
}

// The albedo of a half-space, by which 1 - albedo is judged (EnsembleOptics::error_estimate).
double absorbed_by_half_space(double one_minus_albedo, double asymmetry) {
    const double s = std::sqrt(one_minus_albedo / (1 - asymmetry * (1 - one_minus_albedo)));
    return 1 - (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
}

double error_of(const mie::EnsembleOptics& o, const Truth& t) {
    const double absorbed = absorbed_by_half_space(t.one_minus_albedo, t.asymmetry);
    return std::max({beyond(o.q_ext, t.q_ext, t.noise[0]) / t.q_ext,
                     beyond(o.asymmetry, t.asymmetry, t.noise[2]),
                     std::abs(absorbed_by_half_space(o.one_minus_albedo, t.asymmetry) - absorbed) -
                         absorbed * t.noise[1] / std::max(t.one_minus_albedo, 1e-300)});
}

double noise_of(const Truth& t) { return std::max(t.noise[0] / t.q_ext, t.noise[2]); }

void averages(const std::vector<Spheres>& all, const std::vector<Truth>& truth, Tally& tally) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        mie::EnsembleRequest request = request_of(all[i]);
        request.highest_moment = 64;
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
            request.tolerance = tolerance;
            const auto optics = mie::average_over_sizes(request);
            tally.add(error_of(optics, truth[i]), noise_of(truth[i]), optics.error_estimate,
                      tolerance);
        }
    }
}

void points(const std::vector<Spheres>& all, const std::vector<Truth>& truth, Tally& tally) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        mie::EnsembleRequest request = request_of(all[i]);
        request.angles_deg = all[i].angles_deg;
        for (const double tolerance : {1e-2, 2e-3}) {
            request.phase_tolerance = tolerance;
            const auto values = mie::phase_at_angles(request, 0.0);
            for (std::size_t a = 0; a < values.phase.size(); ++a) {
                tally.add(beyond(values.phase[a], truth[i].phase[a], truth[i].phase_noise[a]),
                          truth[i].phase_noise[a], values.error[a], tolerance * truth[i].phase[a]);
            }
        }
    }
}

void tables(const std::vector<Spheres>& all, const std::vector<Truth>& truth, Tally& tally) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        mie::EnsembleRequest request = request_of(all[i]);
        request.highest_moment = 400;
        request.with_phase_table = true;
        for (const double tolerance : {2e-2, 3e-3}) {
            request.phase_floor = 1.0;
            request.phase_tolerance = request.table_tolerance = tolerance;
            request.tolerance = 0.2 * tolerance;
            const auto optics = mie::average_over_sizes(request);
            const mie::PhaseTable& table = *optics.phase_table;
            for (std::size_t a = 0; a < truth[i].phase.size(); ++a) {
                const double mu = std::cos(all[i].angles_deg[a] * std::numbers::pi / 180);
                const double value = truth[i].phase[a], noise = truth[i].phase_noise[a];
                tally.add(beyond(table(mu), value, noise), noise, 2 * table.noise(mu),
                          tolerance * std::max(value, 1.0));
            }
            tally.add(error_of(optics, truth[i]), noise_of(truth[i]), optics.error_estimate,
                      request.tolerance);
        }
    }
}

// P of the series of the scattering matrix; large spheres are left out, they take seconds.
void matrices(const std::vector<Spheres>& all, const std::vector<Truth>& truth, Tally& tally) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        mie::EnsembleRequest request = request_of(all[i]);
        if (all[i].sizes.effective_radius_um > 3) continue;
        for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
            request.tolerance = tolerance;
            const auto matrix = mie::average_matrix(request);
            tally.add(error_of(matrix.optics, truth[i]), noise_of(truth[i]),
                      matrix.optics.error_estimate, tolerance);
            const mie::PhaseTable& table = *matrix.optics.phase_table;
            for (std::size_t a = 0; a < truth[i].phase.size(); ++a) {
                const double mu = std::cos(all[i].angles_deg[a] * std::numbers::pi / 180);
                tally.add(beyond(table(mu), truth[i].phase[a], truth[i].phase_noise[a]),
                          truth[i].phase_noise[a], 2 * table.noise(mu),
                          10 * tolerance * std::max(truth[i].phase[a], 0.5));
            }
        }
    }
}

}  // namespace

int main(int count, char** arguments) {
    if (count < 2) {
        std::fprintf(stderr,
                     "ensemble_battery TRUTH [[rare-]averages|points|tables|matrices...]\n");
        return 2;
    }
    using Part = void (*)(const std::vector<Spheres>&, const std::vector<Truth>&, Tally&);
    const std::pair<std::string, Part> parts[] = {
        {"averages", averages}, {"points", points}, {"tables", tables}, {"matrices", matrices}};
    constants::print_header();
    for (const std::string prefix : {"", "rare-"}) {
        const std::vector<Spheres> spheres = prefix.empty() ? random_spheres() : rare_spheres();
        const std::string file = arguments[1] + std::string(prefix.empty() ? "" : ".rare");
        std::vector<Truth> truth;
        for (const auto& each : parts) {
            const auto& name = each.first;
            if (!constants::is_wanted(prefix + name, count, arguments)) continue;
            if (truth.empty() && !load(file, spheres, truth)) {
                truth.clear();
                for (const Spheres& s : spheres) truth.push_back(truth_of(s));
                store(file, truth);
            }
            constants::measure(prefix + name,
                               [&](Tally& tally) { each.second(spheres, truth, tally); });
        }
    }
    return 0;
}
