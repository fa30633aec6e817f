// Rays of the Debye series against partial waves and against sums over many spheres.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include <miebrdf/ensemble.h>
#include <miebrdf/sphere.h>
#include "mie/ensemble/adaptive_phase.h"
#include "mie/ensemble/ray_average.h"
#include "mie/ensemble/ray_moments.h"
#include "mie/ensemble/ray_phase.h"
#include "mie/ensemble/size_sums.h"
#include "mie/sphere/radial_functions.h"
#include "mie/sphere/ray_waves.h"
#include "tests/support/catch.h"

using namespace miebrdf;
using Complex = std::complex<double>;
using Kind = mie::SizeDistributionKind;

namespace {

mie::Ensemble problem_of(Kind kind, Complex m, double x_effective, double variance) {
    mie::Ensemble problem;
    problem.scatterer = m;
    problem.sizes.kind = kind;
    problem.sizes.effective_radius_um = 1;
    problem.sizes.effective_variance = variance;
    problem.wave_number_per_um = x_effective;
    problem.range = mie::SizeLaw::of(problem.sizes.kind).has_ends
                        ? mie::radius_range(problem.sizes)
                        : mie::radius_range(problem.sizes, 1e-6, 1 / x_effective);
    problem.share = mie::area_share_within(problem.sizes, problem.range);
    return problem;
}

struct Truth {
    double q_ext = 0, one_minus_albedo = 0;
    std::vector<double> chi;
};

// Sums over equally spaced spheres.
Truth sampled(const mie::Ensemble& problem, int width, int count, double offset) {
    const double k = problem.wave_number_per_um;
    mie::SizeSumOptions options;
    options.terms = mie::number_of_terms(k * problem.range.largest_um);
    options.band_width = width;
    const mie::WeightedSizes sizes(
        mie::even_size_nodes(problem.sizes, problem.range, count, offset), k);
    const auto sums = mie::sum_over_sizes(problem.scatterer, sizes, options, mie::run_in_order);
    Truth truth;
    const double extinguished = sums.spheres.scattered + sums.spheres.absorbed;
    truth.q_ext = 2 * extinguished / problem.share;
    truth.one_minus_albedo = sums.spheres.absorbed / extinguished;
    truth.chi =
        mie::MomentTransform(sums.covariance.terms(), sums.covariance.width())(sums.covariance);
    const double whole = truth.chi[0];
    for (double& chi : truth.chi) chi /= whole;
    return truth;
}

template <typename Optics>
double distance(const Optics& a, const Truth& b) {
    double largest = std::abs(a.q_ext / b.q_ext - 1);
    for (std::size_t l = 0; l < b.chi.size(); ++l)
        largest = std::max(largest, std::abs(a.chi[l] - b.chi[l]));
    return largest;
}

template <typename Number>
double worst_coefficient(Number m) {
    mie::Lanes x, last_order;
    for (int lane = 0; lane < mie::kLaneCount; ++lane) {
        x[lane] = 60 * std::pow(1.7, lane) + 0.3;  // lanes of very different x end early
        last_order[lane] = mie::number_of_terms(x[lane]);
    }
    std::vector<mie::Coefficients> spheres;
    for (const double size : x) spheres.push_back(mie::mie_coefficients(m, size));
    mie::RayWaves<Number> waves(m, x);
    mie::RayResponse a, b;
    double worst = 0;
    for (int n = 1; n <= static_cast<int>(last_order.maxCoeff()); ++n) {
        waves.advance(last_order, a, b);
        for (int lane = 0; lane < mie::kLaneCount; ++lane) {
            const auto at = [lane](const mie::ComplexLanes& z) {
                return Complex(z.re[lane], z.im[lane]);
            };
            const auto error = [&](const mie::RayResponse& r, const std::vector<Complex>& exact) {
                const auto i = static_cast<std::size_t>(n) - 1;
                const Complex reference = i < exact.size() ? exact[i] : 0.0;
                // Near resonances the geometric sum amplifies rounding by its own denominator.
                const Complex below = 1.0 - at(r.inner);
                const Complex sum = 0.5 * (1.0 - at(r.outer) - at(r.through) / below);
                return std::abs(sum - reference) * std::abs(below);
            };
            worst = std::max({worst, error(a, spheres[lane].a), error(b, spheres[lane].b)});
        }
    }
    return worst;
}

}  // namespace

TEST_CASE("rays of the Debye series sum to the coefficients of the sphere", "[mie][rays]") {
    // Rounding of upward recurrences, which grows with x (2500 at most here).
    for (const double n : {1.05, 1.31, 1.5, 2.6, 3.7}) {
        CAPTURE(n);
        CHECK(worst_coefficient(n) <= 1e-12);
    }
    // The last ones are opaque, all or some of them: the reflected ray alone.
    for (const Complex m : {Complex(1.31, 1e-8), Complex(1.5, 1e-4), Complex(2.6, 1e-4),
                            Complex(1.33, 0.01), Complex(1.5, 0.4), Complex(2.6, 6)}) {
        CAPTURE(m);
        CHECK(worst_coefficient(m) <= 5e-12);
    }
}

TEST_CASE("rays of dark spheres of all sizes give what listed angles have by sizes",
          "[mie][rays]") {
    // Small spheres of a wide law are clear, and beyond their edge the wave reflected inside would
    // be larger than the one that comes; large ones are opaque.
    auto problem = problem_of(Kind::log_normal, {1.27, 0.16}, 167, 0.26);
    mie::PhaseGoal goal;
    goal.size_tolerance = 1e-3;
    goal.floor = 0.5;
    const std::vector<double> angles_deg = {20, 50, 80, 110, 140, 170, 180};
    const auto by_sizes = mie::AdaptivePhase(problem, goal, mie::run_in_order).at(angles_deg, {});
    goal.method = mie::PhaseMethod::exact_rays;
    goal.ray_bias = mie::phase_ray_bias(problem, true);
    REQUIRE(goal.ray_bias.everywhere > 0);
    const auto by_rays = mie::AdaptivePhase(problem, goal, mie::run_in_order).at(angles_deg, {});
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
        CAPTURE(angles_deg[i], by_rays.phase[i], by_sizes.phase[i], by_rays.error[i]);
        CHECK(std::abs(by_rays.phase[i] - by_sizes.phase[i]) <=
              by_rays.error[i] + by_sizes.error[i]);
    }
}

TEST_CASE("no light is lost in rays through transparent spheres", "[mie][rays]") {
    // chi_0 of the incoherent sum is what scatters; extinction comes from the forward direction.
    const double n = GENERATE(1.2, 1.5, 2.6);
    const auto problem = problem_of(Kind::gamma, n, 300, 0.1);
    const double k = problem.wave_number_per_um;
    const mie::MomentTransform transform(mie::number_of_terms(k * problem.range.largest_um), 16);
    const mie::WeightedSizes sizes(mie::smooth_size_nodes(problem.sizes, problem.range, 24), k);
    const auto sums =
        mie::sum_over_rays(problem.scatterer.relative_index, sizes, transform, mie::run_in_order);
    CAPTURE(n);
    CHECK(sums.absorbed == 0);
    // Single precision of the products.
    CHECK(std::abs(0.5 * transform(sums.collected)[0] / sums.extinguished - 1) <= 1e-6);
}

TEST_CASE("averages by rays are within their stated error", "[mie][rays][honesty]") {
    std::mt19937 random(20261123);
    const auto between = [&](double low, double high) {
        return std::exp(
            std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
    };
    int accepted = 0;
    for (int i = 0; i < 60; ++i) {
        const double n = 1 + between(0.06, 2.8), x = between(20, 180), v = between(0.02, 0.35);
        const double k = i % 2 == 0 ? 0.0 : between(1e-7, 1 / x);
        const Kind kind = std::array{Kind::power_law, Kind::gamma, Kind::log_normal}[i % 3];
        const double tolerance = i % 4 < 2 ? 5e-3 : 5e-4;
        const auto problem = problem_of(kind, {n, k}, x, v);
        constexpr int width = 32;
        const auto rays = mie::average_over_rays(problem, width, tolerance, mie::run_in_order);
        if (!rays) continue;
        ++accepted;
        const int count = static_cast<int>(std::clamp(
            20 * x * (problem.range.largest_um - problem.range.smallest_um), 1000.0, 8000.0));
        const Truth one = sampled(problem, width, count, 0.25);
        const Truth other = sampled(problem, width, count, 0.75);
        const double granted = 0.5 * distance(one, other);
        CAPTURE(name_of(kind), n, k, x, v, tolerance, granted, rays->error_estimate);
        CHECK(rays->error_estimate <= tolerance);
        CHECK(distance(*rays, one) <= rays->error_estimate + 2 * granted);
        if (k > 0) {
            const double similar =
                rays->one_minus_albedo / (1 - rays->single_scattering_albedo * rays->asymmetry);
            const double weight = std::min(0.15, 0.5 * std::sqrt(6 * similar));
            const double missed = std::abs(std::log(rays->one_minus_albedo / one.one_minus_albedo));
            const double own = std::abs(std::log(other.one_minus_albedo / one.one_minus_albedo));
            CHECK(weight * missed <= rays->error_estimate + 2 * weight * own);
        }
    }
    CHECK(accepted >= 20);
}

TEST_CASE("rays know the extinction that sharp ends of the sizes leave", "[mie][rays]") {
    // Light through the middle of the smallest spheres, ahead by 0.62 x of these (half of x), goes
    // through all phases here. Without what ends leave, the error would reach their bound.
    for (double x = 250; x < 272; x += 3) {
        const auto problem = problem_of(Kind::power_law, 1.31, x, 0.1);
        const auto rays = mie::average_over_rays(problem, 2, 1e-3, mie::run_in_order);
        REQUIRE(rays);
        const Truth one = sampled(problem, 2, 3000, 0.25), other = sampled(problem, 2, 3000, 0.75);
        const double truth = 0.5 * (one.q_ext + other.q_ext);
        const double error = std::abs(rays->q_ext / truth - 1);
        const double doubt = std::abs(one.q_ext / other.q_ext - 1);
        CAPTURE(x, error, doubt, mie::ray_bound(problem).ends);
        // 2.5e-5: of 16 sizes of rays.
        CHECK(error <= 0.25 * mie::ray_bound(problem).ends + 2.5e-5 + doubt);
    }
}

TEST_CASE("rays are refused where they are no description", "[mie][rays]") {
    const auto refused = [](const mie::Ensemble& problem, double tolerance) {
        return !mie::average_over_rays(problem, 16, tolerance, mie::run_in_order).has_value();
    };
    CHECK_FALSE(refused(problem_of(Kind::gamma, 1.5, 300, 0.1), 1e-3));
    CHECK(refused(problem_of(Kind::gamma, 1.5, 300, 0.1), 1e-7));               // single precision
    CHECK(refused(problem_of(Kind::gamma, 1.01, 300, 0.1), 1e-3));              // one wave in step
    CHECK(refused(problem_of(Kind::gamma, 0.75, 300, 0.1), 1e-3));              // bubbles
    CHECK(refused(problem_of(Kind::gamma, 1.5, 10, 0.1), 1e-3));                // small
    CHECK(refused(problem_of(Kind::gamma, 1.3, 30, 0.001), 1e-3));              // all alike
    CHECK(refused(problem_of(Kind::power_law, 1.5, 15, 0.1), 1e-3));            // ends
    CHECK_FALSE(refused(problem_of(Kind::gamma, {1.5, 0.1}, 300, 0.1), 1e-3));  // opaque
    auto single = problem_of(Kind::gamma, 1.5, 300, 0.1);
    single.sizes.kind = Kind::mono;
    CHECK(refused(single, 1e-3));
}

TEST_CASE("a finer tolerance states no more than a coarser one", "[mie][rays][honesty]") {
    // Ice of 150 um: neither rays nor the sizes that time allows reach the finer one.
    mie::EnsembleRequest request;
    request.sizes.kind = Kind::log_normal;
    request.sizes.effective_radius_um = 150;
    request.sizes.effective_variance = 0.2;
    request.refractive_index = {1.3015, 1.62e-6};
    request.wavelength_nm = 1000;
    request.highest_moment = 16;
    request.tolerance = 8e-6;
    const mie::EnsembleOptics coarse = mie::average_over_sizes(request);
    CHECK(coarse.converged);
    request.tolerance = 1.2e-6;
    const mie::EnsembleOptics fine = mie::average_over_sizes(request);
    CHECK_FALSE(fine.converged);
    CHECK(fine.error_estimate <= coarse.error_estimate);
    CHECK(std::abs(fine.single_scattering_albedo - coarse.single_scattering_albedo) <=
          coarse.error_estimate);
}

TEST_CASE("sizes of rays have all of the area, however few", "[mie][rays]") {
    const Kind kind = GENERATE(Kind::power_law, Kind::log_normal);
    const auto problem = problem_of(kind, 2.6, 420, 0.2);
    const mie::RaySizes all(problem, std::nullopt);
    for (const mie::RayGroup& group : mie::ray_groups(true)) {
        for (const int level : {0, 1, 2}) {
            for (const int family : {0, 1}) {
                const mie::WeightedSizes sizes = all.of(group.sizes_at(level), family);
                double area = 0;
                for (std::size_t i = 0; i < sizes.weights.size(); ++i)
                    area += sizes.weights[i] * std::pow(sizes.parameters[i], 2);
                CAPTURE(mie::name_of(kind), group.first_way, level, family);
                CHECK(std::abs(area / problem.share - 1) <= 1e-9);
            }
        }
    }
}

TEST_CASE("phase tables by rays are within their stated noise", "[mie][rays][honesty]") {
    // Of those that absorb, what is reflected is nearly all: hardly anything interferes with it.
    // Laws without ends have a wide range, in which few sizes see little of what is damped. The
    // last three are dark: some light comes through, through small ones alone, and none.
    struct Case {
        Complex m;
        Kind kind;
        double variance;
    };
    const Complex damped(3.5, 0.0018);
    const Case c = GENERATE_COPY(
        Case{1.5, Kind::power_law, 0.2}, Case{2.6, Kind::power_law, 0.2},
        Case{damped, Kind::power_law, 0.2}, Case{damped, Kind::power_law, 0.1},
        Case{damped, Kind::gamma, 0.1}, Case{damped, Kind::log_normal, 0.05},
        Case{{2.6, 0.001}, Kind::log_normal, 0.15}, Case{{1.5, 0.01}, Kind::power_law, 0.1},
        Case{{1.33, 0.05}, Kind::gamma, 0.1}, Case{{1.3, 0.5}, Kind::log_normal, 0.1});
    const Complex m = c.m;
    const auto problem = problem_of(c.kind, m, 420, c.variance);
    const double k = problem.wave_number_per_um;
    std::vector<double> angles_deg;
    for (double angle = 1; angle <= 180; angle += 1) angles_deg.push_back(angle);
    mie::SizeSumOptions sums;
    sums.terms = mie::number_of_terms(k * problem.range.largest_um);
    const mie::AngularTables functions = mie::AngularFunctions(angles_deg, sums.terms);
    sums.angles = &functions;
    Eigen::VectorXd P[2];
    double scattered = 0;
    for (const int half : {0, 1}) {
        const mie::WeightedSizes sizes(
            mie::even_size_nodes(problem.sizes, problem.range, 3000, 0.25 + 0.5 * half), k);
        const auto all = mie::sum_over_sizes(problem.scatterer, sizes, sums, mie::run_in_order);
        P[half] = all.intensity / (2 * all.spheres.scattered);
        scattered += all.spheres.scattered;
    }
    const auto exact = [&](std::size_t i) { return 0.5 * (P[0][i] + P[1][i]); };
    const auto granted = [&](std::size_t i) { return 0.5 * std::abs(P[0][i] - P[1][i]); };
    mie::PhaseGoal options;
    options.floor = 0.5;
    options.interpolation_tolerance = 3e-3;
    options.method = mie::PhaseMethod::rays;
    options.ray_bias = mie::phase_ray_bias(problem);
    REQUIRE(options.ray_bias.everywhere > 0);
    options.scattering_efficiency = scattered;
    const auto table = mie::AdaptivePhase(problem, options, mie::run_in_order).table().table;
    double squares = 0, stated = 0, truth = 0;
    int beyond = 0;
    for (std::size_t i = 0; i < angles_deg.size(); ++i) {
        const double mu = std::cos(angles_deg[i] * std::numbers::pi / 180);
        const double scale = std::max(exact(i), options.floor);
        const double error = (table(mu) - exact(i)) / scale, noise = table.noise(mu) / scale;
        squares += error * error;
        truth += std::pow(granted(i) / scale, 2);
        stated += noise * noise;
        beyond += !(std::abs(error) <= 3 * noise + 3 * granted(i) / scale);
    }
    CAPTURE(m, mie::name_of(c.kind), c.variance);
    CAPTURE(std::sqrt(squares / 180), std::sqrt(stated / 180), std::sqrt(truth / 180), beyond);
    CHECK(squares <= stated + 2 * truth);
    CHECK(beyond <= 9);  // one in twenty
    if (m == damped) {
        // 0.5/x of max(P, 1/2) would be 6e-4.
        for (double angle = 60; angle <= 150; angle += 1)
            CHECK(table.noise(std::cos(angle * std::numbers::pi / 180)) <= 3e-4);
    }

    // Single angles, each with an error of its own.
    mie::EnsembleRequest request;
    request.sizes = problem.sizes;
    request.refractive_index = problem.scatterer.relative_index;
    request.wavelength_nm = 2 * std::numbers::pi * 1e3 / k;
    request.phase_tolerance = 2e-2;
    std::vector<std::size_t> places;
    for (std::size_t i = 3; i < angles_deg.size(); i += 11) places.push_back(i);
    places.push_back(angles_deg.size() - 1);
    for (const std::size_t i : places) request.angles_deg.push_back(angles_deg[i]);
    const auto single = mie::phase_at_angles(request, 0.0);
    int too_far = 0;
    for (std::size_t j = 0; j < places.size(); ++j) {
        const double error = std::abs(single.phase[j] - exact(places[j]));
        UNSCOPED_INFO(request.angles_deg[j] << " deg: P " << single.phase[j] << " exact "
                                            << exact(places[j]) << " stated " << single.error[j]);
        too_far += !(error <= single.error[j] + 3 * granted(places[j]));
        CHECK(error <= 2 * single.error[j] + 3 * granted(places[j]));
    }
    CHECK(too_far <= 1);
}
